"""Cracks in a view: holes a layer's pixel or two wide, where one surface goes on from one layer to another.

Where a floor and a wall are layers of their own, each ends at the sides of its pixels, and there neither has
quite the depth of the other. From the panorama's origin that does not show; from beside it a slit opens.
"""

from __future__ import annotations

import math

import numpy as np

from ..meshes.parallax import pixel_angle
from ..panorama import LayeredPanorama
from ..views.pinhole import Pinhole
from ..views.rendered_view import RenderedView

WIDEST = 2.0
"""How wide a crack may be, in pixels of the finest layer as they are seen from the origin: what is wider may
be a hole in that layer's domain."""
_SAME_SURFACE = 1.05  # the largest ratio of the depths on both sides
_WAYS = ((0, 1), (1, 0), (1, 1), (1, -1))  # rows and columns


def without_cracks(view: RenderedView, panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """The view with its cracks filled: between the nearest pixels on two opposite sides that agree in depth.

    What was uncovered from behind something near is no crack, as its sides do not agree: it stays a hole.
    """
    if not view.holes.any():
        return view
    most = WIDEST * camera.focal * min(map(pixel_angle, panorama.layers))
    return _filled(view, min(math.ceil(most), max(camera.width, camera.height)))


def _filled(view, reach):
    row, column = np.nonzero(view.holes)
    radiance, depth = view.radiance.copy(), view.depth.copy()
    shortest = np.full(len(row), np.inf)
    for down, right in _WAYS:
        ends = [_nearest_known(view.depth, row, column, s * down, s * right, reach) for s in (-1, 1)]
        (steps, one), (other_steps, other) = ends
        near, far = (f(view.depth[one], view.depth[other]) for f in (np.fmin, np.fmax))
        length = (steps + other_steps) * math.hypot(down, right)
        better = np.isfinite(far) & (far <= near * _SAME_SURFACE) & (length < shortest)
        better &= steps + other_steps - 1 <= reach
        shortest[better] = length[better]
        share = (steps / (steps + other_steps))[better].astype(np.float32)
        for result, values in ((radiance, view.radiance), (depth, view.depth)):
            first, last = (values[end[0][better], end[1][better]] for end in (one, other))
            weight = share[:, None] if values.ndim == 3 else share
            result[row[better], column[better]] = first + weight * (last - first)
    return RenderedView(radiance, depth, view.triangles)


def _nearest_known(depth, row, column, down, right, reach):
    """Steps (n,) to the first known pixel in a direction, and its place; the hole itself where none is."""
    height, width = depth.shape
    steps = np.full(len(row), reach + 1)
    missing = np.arange(len(row))
    for step in range(1, reach + 1):
        there = row[missing] + step * down, column[missing] + step * right
        inside = (there[0] >= 0) & (there[0] < height) & (there[1] >= 0) & (there[1] < width)
        missing, there = missing[inside], (there[0][inside], there[1][inside])
        known = ~np.isnan(depth[there])
        steps[missing[known]] = step
        missing = missing[~known]
    found = steps <= reach
    taken = np.where(found, steps, 0)
    return steps, (row + taken * down, column + taken * right)
