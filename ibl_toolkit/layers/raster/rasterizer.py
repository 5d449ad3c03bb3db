"""Triangles as a pinhole camera sees them: which of them is the nearest in each pixel.

A z-buffer over the pixels' centres, in numpy, for millions of triangles smaller than a pixel as for one that
fills the picture. Nearly all of those that aren't seen are told by whole numbers of their vertices; the
others are taken apart into rows and pixels, see `scan_lines`. Both sides of a triangle are drawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..views.pinhole import Pinhole
from .camera_space import NEAR, cut_at_near, on_picture, to_camera
from .scan_lines import first_centre, fragments

_BLOCK = 1 << 18  # vertices or triangles at once
_MOST_COLUMNS, _MOST_ROWS = 0xFFFF, 0x7FFF
_BEHIND = np.uint32(1 << 31)  # the code of a vertex that is not before the eye
_NOTHING = np.uint64(0xFFFFFFFFFFFFFFFF)


@dataclass(frozen=True, eq=False)
class Raster:
    """What is nearest in each pixel, (H, W).

    triangle: int32 number of the triangle, -1 where there is none. distance: float32 [m] along the camera's
    forward axis, +inf where there is none.
    """

    triangle: np.ndarray
    distance: np.ndarray


def rasterize(
    points: np.ndarray,
    triangles: np.ndarray,
    camera: Pinhole,
    keep: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Raster:
    """Draw triangles (T, 3), indices of points (V, 3) [m], as a camera in the same frame sees them.

    What lies nearer than NEAR is cut off. keep: of places (n, 3) on triangles tells which are there, (n,)
    bool; the others do not hide what is behind them. Of equally near triangles the first is seen.

    Raises: ValueError for points that are not finite, and for a picture of more than 65535 x 32767 px.

    >>> wall = np.array([[2.0, -9, -9], [2, 9, -9], [2, 0, 18]])
    >>> camera = Pinhole.looking_at((0, 0, 0), (1, 0, 0), 60, 2, 1)
    >>> rasterize(wall, np.array([[0, 1, 2]]), camera).distance
    array([[2., 2.]], dtype=float32)
    """
    if camera.width > _MOST_COLUMNS or camera.height > _MOST_ROWS:
        raise ValueError(
            f"picture of {camera.width} x {camera.height} px, "
            f"at most {_MOST_COLUMNS} x {_MOST_ROWS} px can be drawn"
        )
    nearest = np.full(camera.height * camera.width, _NOTHING, dtype=np.uint64)
    codes = _vertex_codes(points, camera)
    for start in range(0, len(triangles), _BLOCK):
        block = triangles[start : start + _BLOCK]
        whole, crossing = _in_sight(codes, block)
        corners, numbers = to_camera(points[block[whole]], camera), start + whole
        if crossing.size:
            parts, of_block = cut_at_near(points, block[crossing], camera)
            corners = np.concatenate([corners, parts])
            numbers = np.concatenate([numbers, start + crossing[of_block]])
        for row, column, distance, which in fragments(corners, camera):
            _put(nearest, row, column, distance, numbers[which], camera, keep)
    return _raster(nearest.reshape(camera.height, camera.width))


def _vertex_codes(points, camera):
    """Of each point (V,) uint32: the column and row of the first pixel centre right of and below it.

    Three vertices of one column, or of one row, have no centre between them; beyond the picture's sides all
    are of one column or row.
    """
    codes = np.empty(len(points), dtype=np.uint32)
    for start in range(0, len(points), _BLOCK):
        block = slice(start, start + _BLOCK)
        if not np.isfinite(points[block]).all():
            raise ValueError("points of the triangles must be finite")
        places = to_camera(points[block], camera)
        before = places[:, 2] > NEAR
        places[~before, 2] = 1.0  # of these nothing counts but that they are behind
        x, y, _ = on_picture(places, camera)
        code = (first_centre(y, camera.height) << 16) + first_centre(x, camera.width)
        codes[block] = np.where(before, code.astype(np.uint32), _BEHIND)
    return codes


def _in_sight(codes, triangles):
    """Indices of triangles that may have a pixel's centre: those beyond the near plane, and across it."""
    a, b, c = (codes[triangles[:, k]] for k in range(3))
    differ = (a ^ b) | (a ^ c)
    crossing = differ >= _BEHIND
    whole = (differ > 0xFFFF) & ((differ & np.uint32(0xFFFF)) > 0) & ~crossing
    return np.flatnonzero(whole), np.flatnonzero(crossing)


def _put(nearest, row, column, distance, triangle, camera, keep):
    """Note in ``nearest``, (H W) uint64, distances and triangles where they are nearer than what is there.

    The bits of a float above 0 rise with it: with the triangle's number below them they are one whole number.
    """
    pixel = row.astype(np.int64) * camera.width + column
    key = distance.astype(np.float32).view(np.uint32).astype(np.uint64) << np.uint64(32)
    key |= triangle.astype(np.uint64)
    nearer = key < nearest[pixel]
    if keep is not None:
        chosen = np.flatnonzero(nearer)
        nearer[chosen] = keep(_points(column[chosen], row[chosen], distance[chosen], camera))
    np.minimum.at(nearest, pixel[nearer], key[nearer])


def _points(column, row, distance, camera):
    """Points (n, 3) at distances (n,) [m] along forward, behind pixels' centres."""
    right = (column + 0.5 - camera.width / 2) / camera.focal
    down = (row + 0.5 - camera.height / 2) / camera.focal
    return camera.eye + np.stack([right * distance, down * distance, distance], axis=-1) @ camera.axes


def _raster(nearest):
    drawn = nearest != _NOTHING
    distance = (nearest >> np.uint64(32)).astype(np.uint32).view(np.float32)
    triangle = (nearest & np.uint64(0xFFFFFFFF)).astype(np.int64)
    return Raster(
        np.where(drawn, triangle, -1).astype(np.int32), np.where(drawn, distance, np.float32(np.inf))
    )
