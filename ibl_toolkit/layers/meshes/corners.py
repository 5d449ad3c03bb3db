"""The corners of a map's pixels: the points that meshes of layers have for vertices.

A map is one sheet of pixels (equirectangular) or six (the faces of a cube map). Every sheet has a lattice of
(height + 1) x (width + 1) corners, and a corner's number counts them sheet by sheet and row by row. Points of
the sphere that have several corners (at the seam, at the poles, on the edges of the cube) are known by the
smallest number: so meshes close round the seam and over the poles, and the six faces are sewn together.
"""

from functools import cached_property

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import CUBE_MAP, EQUIRECTANGULAR, refuse_other_layout


class Corners:
    """Corners of the pixels of a map of (width, height) px in one of the two mappings.

    Raises: ValueError for a size that no map of the mapping has, and for an equirectangular one below 4 x 2,
    on which no triangle has three corners.

    >>> Corners("equirectangular", 4, 2).sheet_shape, Corners("cube map", 6, 4).sheet_shape
    ((1, 2, 4), (6, 2, 2))
    """

    def __init__(self, mapping, width, height):
        refuse_other_layout(width, height, mapping)
        if mapping == EQUIRECTANGULAR and height < 2:
            raise ValueError(f"map of {width} x {height} px is too small for a mesh: 4 x 2 px at least")
        self.mapping, self.width, self.height = mapping, width, height
        self.sheet_shape = (6, height // 2, width // 3) if mapping == CUBE_MAP else (1, height, width)
        sheets, rows, columns = self.sheet_shape
        self.shape = (sheets, rows + 1, columns + 1)

    @property
    def wraps(self):
        """Whether a sheet's last column is the neighbour of its first."""
        return self.mapping == EQUIRECTANGULAR

    def as_sheets(self, image):
        """An image (H, W, ...) of the map as sheets (sheets, rows, columns, ...)."""
        sheets, rows, columns = self.sheet_shape
        if sheets == 1:
            return image[None]
        return (
            image.reshape(2, rows, 3, columns, *image.shape[2:])
            .swapaxes(1, 2)
            .reshape(sheets, rows, columns, *image.shape[2:])
        )

    @property
    def rims(self):
        """Pairs of indices into sheets: pixels along a rim of a sheet, and their neighbours beyond it."""
        if self.wraps:
            first, last = np.s_[:, :, 0], np.s_[:, :, -1]
            return [(first, last), (last, first)]
        beyond = cube_map.border_texels(self.sheet_shape[1])
        rims = (np.s_[:, 0, :], np.s_[:, -1, :], np.s_[:, :, 0], np.s_[:, :, -1])
        return [(rim, tuple(axis[:, k] for axis in beyond)) for k, rim in enumerate(rims)]

    @cached_property
    def duplicates(self):
        """Numbers (n,) of corners that are known by another number, and those numbers (n,)."""
        sheets, rows, columns = self.shape
        numbers = np.arange(sheets * rows * columns, dtype=np.int64).reshape(self.shape)
        if self.mapping == EQUIRECTANGULAR:
            top, side, bottom = numbers[0, 0, 1:], numbers[0, 1:-1, -1], numbers[0, -1, 1:]
            known_as = [np.full(columns - 1, numbers[0, 0, 0]), numbers[0, 1:-1, 0]]
            known_as.append(np.full(columns - 1, numbers[0, -1, 0]))
            return np.concatenate([top, side, bottom]), np.concatenate(known_as)
        on_edge = np.ones(self.shape, dtype=bool)
        on_edge[:, 1:-1, 1:-1] = False
        corners = numbers[on_edge]
        # Twice the coordinates on a cube of n pixels are whole numbers, so points are compared exactly.
        points = np.rint(self._on_cube(corners) * (rows - 1)).astype(np.int64)
        _, first, which = np.unique(points, axis=0, return_index=True, return_inverse=True)
        known_as = corners[first][which.reshape(-1)]
        other = known_as != corners
        return corners[other], known_as[other]

    def known_as(self, corners):
        """The smallest numbers (...) of corners (...), by which their points are known."""
        duplicates, names = self.duplicates
        all_names = np.arange(np.prod(self.shape), dtype=np.int32)
        all_names[duplicates] = names
        return all_names[corners]

    def directions(self, corners):
        """Unit directions (n, 3) of corners (n,), panorama frame."""
        if self.mapping == CUBE_MAP:
            direction = self._on_cube(corners)
            return direction / np.linalg.norm(direction, axis=1, keepdims=True)
        _, row, column = np.unravel_index(corners, self.shape)
        u, v = np.arange(self.width + 1) / self.width, np.arange(self.height + 1) / self.height
        level = equirectangular.direction_from_uv(np.stack([u, np.full_like(u, 0.5)], axis=1))
        upright = equirectangular.direction_from_uv(np.stack([np.full_like(v, 0.5), v], axis=1))
        directions = level[column]
        directions *= upright[row, :1]
        directions[:, 2] = upright[row, 2]
        return directions

    def depths(self, depth, inside, corners):
        """Depths (n,) [m] at corners (n,), from the pixels of the domain round each of them.

        depth, inside: sheets of the map, depths [m] and whether a pixel is in the domain. What is
        interpolated is the reciprocal of the depth, on a cube's face that of the distance along its axis: of
        a plane it is linear in the direction, and in the pixel. Where a pixel is missing, at the rim of the
        domain or of a sheet, each pixel that is there is continued to the corner by its slope. So the
        corners of a plane stay on it: on a cube's face exactly, elsewhere to second order.
        """
        near = np.divide(self._axial(), depth, out=np.zeros(self.sheet_shape), where=inside)
        totals, counts = np.zeros(self.shape), np.zeros(self.shape, dtype=np.int32)
        for rows in (slice(None, -1), slice(1, None)):
            for columns in (slice(None, -1), slice(1, None)):
                totals[:, rows, columns] += near
                counts[:, rows, columns] += inside
        rim = np.nonzero((counts > 0) & (counts < 4))
        totals[rim] = _continued(near, inside, *rim)
        totals, counts = totals.reshape(-1), counts.reshape(-1)
        duplicates, names = self.duplicates
        np.add.at(totals, names, totals[duplicates])
        np.add.at(counts, names, counts[duplicates])
        lengths = np.linalg.norm(self._on_cube(corners), axis=1) if self.mapping == CUBE_MAP else 1.0
        return lengths * counts[corners] / totals[corners]

    def _axial(self):
        """Length of pixels' rays within the cube (rows, columns), or 1 where there are no faces."""
        if self.mapping != CUBE_MAP:
            return 1.0
        size = self.sheet_shape[1]
        s = (2 * np.arange(size) + 1) / size - 1
        return np.sqrt(1 + s * s + s[:, None] ** 2)

    def _on_cube(self, corners):
        """Points (n, 3) on the cube from -1 to 1."""
        face, row, column = np.unravel_index(corners, self.shape)
        size = self.shape[1] - 1
        return cube_map.point_on_face(face, 2 * column / size - 1, 2 * row / size - 1)


def _continued(values, inside, sheet, row, column):
    """Sums (n,) over the pixels of the domain round a corner of what each would be there, by its slope."""
    total = np.zeros(len(row))
    for down in (1, -1):  # from the pixel to the corner, in half pixels
        for right in (1, -1):
            y, x = row - (down > 0), column - (right > 0)
            known, value = _look_up(values, inside, sheet, y, x)
            there = value.copy()
            for dy, dx in ((down, 0), (0, right)):
                before_known, before = _look_up(values, inside, sheet, y - dy, x - dx)
                after_known, after = _look_up(values, inside, sheet, y + dy, x + dx)
                slope = np.where(after_known, after - value, 0.0)
                there += 0.5 * np.where(before_known, value - before, slope)
            total += np.where(known, np.clip(there, value / 2, value * 2), 0.0)
    return total


def _look_up(values, inside, sheet, y, x):
    """Whether pixels are in their sheet and the domain, and their values, each (n,)."""
    rows, columns = inside.shape[1:]
    in_sheet = (y >= 0) & (y < rows) & (x >= 0) & (x < columns)
    y, x = np.clip(y, 0, rows - 1), np.clip(x, 0, columns - 1)
    return in_sheet & inside[sheet, y, x], values[sheet, y, x]
