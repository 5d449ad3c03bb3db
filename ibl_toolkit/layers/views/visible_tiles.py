"""The part of a layer that a camera may see: tiles of its map that are not surely outside of the picture."""

from __future__ import annotations

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import CUBE_MAP, Layer
from .pinhole import Pinhole
from .texels import sheets_of

TILE = 32
"""Side of a tile [px]."""
_PROBES = 5  # directions along a tile's side from which the cone round it is found


def mapping_of(layer: Layer):
    """The module that turns the layer's directions into pixels and back."""
    return cube_map if layer.mapping == CUBE_MAP else equirectangular


def frustum(camera: Pinhole, rows: tuple[int, int], margin: float) -> np.ndarray:
    """Normals (4, 3), in the camera's frame, of the planes round rows of its picture and `margin` [px] more.

    What is seen in rows[0] to rows[1] has no negative product with any of them.
    """
    across = camera.width / 2 + margin
    above, below = camera.height / 2 - rows[0] + margin, rows[1] - camera.height / 2 + margin
    f = camera.focal
    planes = np.array([[f, 0, across], [-f, 0, across], [0, f, above], [0, -f, below]])
    return planes / np.linalg.norm(planes, axis=1, keepdims=True)


class Tiles:
    """A layer cut into tiles of TILE x TILE px, each with the depths and the cone of directions it spans.

    nearest, farthest: (sheets, rows, columns of tiles) [m], of finite depths in the domain, inf and 0 where
    there are none.
    """

    def __init__(self, layer: Layer):
        _, rows, columns = sheets_of(layer.mapping, *layer.size)
        self._rows, self._columns = (np.arange(0, length, TILE) for length in (rows, columns))
        self.nearest, self.farthest = _depth_ranges(layer, self._rows, self._columns)
        self._middle, self._radius = _cones(layer, self._rows, self._columns)

    def in_view(self, camera: Pinhole, planes: np.ndarray) -> np.ndarray:
        """Tiles (n, 3), sheet, first row and first column in it, of those whose surfaces may be in a picture.

        camera: in the panorama's frame. planes: see `frustum`. A tile's surfaces lie in a cone round its
        middle, between its nearest and its farthest depth; it is left out if all that is outside of a plane.
        """
        normals = planes @ camera.axes
        angle = np.arccos(np.clip(self._middle @ normals.T, -1, 1))
        towards = np.cos(np.clip(angle - self._radius[..., None], 0, np.pi))
        kept = self.nearest < np.inf
        reach = (
            np.where(towards > 0, self.farthest[..., None], np.where(kept, self.nearest, 0)[..., None])
            * towards
        )
        kept &= (reach >= normals @ camera.eye).all(axis=-1)
        sheet, row, column = np.nonzero(kept)
        return np.stack([sheet, self._rows[row], self._columns[column]], axis=1)


def _depth_ranges(layer, row_starts, column_starts):
    """Nearest and farthest finite depth of the domain, (sheets, rows, columns of tiles); inf, 0: none."""
    sheets, rows, columns = sheets_of(layer.mapping, *layer.size)
    shape = (sheets, len(row_starts), len(column_starts))
    nearest, farthest = np.empty(shape, np.float32), np.empty(shape, np.float32)
    mask = layer.attributes.get("mask")
    for sheet in range(sheets):
        top, left = sheet // 3 * rows, sheet % 3 * columns
        for k, start in enumerate(row_starts):
            part = np.s_[top + start : top + min(start + TILE, rows), left : left + columns]
            depth = layer.depth[part]
            known = np.isfinite(depth) if mask is None else np.isfinite(depth) & mask[part]
            low = np.where(known, depth, np.inf).min(axis=0)
            high = np.where(known, depth, 0).max(axis=0)
            nearest[sheet, k] = np.minimum.reduceat(low, column_starts)
            farthest[sheet, k] = np.maximum.reduceat(high, column_starts)
    return nearest, farthest


def _cones(layer, row_starts, column_starts):
    """Middle (sheets, rows, columns of tiles, 3) and half angle (...) [rad] of cones that hold the tiles."""
    sheets, rows, columns = sheets_of(layer.mapping, *layer.size)
    width, height = layer.size
    share = np.linspace(0, 1, _PROBES)
    # From the first pixel's centre to the last's: on its rim a pixel is not surely of its face.
    row = row_starts[:, None] + share * (np.minimum(row_starts + TILE, rows) - 1 - row_starts)[:, None]
    column = (
        column_starts[:, None]
        + share * (np.minimum(column_starts + TILE, columns) - 1 - column_starts)[:, None]
    )
    sheet = np.arange(sheets)[:, None, None, None, None]
    i, j = np.broadcast_arrays(
        sheet % 3 * columns + column[:, None, :], sheet // 3 * rows + row[:, None, :, None]
    )
    mapping = mapping_of(layer)
    probes = mapping.direction_from_uv(mapping.uv_from_pixel(np.stack([i, j], axis=-1), width, height))
    middle = probes[..., _PROBES // 2, _PROBES // 2, :]
    cosine = np.einsum("srcijk,srck->srcij", probes, middle).min(axis=(-2, -1))
    pixel = 2 / rows if layer.mapping == CUBE_MAP else np.pi / rows
    slack = ((TILE - 1) / (_PROBES - 1) / 2 + 1.0) * np.sqrt(2) * pixel
    return middle, np.arccos(np.clip(cosine, -1, 1)) + slack
