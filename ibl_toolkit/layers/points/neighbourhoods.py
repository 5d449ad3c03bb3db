"""A layer's pixels with their eight neighbours, as a camera sees them, for sampling between the pixels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..panorama import Layer
from ..views.pinhole import Pinhole
from ..views.texels import sheets_of, texel_index
from ..views.visible_tiles import TILE, Tiles, mapping_of

JUMP = 1.25
"""Neighbours whose depths differ by this factor or more are two surfaces, unless the slope leads there."""
_SIDE = TILE + 2
_BATCH = 32  # tiles per step: its arrays then stay near the cache
_MIDDLE = 4
_AROUND = [_SIDE * dy + dx for dy in (-1, 0, 1) for dx in (-1, 0, 1)]  # row by row; 4 is the pixel itself


@dataclass(frozen=True, eq=False)
class Neighbourhoods:
    """Pixels (m) of a layer and what is round each of them, row by row: 4 is the pixel, 5 is to its right.

    points: (9, 4, m) float32, homogeneous points in the camera's frame: ω - e/d and 1/d, of a surface at
    depth d in direction ω, seen by an eye at e. texels: (9, m) the pixels of the map whose attributes they
    have. Neighbours that the layer does not have, or that lie on another surface, are continued from the
    pixel, and have its attributes.
    """

    points: np.ndarray
    texels: np.ndarray

    def __len__(self):
        return self.texels.shape[1]

    def __getitem__(self, which) -> Neighbourhoods:
        return Neighbourhoods(self.points[..., which], self.texels[:, which])


def neighbourhoods(
    layer: Layer, tiles: Tiles, camera: Pinhole, planes: np.ndarray
) -> Iterator[Neighbourhoods]:
    """Those of the layer's finite surfaces that may be seen between planes (see `frustum`), in batches.

    camera: in the panorama's frame. What is interpolated between the points of a plane lies on it: ω and 1/d
    go together.
    """
    seen = tiles.in_view(camera, planes)
    for start in range(0, len(seen), _BATCH):
        found = _batch(layer, camera, planes, seen[start : start + _BATCH])
        if len(found):
            yield found


def _batch(layer, camera, planes, tiles):
    index, rays, near = _padded(layer, camera, tiles)
    _, rows, columns = sheets_of(layer.mapping, *layer.size)
    step = np.arange(TILE)
    own = (tiles[:, 1, None] + step < rows)[:, :, None] & (tiles[:, 2, None] + step < columns)[:, None, :]
    inside = np.zeros(index.shape, dtype=bool)
    inside[:, 1:-1, 1:-1] = own & ~np.isnan(near[:, 1:-1, 1:-1])
    pixels = np.flatnonzero(inside)
    around = pixels + np.array(_AROUND)[:, None]
    near, joined = _continued(near.reshape(-1)[around])
    eye = (camera.axes @ camera.eye).astype(np.float32)
    points = np.empty((9, 4, len(pixels)), dtype=np.float32)
    for axis in range(3):
        np.subtract(rays[axis].reshape(-1)[around], near * eye[axis], out=points[:, axis])
    points[:, 3] = near
    texels = index.reshape(-1)[np.where(joined, around, pixels)]
    seen = np.ones(len(pixels), dtype=bool)
    for plane in planes.astype(np.float32):
        side = points[:, 0] * plane[0] + points[:, 1] * plane[1] + points[:, 2] * plane[2]
        seen &= (side >= 0).any(axis=0)
    return Neighbourhoods(points[..., seen], texels[:, seen])


def _padded(layer, camera, tiles):
    """Of tiles with one pixel more on each side: index in the map, direction of sight, and 1/depth.

    Each (n, TILE + 2, TILE + 2), the direction three of them, in the camera's frame; 1/depth is NaN where
    there is no finite surface.
    """
    step = np.arange(-1, TILE + 1)
    _, height, width = sheets_of(layer.mapping, *layer.size)
    row = np.minimum(tiles[:, 1, None] + step, height)[:, :, None]
    column = np.minimum(tiles[:, 2, None] + step, width)[:, None, :]
    index = texel_index(layer.mapping, *layer.size, tiles[:, 0, None, None], row, column)
    depth = layer.depth.reshape(-1)[index]
    known = (index >= 0) & np.isfinite(depth)
    if "mask" in layer.attributes:
        known &= layer.mask.reshape(-1)[index]
    near = np.divide(1, depth, out=np.full(index.shape, np.nan, np.float32), where=known, casting="same_kind")
    return index, _rays(layer, camera, index), near


def _rays(layer, camera, index):
    """Directions (3, n, TILE + 2, TILE + 2) of pixels in the camera's frame."""
    mapping = mapping_of(layer)
    j, i = np.divmod(np.maximum(index, 0), layer.size[0])
    uv = mapping.uv_from_pixel(np.stack([i, j], axis=-1), *layer.size)
    rays = mapping.direction_from_uv(uv).reshape(-1, 3) @ camera.axes.T
    rays = rays.T.astype(np.float32).reshape(3, *index.shape)
    tile, row, column = np.nonzero(index < 0)  # beyond a corner of the cube: continued, as 1/depth is
    inner_row, inner_column = (np.where(k == 0, 1, k - 1) for k in (row, column))
    beside, above, inner = (
        (tile, row, inner_column),
        (tile, inner_row, column),
        (tile, inner_row, inner_column),
    )
    rays[:, tile, row, column] = (
        rays[(slice(None), *beside)] + rays[(slice(None), *above)] - rays[(slice(None), *inner)]
    )
    return rays


def _continued(near):
    """1/depth (9, m) with what is missing, or of another surface, put in; and which were neither."""
    middle = near[_MIDDLE]
    joined = np.zeros(near.shape, dtype=bool)
    joined[_MIDDLE] = True
    for one, other in ((1, 7), (3, 5)):
        for a, b in ((one, other), (other, one)):
            joined[a] = _is_joined(near[a], middle, near[b])
    whole = near.copy()
    for a, b in ((1, 7), (7, 1), (3, 5), (5, 3)):
        onwards = np.where(joined[b], _within_twice(2 * middle - near[b], middle), middle)
        whole[a] = np.where(joined[a], near[a], onwards)
    for corner, row, column in ((0, 1, 3), (2, 1, 5), (6, 7, 3), (8, 7, 5)):
        expected = _within_twice(whole[row] + whole[column] - middle, middle)
        ratio = near[corner] / expected
        joined[corner] = (ratio < JUMP) & (ratio * JUMP > 1)
        whole[corner] = np.where(joined[corner], near[corner], expected)
    return whole, joined


def _is_joined(near, middle, opposite):
    """Whether a neighbour is of the pixel's surface: about as far, or where the slope beyond it leads."""
    ratio, step = near / middle, near - middle
    about_as_far = (ratio < JUMP) & (ratio * JUMP > 1)
    return about_as_far | (np.abs(step - (middle - opposite)) <= 0.5 * np.abs(step))


def _within_twice(near, middle):
    return np.clip(near, middle / 2, middle * 2)
