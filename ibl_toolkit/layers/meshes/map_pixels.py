"""Pixels of a layer's map by their row-major number: their directions, and their reciprocal depths."""

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import CUBE_MAP, Layer


class MapPixels:
    """Of a layer: which pixels are in the domain, not at infinity; where each looks, and how near it is.

    inside: (H, W) bool.
    """

    def __init__(self, layer: Layer):
        self.width, self.height = layer.size
        self._is_cube, self._depth = layer.mapping == CUBE_MAP, layer.depth
        self.inside = layer.mask & np.isfinite(layer.depth)
        longitude = (0.5 - (np.arange(self.width) + 0.5) / self.width) * (2 * np.pi)
        latitude = (0.5 - (np.arange(self.height) + 0.5) / self.height) * np.pi
        self._columns = np.stack([np.cos(longitude), np.sin(longitude)], axis=1)
        self._rows = np.stack([np.cos(latitude), np.sin(latitude)], axis=1)

    def directions(self, pixels: np.ndarray) -> np.ndarray:
        """Unit vectors (n, 3), float64, panorama frame, of the centres of pixels (n,)."""
        row = pixels // self.width
        column = pixels - row * self.width  # half the time of divmod
        if self._is_cube:
            uv = np.stack([(column + 0.5) / self.width, (row + 0.5) / self.height], axis=1)
            return cube_map.direction_from_uv(uv)
        directions = np.empty((len(pixels), 3))
        across, up = self._columns.take(column, axis=0), self._rows.take(row, axis=0)
        np.multiply(across, up[:, :1], out=directions[:, :2])
        directions[:, 2] = up[:, 1]
        return directions

    def nearest(self, directions: np.ndarray) -> np.ndarray:
        """Pixels (n,) in which directions (n, 3) lie."""
        mapping = cube_map if self._is_cube else equirectangular
        column, row = np.floor(mapping.uv_from_direction(directions).T * [[self.width], [self.height]])
        return (np.minimum(row, self.height - 1) * self.width + column).astype(np.int64)

    def near(self, pixels: np.ndarray) -> np.ndarray:
        """Reciprocal depths (n,) [1/m] of pixels (n,) of the domain."""
        return 1.0 / self._depth.reshape(-1).take(pixels).astype(np.float64)

    def lattice(self, step: int) -> tuple[np.ndarray, np.ndarray]:
        """Every ``step``-th row (n,) and column (m,), beginning in the middle of a step."""
        return tuple(
            np.arange(step // 2, length, step, dtype=np.int32) for length in (self.height, self.width)
        )

    def around(self, pixels: np.ndarray, reach: int) -> np.ndarray:
        """Pixels (n, (2 reach + 1)^2) of the map round each of (n,): beyond the sides, those of the other."""
        offsets = np.arange(-reach, reach + 1)
        row, column = np.divmod(pixels, self.width)
        rows = np.clip(row[:, None] + offsets, 0, self.height - 1)[:, :, None]
        columns = ((column[:, None] + offsets) % self.width)[:, None, :]
        return (rows * self.width + columns).reshape(len(pixels), -1)
