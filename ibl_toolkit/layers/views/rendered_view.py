"""What a view of a layered panorama is, whatever method rendered it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import EQUIRECTANGULAR, Layer, LayeredPanorama
from .pinhole import Pinhole

NEAREST = 0.25
"""The pixel in which a direction lies has at least so much of the weight of the four round it."""


@dataclass(frozen=True, eq=False)
class RenderedView:
    """A picture, (H, W).

    radiance: (H, W, 3) float32, linear; 0 in holes. depth: (H, W) float32 [m] from the eye along the ray,
    +inf at infinity, NaN where no layer says what is there: a hole. triangles: how many were drawn.
    """

    radiance: np.ndarray
    depth: np.ndarray
    triangles: int | None = None

    @property
    def holes(self) -> np.ndarray:
        """(H, W) bool."""
        return np.isnan(self.depth)


def far_view(panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """What the layers have at infinity, where a camera (in the world) looks: holes are all over the rest.

    It has no parallax: it is looked up by direction (thesis, 6.2.4).
    """
    directions = camera.in_panorama(panorama).directions()
    radiance = np.zeros((*directions.shape[:2], 3), dtype=np.float32)
    depth = np.full(directions.shape[:2], np.nan, dtype=np.float32)
    for layer in panorama.layers:
        far = layer.mask & np.isposinf(layer.depth)
        if not far.any():
            continue
        weight = sampled(layer, far.astype(np.float32), directions)
        seen = weight >= NEAREST
        colours = sampled(layer, np.where(far[..., None], layer.radiance, 0).astype(np.float32), directions)
        radiance[seen] = colours[seen] / weight[seen, None]
        depth[seen] = np.inf
    return RenderedView(radiance, depth)


def sampled(layer: Layer, values: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Values (H, W) or (H, W, C) of a layer's pixels between their centres, in directions (..., 3)."""
    mapping = equirectangular if layer.mapping == EQUIRECTANGULAR else cube_map
    return mapping.sample(values, directions)
