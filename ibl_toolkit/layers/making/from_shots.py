"""Layers of RGB-D shots from several places: what one cannot see another fills in.

Source: thesis, section 6.3.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..panorama import Layer, LayeredPanorama
from .from_points import layers_from_points
from .shots import Shot

_FAR_TIMES = 1e4  # the farthest surface: there stands what is at infinity, while it is points
_BEYOND = 2.0  # times the farthest surface there is none: that is infinity, mixed with what is before it


def layers_from_shots(
    shots: Sequence[Shot], width: int, radius: float | None = None, *, origin=None, count: int | None = None
) -> LayeredPanorama:
    """`layers_from_points` of all that the shots saw, seen from `origin` (3,) [m], the first one's if None.

    Raises: ValueError as that does.
    """
    place = np.asarray(shots[0].origin if origin is None else origin, dtype=np.float64)
    farthest = max(_farthest(shot) + float(np.linalg.norm(shot.origin - place)) for shot in shots) or 1.0
    far = _FAR_TIMES * farthest
    points = [shot.origin + shot.rays * np.minimum(shot.distances, far)[:, None] for shot in shots]
    colours = np.concatenate([shot.colours for shot in shots])
    found = layers_from_points(np.concatenate(points), colours, place, width, radius, count=count)
    return replace(found, layers=tuple(_at_infinity(layer, _BEYOND * farthest) for layer in found.layers))


def _farthest(shot):
    """How far the farthest surface is [m], 0 if there is none."""
    return float(shot.distances[np.isfinite(shot.distances)].max(initial=0))


def _at_infinity(layer, far):
    depth = np.where(layer.depth > far, np.float32(np.inf), layer.depth)
    return Layer(layer.name, layer.mapping, {**layer.attributes, "depth": depth})
