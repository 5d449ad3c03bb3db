"""Power and its first moment on the sphere, per row and per column of any rectangle of a light map.

What a cut needs of a rectangle are its profiles: Σ P and Σ P ω of every row, and of every column. They come
from tables that are summed along one side only and kept for every STEP-th line, plus the few lines at either
end taken from the map: a sixteenth of the memory of summed-area tables, and no image of the power. What is
black is exactly 0, since adding zeros changes no sum, and the rounding of a line is relative to this line's
power, not to the map's.
"""

import numpy as np

from .. import equirectangular
from .light_map import pixel_power, strips

STEP = 32
"""Lines between two rows of a table."""


class PowerTables:
    """Profiles of rectangles (top, bottom, left, right), half-open, of an image whose columns are turned.

    Turned: column 0 of a rectangle is column ``shift`` of the image, the meridian with the least power, so
    that the edge of the image cuts through nothing bright.

    Raises: ValueError if no light is inside the mask.
    """

    def __init__(self, image, mask=None):
        self.image, self.mask = image, mask
        self.height, self.width = image.shape[:2]
        self.solid_angles = equirectangular.row_solid_angles(self.width, self.height)
        azimuths = (0.5 - (np.arange(self.width) + 0.5) / self.width) * (2 * np.pi)
        elevations = (0.5 - (np.arange(self.height) + 0.5) / self.height) * np.pi
        self.across = np.stack([np.ones(self.width), np.cos(azimuths), np.sin(azimuths)], axis=1)
        self.upward = np.stack([np.ones(self.height), np.cos(elevations), np.sin(elevations)], axis=1)
        self._fill()
        columns = self._columns_of(slice(0, self.height), slice(0, self.width))[:, 0]
        if not columns.any():
            raise ValueError("no light is in the chosen part of the map: its luminance is 0; expected some")
        self.shift = int(np.argmin(columns))

    def by_row(self, rectangle):
        """Σ P, Σ P x, Σ P y, Σ P z of every row of the rectangle, (rows, 4)."""
        rows = slice(*rectangle[:2])
        sums = sum(self._rows_of(rows, columns) for columns in self._columns(rectangle))
        _, cosine, sine = self.upward[rows].T
        return np.stack([sums[:, 0], sums[:, 1] * cosine, sums[:, 2] * cosine, sums[:, 0] * sine], axis=1)

    def by_column(self, rectangle):
        """Σ P, Σ P x, Σ P y, Σ P z of every column of the rectangle, (columns, 4)."""
        rows, pieces = slice(*rectangle[:2]), self._columns(rectangle)
        sums = np.concatenate([self._columns_of(rows, columns) for columns in pieces])
        _, cosine, sine = np.concatenate([self.across[columns] for columns in pieces]).T
        return np.stack([sums[:, 0], sums[:, 1] * cosine, sums[:, 1] * sine, sums[:, 2]], axis=1)

    def brightest(self, rectangle):
        """Direction (3,) of the pixel with the most power in the rectangle."""
        rows, pieces = slice(*rectangle[:2]), self._columns(rectangle)
        power = np.concatenate([self._power(rows, columns) for columns in pieces], axis=1)
        row, column = np.unravel_index(np.argmax(power), power.shape)
        ij = (rectangle[2] + column + self.shift) % self.width, rows.start + row
        return equirectangular.direction_from_uv(equirectangular.uv_from_pixel(ij, self.width, self.height))

    def partition(self, rectangles):
        """Number of the rectangle that each pixel of the image lies in, (H, W) int32; -1 outside the mask."""
        partition = np.empty((self.height, self.width), np.int32)
        for number, rectangle in enumerate(rectangles):
            for columns in self._columns(rectangle):
                partition[slice(*rectangle[:2]), columns] = number
        if self.mask is not None:
            partition[~self.mask] = -1
        return partition

    def _columns(self, rectangle):
        """One or two slices of columns of the image that make the rectangle's."""
        start, stop = rectangle[2] + self.shift, rectangle[3] + self.shift
        if start >= self.width:
            return [slice(start - self.width, stop - self.width)]
        if stop <= self.width:
            return [slice(start, stop)]
        return [slice(start, self.width), slice(0, stop - self.width)]

    def _power(self, rows, columns):
        """Luminance times solid angle of some pixels, (rows, columns) float64."""
        mask = None if self.mask is None else self.mask[rows, columns]
        return pixel_power(self.image[rows, columns], self.solid_angles[rows], mask).astype(np.float64)

    def _fill(self):
        """Sums over the first 0, STEP, 2 STEP … columns of every row, and over rows of every column."""
        count = self.width // STEP
        whole = count * STEP
        across = self.across[:whole].reshape(count, STEP, 3)
        self._row_table = np.empty((self.height, count + 1, 3))
        self._row_table[:, 0] = 0
        self._column_table = np.empty((self.height // STEP + 1, self.width, 3))
        self._column_table[0] = 0
        for step, rows in enumerate(strips(self.height, STEP)):
            power = self._power(rows, slice(None))
            blocks = power[:, :whole].reshape(len(power), count, STEP).transpose(1, 0, 2) @ across
            np.cumsum(blocks.transpose(1, 0, 2), axis=1, out=self._row_table[rows, 1:])
            if len(power) == STEP:
                np.matmul(power.T, self.upward[rows], out=self._column_table[step + 1])
                self._column_table[step + 1] += self._column_table[step]

    def _rows_of(self, rows, columns):
        """Sums over some columns of power times (1, cos φ, sin φ), for some rows: (rows, 3)."""
        inner, ends = _whole_steps(columns)
        sums = self._row_table[rows, inner.stop] - self._row_table[rows, inner.start]
        return sums + sum(self._power(rows, end) @ self.across[end] for end in ends)

    def _columns_of(self, rows, columns):
        """Sums over some rows of power times (1, cos θ, sin θ), for some columns: (columns, 3)."""
        inner, ends = _whole_steps(rows)
        sums = self._column_table[inner.stop, columns] - self._column_table[inner.start, columns]
        return sums + sum(self._power(end, columns).T @ self.upward[end] for end in ends)


def _whole_steps(lines):
    """The whole steps of the tables inside some lines, and the lines before and after them.

    >>> _whole_steps(slice(10, 70))
    (slice(1, 2, None), [slice(10, 32, None), slice(64, 70, None)])
    """
    first, last = -(-lines.start // STEP), lines.stop // STEP
    if first >= last:
        return slice(0, 0), [lines]
    ends = slice(lines.start, first * STEP), slice(last * STEP, lines.stop)
    return slice(first, last), [end for end in ends if end.start < end.stop]
