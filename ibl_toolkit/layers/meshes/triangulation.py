"""Triangles over rectangles of pixels that leave no corner in the middle of a triangle's side.

Source: thesis, section 7.4.2.4: a rectangle with no vertex inside its sides becomes two triangles; any other
gets a vertex at its middle, joined to all on its sides. Every vertex that any rectangle has there is taken,
so that the result has no T-junction whether or not the rectangles are balanced.
"""

import numpy as np


def triangulate_cells(cells, corners):
    """Triangles (T, 3) of corner numbers, int64, over ``cells`` of the map of ``corners``.

    Seen from the panorama's origin they run counter-clockwise. A triangle that shrinks to a line at a pole is
    left out. Raises ValueError for a cell that is one pixel wide or high and has a vertex inside a side.
    """
    numbers = _corner_numbers(cells, corners.shape)
    used = _used_corners(numbers, corners)
    edges = np.zeros(len(cells.x0), dtype=np.int64)
    chains = []
    for (start, end), turned in (((0, 1), True), ((1, 2), False), ((3, 2), True), ((0, 3), False)):
        chain = _Chain(used, numbers[start], numbers[end], turned)
        edges += chain.edges
        chains.append(chain)
    plain = edges == 4
    strips = ~plain & ((cells.x1 - cells.x0 == 1) | (cells.y1 - cells.y0 == 1))
    if strips.any():
        raise ValueError(
            f"{np.count_nonzero(strips)} cells are one pixel wide or high and have finer neighbours"
        )
    parity = cells.x0 // (cells.x1 - cells.x0) + cells.y0 // (cells.y1 - cells.y0)
    triangles = [_pairs(numbers[:, plain], parity[plain])]
    fans = np.flatnonzero(~plain)
    middles = _corner_number(
        corners.shape, cells.sheet[fans], (cells.x0 + cells.x1)[fans] // 2, (cells.y0 + cells.y1)[fans] // 2
    )
    # Down the left, right along the bottom; up the right and left along the top run against the numbers.
    for chain, reverse in zip(chains, (False, False, True, True), strict=True):
        of_fan, one, other = chain.steps(fans)
        one, other = (other, one) if reverse else (one, other)
        triangles.append(np.stack([middles[of_fan], one, other], axis=1))
    return _without_lines(corners.known_as(np.concatenate(triangles)))


def triangulate_pixels(inside, corners):
    """Triangles (T, 3) of corner numbers, two for each pixel that is ``inside`` (sheets, rows, columns).

    Seen from the panorama's origin they run counter-clockwise; at a pole only one of the two is left.
    Source: section 7.4.1. The numbers are int32, which holds those of maps up to 46k x 23k.
    """
    sheet, row, column = (axis.astype(np.int32) for axis in np.nonzero(inside))
    first = (sheet * corners.shape[1] + row) * corners.shape[2] + column
    below = np.int32(corners.shape[2])
    numbers = np.stack([first, first + below, first + below + 1, first + 1])
    return _without_lines(_pairs(corners.known_as(numbers), row + column))


class _Chain:
    """The used corners along one side of each cell, in rising order."""

    def __init__(self, used, start, end, turned):
        self.points, order = _in_order(used, turned)
        self.first, last = (np.searchsorted(order, _turned(c, used.shape, turned)) for c in (start, end))
        self.edges = last - self.first

    def steps(self, cells):
        """For each edge of these cells: which of them (an index), and its two corners."""
        counts = self.edges[cells]
        which = np.repeat(np.arange(len(cells)), counts)
        step = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
        here = self.first[cells][which] + step
        return which, self.points[here], self.points[here + 1]


def _in_order(used, turned):
    """Used corners row by row, or column by column if turned; and what to look them up by."""
    if not turned:
        points = np.flatnonzero(used)
        return points, points
    order = np.flatnonzero(used.swapaxes(1, 2))
    sheets, rows, columns = used.shape
    sheet, column, row = np.unravel_index(order, (sheets, columns, rows))
    return np.ravel_multi_index((sheet, row, column), used.shape), order


def _turned(numbers, shape, turned):
    if not turned:
        return numbers
    sheets, rows, columns = shape
    sheet, row, column = np.unravel_index(numbers, shape)
    return np.ravel_multi_index((sheet, column, row), (sheets, columns, rows))


def _corner_numbers(cells, shape):
    """(4, n): top left, bottom left, bottom right, top right; counter-clockwise as the origin sees them."""
    x0, y0, x1, y1 = cells.x0, cells.y0, cells.x1, cells.y1
    return np.stack(
        [_corner_number(shape, cells.sheet, *xy) for xy in ((x0, y0), (x0, y1), (x1, y1), (x1, y0))]
    )


def _corner_number(shape, sheet, x, y):
    return (sheet * shape[1] + y) * shape[2] + x


def _used_corners(numbers, corners):
    """Boolean lattice of the cells' corners, with all that lie on the same point across a seam."""
    used = np.zeros(corners.shape, dtype=bool)
    flat = used.reshape(-1)
    flat[numbers.reshape(-1)] = True
    duplicates, names = corners.duplicates
    if corners.wraps:  # the poles are no seam: a cell there needs no other cell's corners
        poles = np.isin(names, (0, names[-1]))
        duplicates, names = duplicates[~poles], names[~poles]
    flat[names[flat[duplicates]]] = True
    flat[duplicates] = flat[names]
    return used


def _pairs(numbers, parity):
    """Two triangles a cell; the diagonals of neighbours alternate (4-8 mesh, figure 7-9)."""
    a, b, c, d = numbers
    falling = parity % 2 == 0
    triangles = np.empty((2, len(a), 3), dtype=a.dtype)
    triangles[:, :, 0] = a, np.where(falling, a, b)
    triangles[:, :, 1] = b, c
    triangles[:, :, 2] = np.where(falling, c, d), d
    return triangles.reshape(-1, 3)


def _without_lines(triangles):
    a, b, c = triangles.T
    return triangles[(a != b) & (b != c) & (c != a)]
