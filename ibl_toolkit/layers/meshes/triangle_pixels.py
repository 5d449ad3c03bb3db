"""Which pixels of a map see which triangle, from the origin: for any triangles, of any size."""

from __future__ import annotations

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import EQUIRECTANGULAR

# So that a triangle of which a part lies on a cube's face has all its corners before that face.
_LARGEST = np.radians(7)
_BEFORE = 0.2
_MOST_PIXELS = 256
_AT_ONCE = 1 << 18
_MARGIN = 1e-9  # rays as near to an edge [length of its normal] belong to both triangles


def triangle_pixels(corners, mapping, width, height):
    """Yield pairs of equal arrays: numbers of triangles, and of the pixels (row by row) they cover.

    corners: (T, 3, 3) unit vectors, each triangle smaller than a hemisphere. A triangle is cut into four
    until it is near few pixels only; those are tried. A pixel on an edge is given for both triangles.
    """
    numbers = np.arange(len(corners))
    facing = np.linalg.det(corners) < 0
    corners = np.where(facing[:, None, None], corners[:, ::-1], corners)
    while len(corners):
        large = _radius(corners)[1] > _LARGEST
        for rectangles_of in _sheets(mapping, width, height):
            yield from _on_sheet(numbers[~large], corners[~large], rectangles_of)
        numbers, corners = _in_four(numbers[large], corners[large])


class _Equirectangular:
    def __init__(self, width, height):
        self.width, self.height = width, height
        self.smallest = 1.5 * np.pi / height  # at a pole no triangle is near few pixels

    def rectangles(self, corners):
        """First column and row, and how many of them (n, 4), whose pixels may see a triangle."""
        middle, radius = _radius(corners)
        latitude = np.arcsin(np.clip(middle[:, 2], -1, 1))
        top, bottom = ((0.5 - (latitude + sign * radius) / np.pi) * self.height - 0.5 for sign in (1, -1))
        reach = np.sin(radius) / np.maximum(np.cos(latitude), 1e-12)
        reach = np.where(np.abs(latitude) + radius < np.pi / 2, np.arcsin(np.minimum(reach, 1)), np.pi)
        column = equirectangular.uv_from_direction(middle)[:, 0] * self.width - 0.5
        reach = reach * self.width / (2 * np.pi)
        y0, y1 = _whole(top, bottom, self.height)
        x0 = np.ceil(column - reach - 1e-6)
        columns = np.minimum(np.floor(column + reach + 1e-6) - x0 + 1, self.width)
        return np.stack([x0, y0, columns, y1 - y0], axis=1).astype(np.int64)

    def pixels(self, column, row):
        return row * self.width + column % self.width

    def directions(self, column, row):
        uv = equirectangular.uv_from_pixel(np.stack([column, row], axis=1), self.width, self.height)
        return equirectangular.direction_from_uv(uv)


class _Face:
    smallest = 0.0

    def __init__(self, face, size):
        self.face, self.size = np.array(face), size
        middle = cube_map.point_on_face(self.face, np.zeros(1), np.zeros(1))[0]
        right = cube_map.point_on_face(self.face, np.ones(1), np.zeros(1))[0] - middle
        down = cube_map.point_on_face(self.face, np.zeros(1), np.ones(1))[0] - middle
        self.axes = np.stack([right, down, middle])

    def rectangles(self, corners):
        """First column and row, and how many of them (n, 4), whose pixels may see a triangle."""
        seen = corners @ self.axes.T
        before = (seen[..., 2] > _BEFORE).all(axis=1)
        places = ((seen[..., :2] / np.where(before[:, None], seen[..., 2], 1)[..., None]) + 1) / 2
        places = places * self.size - 0.5
        x0, x1 = _whole(places[..., 0].min(axis=1), places[..., 0].max(axis=1), self.size)
        y0, y1 = _whole(places[..., 1].min(axis=1), places[..., 1].max(axis=1), self.size)
        columns, rows = np.maximum(x1 - x0, 0), np.maximum(y1 - y0, 0)
        return np.stack([x0, y0, np.where(before, columns, 0), rows], axis=1).astype(np.int64)

    def pixels(self, column, row):
        top, left = self.face // 3 * self.size, self.face % 3 * self.size
        return (top + row) * (3 * self.size) + left + column

    def directions(self, column, row):
        s, t = (2 * (k + 0.5) / self.size - 1 for k in (column, row))
        return cube_map.point_on_face(self.face, s, t)


def _sheets(mapping, width, height):
    if mapping == EQUIRECTANGULAR:
        return [_Equirectangular(width, height)]
    return [_Face(face, height // 2) for face in range(6)]


def _whole(low, high, length):
    """Half-open ranges of the whole numbers from low to high that are at least 0 and below length."""
    return np.clip(np.ceil(low - 1e-6), 0, length), np.clip(np.floor(high + 1e-6) + 1, 0, length)


def _on_sheet(numbers, corners, sheet):
    while len(corners):
        rectangles = sheet.rectangles(corners)
        area = rectangles[:, 2] * rectangles[:, 3]
        large = (area > _MOST_PIXELS) & (_radius(corners)[1] > sheet.smallest)
        near = np.flatnonzero((area > 0) & ~large)
        ends = np.searchsorted(np.cumsum(area[near]), np.arange(_AT_ONCE, area[near].sum(), _AT_ONCE))
        for some in np.split(near, np.unique(ends)):
            yield _tried(numbers[some], corners[some], rectangles[some], sheet)
        numbers, corners = _in_four(numbers[large], corners[large])


def _tried(numbers, corners, rectangles, sheet):
    """Which of the pixels in triangles' rectangles they cover."""
    x0, y0, columns, rows = rectangles.T
    area = columns * rows
    which = np.repeat(np.arange(len(area)), area)
    step = np.arange(len(which)) - np.repeat(np.cumsum(area) - area, area)
    column, row = x0[which] + step % columns[which], y0[which] + step // columns[which]
    normals = np.cross(np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1))
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-300)
    directions = sheet.directions(column, row)
    inside = np.ones(len(which), dtype=bool)
    for side in range(3):
        inside &= np.einsum("nk,nk->n", normals[which, side], directions) >= -_MARGIN
    return numbers[which[inside]], sheet.pixels(column[inside], row[inside])


def _radius(corners):
    """Middles (n, 3) of circles round triangles, and their radii (n,) [rad]."""
    middle = corners.sum(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    away = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    return middle, 2 * np.arcsin(np.minimum(away / 2, 1)) + 1e-9


def _in_four(numbers, corners):
    """Triangles cut at the middles of their edges."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, bc, ca = (
        (one + other) / np.linalg.norm(one + other, axis=1, keepdims=True)
        for one, other in ((a, b), (b, c), (c, a))
    )
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    corners = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.tile(numbers, 4), corners
