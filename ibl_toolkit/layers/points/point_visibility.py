"""Which samples are seen: the nearest surface in each cell of a picture, be it a pixel or a block of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SAME_SURFACE = 1.1
"""Samples of one layer whose distances differ by less than this factor within a cell are one surface."""


@dataclass(frozen=True, eq=False)
class Nearest:
    """The nearest surface in cells (n): near, 1/distance of its nearest sample [1/m], and the number of its
    layer. near is -1 and the layer -1 in cells without a sample."""

    near: np.ndarray
    layer: np.ndarray

    @classmethod
    def of_cells(cls, count: int) -> Nearest:
        """Without any sample yet."""
        return cls(np.full(count, -1, np.float32), np.full(count, -1, np.int16))

    def add(self, layer: int, cells: np.ndarray, near: np.ndarray):
        """Take samples (m) of a layer into account: the cells they lie in, and their 1/distance."""
        before = self.near[cells]
        np.maximum.at(self.near, cells, near)
        self.layer[cells[self.near[cells] > before]] = layer

    def is_nearest(self, layer: int, cells: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Whether samples (m) are of the nearest surface of their cells."""
        return (self.layer[cells] == layer) & self.reaches(cells, near)

    def reaches(self, cells: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Whether samples (m) are about as near as the nearest, whatever their layer is."""
        return near * np.float32(SAME_SURFACE) >= self.near[cells]
