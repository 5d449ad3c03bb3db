"""Quadtrees over pixels: split down to single pixels, for images of any size.

A tree stands on one or several sheets of equal size (the six faces of a cube map are six). All rectangles of
a level form a grid: a column range is halved whatever its rows are, and one of a single pixel stays as it is.
So neighbours are the neighbours in the grid, whole levels are handled at once, and nothing is searched.

Source: thesis, sections 7.4.2.1-7.4.2.2. Ranges are half-open, so that each pixel has one rectangle; the
splits are those printed (at the floor of the middle, into two where a side is one pixel long).
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np


class Cells(NamedTuple):
    """Rectangles x0 <= x < x1, y0 <= y < y1 [px] of the sheets of an image; each (n,) int64."""

    sheet: np.ndarray
    x0: np.ndarray
    y0: np.ndarray
    x1: np.ndarray
    y1: np.ndarray

    @property
    def area(self):
        """Pixels in each, (n,)."""
        return (self.x1 - self.x0) * (self.y1 - self.y0)

    def chosen(self, which):
        """Those at the indices, or where the mask is true."""
        return Cells(*(part[which] for part in self))


@dataclass(frozen=True, eq=False)
class Quadtree:
    """Which cells are split: ``splits[k]`` is boolean, (sheets, rows of level k, columns of level k).

    Level 0 has one cell a sheet. A cell of level k exists if the cells it lies in are all split.
    """

    sheets: int
    width: int
    height: int
    splits: tuple[np.ndarray, ...]

    def leaves(self):
        """The cells that are not split, level by level and row by row. They share out the sheets' pixels."""
        parts = []
        for level, exists in enumerate(self._existing()):
            unsplit = exists & ~self.splits[level] if level < len(self.splits) else exists
            parts.append(level_cells(self.width, self.height, level, np.nonzero(unsplit)))
        return Cells(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def _existing(self):
        exists = np.ones((self.sheets, 1, 1), dtype=bool)
        for level, split in enumerate(self.splits):
            yield exists
            exists = spread(split, self.width, self.height, level)
        yield exists


def build_quadtree(sheets, width, height, must_split):
    """The tree whose cells are split wherever ``must_split`` says so and they have more than one pixel.

    must_split: Cells -> boolean (n,); asked once for each level. Alg. 11, without the recursion.

    >>> tree = build_quadtree(1, 5, 3, lambda cells: cells.area > 6)
    >>> [tuple(int(n) for n in cell[1:]) for cell in zip(*tree.leaves())]
    [(0, 0, 2, 1), (2, 0, 5, 1), (0, 1, 2, 3), (2, 1, 5, 3)]

    Raises: ValueError for sheets without pixels.
    """
    if min(sheets, width, height) < 1:
        raise ValueError(f"{sheets} sheets of {width} x {height} px have no pixels: each must be at least 1")
    splits = []
    exists = np.ones((sheets, 1, 1), dtype=bool)
    for level in range(number_of_levels(width, height)):
        where = np.nonzero(exists)
        cells = level_cells(width, height, level, where)
        split = np.zeros(exists.shape, dtype=bool)
        split[where] = (cells.area > 1) & must_split(cells)
        splits.append(split)
        exists = spread(split, width, height, level)
    return Quadtree(sheets, width, height, tuple(splits))


def balanced(tree, inside, wraps=False):
    """The tree with more splits, until no leaf has a neighbour across a side that is two levels finer.

    inside: boolean (sheets, H, W); what has no pixel of it is left alone, for it will not be triangulated.
    wraps: the last column of a sheet is the neighbour of its first.

    One pass from the finest level to the coarsest does what Alg. 14 does with a list: where a cell is split,
    its four neighbours of the same level must exist, so what they lie in must be split.
    """
    splits = list(tree.splits)
    occupied = _occupied(inside, len(splits))
    for level in range(len(splits) - 2, -1, -1):
        size = tree.width, tree.height, level
        needed = _gathered(_with_neighbours(splits[level + 1], wraps), *size)
        splits[level] = splits[level] | (needed & occupied[level] & _divisible(*size))
    return Quadtree(tree.sheets, tree.width, tree.height, tuple(splits))


def without_strips(tree):
    """The tree with every leaf that is one pixel wide or high split into single pixels.

    Such leaves appear where a sheet's sides are no equal powers of two. They have no pixel corner inside for
    the triangles of 7.4.2.4 to meet in.
    """
    splits = list(tree.splits)
    exists = np.ones((tree.sheets, 1, 1), dtype=bool)
    for level, split in enumerate(splits):
        columns, rows = (np.diff(level_bounds(n, level)) for n in (tree.width, tree.height))
        strip = (rows[:, None] == 1) != (columns == 1)
        splits[level] = split | (exists & strip)
        exists = spread(splits[level], tree.width, tree.height, level)
    return Quadtree(tree.sheets, tree.width, tree.height, tuple(splits))


def number_of_levels(width, height):
    """Levels above that of single pixels."""
    return int(max(width, height) - 1).bit_length()


@lru_cache(maxsize=64)
def level_bounds(length, level):
    """Where the ranges of a level begin, and the end: increasing int64, read-only.

    >>> level_bounds(5, 2).tolist()
    [0, 1, 2, 3, 5]
    """
    bounds = np.array([0, length])
    for _ in range(level):
        bounds = np.union1d(bounds, (bounds[:-1] + bounds[1:]) // 2)
    bounds.flags.writeable = False
    return bounds


def level_cells(width, height, level, where):
    """Cells at ``where`` = (sheet, row, column), each (n,), in the grid of a level."""
    sheet, row, column = where
    x, y = level_bounds(width, level), level_bounds(height, level)
    return Cells(sheet, x[column], y[row], x[column + 1], y[row + 1])


def spread(flags, width, height, level):
    """Flags of a level's grid given to the cells of the next level that lie in them."""
    for axis, length in ((1, height), (2, width)):
        coarse, fine = level_bounds(length, level), level_bounds(length, level + 1)
        flags = np.repeat(flags, np.diff(np.searchsorted(fine, coarse)), axis=axis)
    return flags


def _gathered(flags, width, height, level):
    """For each cell of a level, whether any of the flags of the next level is in it."""
    for axis, length in ((1, height), (2, width)):
        coarse, fine = level_bounds(length, level), level_bounds(length, level + 1)
        first = np.searchsorted(fine, coarse[:-1])
        if len(fine) == 2 * len(coarse) - 1:  # all were halved: the common case, and faster this way
            before = (slice(None),) * axis
            flags = flags[(*before, slice(0, None, 2))] | flags[(*before, slice(1, None, 2))]
        else:
            flags = np.logical_or.reduceat(flags, first, axis=axis)
    return flags


def _occupied(inside, levels):
    height, width = inside.shape[1:]
    found = [inside]
    for level in range(levels - 1, -1, -1):
        found.append(_gathered(found[-1], width, height, level))
    return found[::-1]


def _divisible(width, height, level):
    columns, rows = (np.diff(level_bounds(length, level)) for length in (width, height))
    return (rows[:, None] > 1) | (columns > 1)


def _with_neighbours(flags, wraps):
    """Flags and their four neighbours."""
    near = flags.copy()
    near[:, 1:] |= flags[:, :-1]
    near[:, :-1] |= flags[:, 1:]
    near[:, :, 1:] |= flags[:, :, :-1]
    near[:, :, :-1] |= flags[:, :, 1:]
    if wraps:
        near[:, :, 0] |= flags[:, :, -1]
        near[:, :, -1] |= flags[:, :, 0]
    return near
