"""The pixels whose centres triangles cover, found row by row, for blocks of triangles at once.

A triangle owns the centres (x, y) with left <= x < right in the rows with top <= y < bottom, where left and
right are the places at which two of its sides cross the row. Two triangles find the crossing of the side that
they share from the same numbers in the same order, so whatever the rounding, each centre there belongs to one
of them: no cracks, and no pixel twice.
"""

from itertools import pairwise

import numpy as np

from .camera_space import on_picture

_BLOCK = 1 << 18  # rows or pixels at once: what they need stays near the processor


def fragments(corners, camera):
    """Yield blocks of covered pixels: row, column, distance [m] along forward and triangle, each (m,).

    corners: (n, 3, 3) [m] of triangles, to the right, down and forward of the camera, all before it.
    """
    x, y, near = _sorted_by_row(*on_picture(corners, camera))
    first_rows = first_centre(y, camera.height)
    rows = first_rows[2] - first_rows[0]
    for block in _blocks(rows):
        triangle, row = _expanded(rows[block], first_rows[0, block])
        triangle += block.start
        ends = _row_ends(x, y, near, triangle, row, first_rows[1])
        columns = first_centre(ends[0, 0], camera.width), first_centre(ends[1, 0], camera.width)
        widths = columns[1] - columns[0]
        for part in _blocks(widths):
            span, column = _expanded(widths[part], columns[0][part])
            span += part.start
            (left, near_left), (right, near_right) = ends[0, :, span].T, ends[1, :, span].T
            share = (column + 0.5 - left) / (right - left)
            yield row[span], column, 1.0 / (near_left + share * (near_right - near_left)), triangle[span]


def first_centre(place, size):
    """Number of the first pixel whose centre is at ``place`` [px] or after it, from 0 to size."""
    return np.ceil(np.clip(place, 0, size) - 0.5).astype(np.int32)


def _sorted_by_row(x, y, near):
    """The vertices (n, 3) from top to bottom, each as (3, n)."""
    values = [np.ascontiguousarray(v.T) for v in (x, y, near)]
    for upper, lower in ((0, 1), (1, 2), (0, 1)):
        swapped = values[1][upper] > values[1][lower]
        for v in values:
            v[upper], v[lower] = np.where(swapped, v[lower], v[upper]), np.where(swapped, v[upper], v[lower])
    return values


def _row_ends(x, y, near, triangle, row, first_row_of_middle):
    """(2, 2, n): at the left and right end of each row, the column and the reciprocal of the distance."""
    upper = row < first_row_of_middle[triangle]
    height = row + 0.5
    ends = np.empty((2, 2, len(row)))
    for side, (a, b) in enumerate(((0, 2), (np.where(upper, 0, 1), np.where(upper, 1, 2)))):
        top, bottom = y[a, triangle], y[b, triangle]
        share = (height - top) / (bottom - top)
        for k, values in enumerate((x, near)):
            start = values[a, triangle]
            ends[side, k] = start + share * (values[b, triangle] - start)
    wrong = ends[0, 0] > ends[1, 0]
    ends[:, :, wrong] = ends[::-1, :, wrong]
    return ends


def _expanded(counts, first):
    """Indices of what has ``counts`` parts, once for each, and the parts' numbers, counted from ``first``."""
    which = np.repeat(np.arange(len(counts)), counts)
    before = np.cumsum(counts) - counts
    return which, np.arange(len(which)) - (before - first)[which]


def _blocks(counts):
    """Slices of what has ``counts`` (n,) parts, of about _BLOCK parts each."""
    ends = np.cumsum(counts, dtype=np.int64)
    total = int(ends[-1]) if len(ends) else 0
    borders = np.searchsorted(ends, np.arange(0, total, _BLOCK), side="right")
    borders = np.unique(np.append(borders, len(counts)))
    return [slice(int(a), int(b)) for a, b in pairwise(borders)]
