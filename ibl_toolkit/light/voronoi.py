"""Spherical Voronoi regions as a partition image: every pixel goes to the site nearest by great circle.

A block of pixels lies within an angle r of its middle. If the nearest site of the middle is at an angle a, a
site beyond a + 2 r is nearest to none of the block's pixels, by the triangle inequality. So the sites are
sifted for large blocks first, those that remain for their quarters, and so on down to single pixels; a block
with one site left is filled. All distances are taken on the sphere, so the seam and the poles are nothing
special. Only what lies along the borders of the regions is ever looked at pixel by pixel.

Source: thesis section 3.1.3.2 (Voronoi partition of the sphere, kept as an equirectangular image).
"""

import numpy as np

from .. import equirectangular

_ROOT = 256
"""Pixels along the sides of the largest blocks; a power of two. A row of them is worked on at once."""
_SLACK = 1e-7
"""Rounding of an arc cosine near 1 [rad]."""
_DIGITS = 14
"""Decimals by which sites at one place are told: rounding makes the 15th differ."""


def voronoi_partition(directions, width, height, mask=None):
    """Number of the nearest site for each pixel centre, (H, W) int32; -1 outside ``mask`` (H, W).

    ``directions`` (n, 3) are the sites, of any length but zero. Of sites at one place the first gets all
    pixels. Exact but for ties closer than float64's rounding.

    Raises: ValueError without a site, and for directions that are zero or not finite.

    >>> voronoi_partition([[0, 0, 1], [0, 0, -1]], 4, 2)
    array([[0, 0, 0, 0],
           [1, 1, 1, 1]], dtype=int32)
    """
    unit = unit_directions(directions)
    if not len(unit):
        raise ValueError("there are 0 sites; expected at least one direction")
    # Sites at one place would keep their blocks from ever having one site left.
    numbers = np.sort(np.unique(unit.round(_DIGITS), axis=0, return_index=True)[1]).astype(np.int32)
    unit = np.ascontiguousarray(unit[numbers].T)
    partition = np.empty((height, width), np.int32)
    for top in range(0, height, _ROOT):
        rows = slice(top, min(top + _ROOT, height))
        chosen = None if mask is None else mask[rows]
        if chosen is not None and not chosen.any():
            partition[rows] = -1
            continue
        strip = _strip(unit, numbers, _Grid(width, height, top), chosen)
        partition[rows] = strip[: rows.stop - top, :width]
        if chosen is not None:
            partition[rows][~chosen] = -1
    return partition


def unit_directions(directions):
    """Directions (n, 3), float64, of length 1; ValueError for one that is zero or not finite."""
    directions = np.asarray(directions, dtype=np.float64).reshape(-1, 3)
    if not len(directions):
        return directions
    components = np.stack(equirectangular.direction_components(directions), axis=1)
    return components / np.linalg.norm(components, axis=1, keepdims=True)


class _Grid:
    """Middles and radii of the blocks of one strip of rows, by block size."""

    def __init__(self, width, height, top):
        self.width, self.height, self.top = width, height, top
        self.columns = -(-width // _ROOT)

    def horizontal(self, size):
        """Cosine and sine of the azimuth of the middles, each (columns · _ROOT / size,)."""
        middles = np.arange(self.columns * _ROOT // size) * size + (size - 1) / 2
        azimuths = (0.5 - (middles + 0.5) / self.width) * (2 * np.pi)
        return np.cos(azimuths), np.sin(azimuths)

    def vertical(self, size):
        """Cosine and sine of the middles' elevation and the radius of the blocks [rad], each (_ROOT / size,).

        The pixel centre of a block that is farthest from its middle is one of its corners, as long as the
        block is less than half a turn wide.
        """
        first = self.top + np.arange(_ROOT // size) * size
        rows = np.minimum(np.stack([first, first + size - 1]), self.height - 1)  # rows below the image: none
        low_high = (0.5 - (rows + 0.5) / self.height) * np.pi
        middle = low_high.mean(axis=0)
        half_turn = np.pi * (size - 1) / self.width
        if half_turn >= np.pi / 2:
            return np.cos(middle), np.sin(middle), np.full(len(middle), np.pi)
        cosines = np.cos(low_high) * np.cos(middle) * np.cos(half_turn) + np.sin(low_high) * np.sin(middle)
        radii = np.arccos(np.clip(cosines.min(axis=0), -1, 1)) if size > 1 else np.zeros(len(middle))
        return np.cos(middle), np.sin(middle), radii


def _strip(unit, numbers, grid, chosen):
    """Partition of a strip of rows, (_ROOT, columns · _ROOT); outside the mask it means nothing."""
    rows = np.repeat(np.zeros(grid.columns, np.int32), unit.shape[1])
    columns = np.repeat(np.arange(grid.columns, dtype=np.int32), unit.shape[1])
    sites = np.tile(np.arange(unit.shape[1], dtype=np.int32), grid.columns)
    labels = np.zeros((1, grid.columns), np.int32)
    size = _ROOT
    while True:
        rows, columns, sites, is_first = _sifted(unit, grid, size, rows, columns, sites)
        is_alone = is_first & np.append(is_first[1:], True)
        labels[rows[is_first], columns[is_first]] = numbers[sites[is_first]]
        if size == 1:
            return labels
        left = ~is_alone
        size //= 2
        labels = labels.repeat(2, axis=0).repeat(2, axis=1)
        rows, columns, sites = _quarters(rows[left], columns[left], sites[left])
        if chosen is not None:
            inside = _any_in_block(chosen, size, labels.shape)[rows, columns]
            rows, columns, sites = rows[inside], columns[inside], sites[inside]


def _sifted(unit, grid, size, rows, columns, sites):
    """The pairs of block and site without sites that are nearest to no pixel; which is its block's first.

    Pairs of one block follow each other, sites in ascending order.
    """
    if not len(rows):
        return rows, columns, sites, np.zeros(0, bool)
    cos_azimuth, sin_azimuth = grid.horizontal(size)
    cos_elevation, sin_elevation, radii = grid.vertical(size)
    cosines = unit[0][sites] * cos_azimuth[columns]
    cosines += unit[1][sites] * sin_azimuth[columns]
    cosines *= cos_elevation[rows]
    cosines += unit[2][sites] * sin_elevation[rows]
    is_first = _changes(rows, columns)
    starts = np.flatnonzero(is_first)
    lengths = np.diff(starts, append=len(rows))
    nearest = np.maximum.reduceat(cosines, starts)
    reach = np.arccos(np.clip(nearest, -1, 1)) + 2 * radii[rows[starts]] + _SLACK
    least = np.where(reach < np.pi, np.cos(np.minimum(reach, np.pi)), -2.0)
    if size == 1:
        least = nearest  # no pixel but the middle itself
    kept = cosines >= np.repeat(least, lengths)
    rows, columns, sites = rows[kept], columns[kept], sites[kept]
    return rows, columns, sites, _changes(rows, columns)


def _changes(rows, columns):
    """Where a pair belongs to another block than the pair before."""
    changes = np.ones(len(rows), bool)
    np.logical_or(rows[1:] != rows[:-1], columns[1:] != columns[:-1], out=changes[1:])
    return changes


def _quarters(rows, columns, sites):
    """The same pairs for the four quarters of each block, sorted by block again."""
    if not len(rows):
        return rows, columns, sites
    starts = np.flatnonzero(_changes(rows, columns))
    lengths = np.diff(starts, append=len(rows))
    # Pair k of a block of m pairs at s becomes pairs 4 s + k + (0, m, 2 m, 3 m).
    within = np.arange(len(rows)) - np.repeat(starts, lengths)
    target = np.repeat(4 * starts, lengths) + within
    stride = np.repeat(lengths, lengths)
    quarters = [np.empty(4 * len(rows), np.int32) for _ in range(3)]
    for quarter in range(4):
        place = target + quarter * stride
        quarters[0][place] = 2 * rows + quarter // 2
        quarters[1][place] = 2 * columns + quarter % 2
        quarters[2][place] = sites
    return tuple(quarters)


def _any_in_block(chosen, size, shape):
    """Which blocks, of ``shape``, have a chosen pixel."""
    padded = np.zeros((shape[0] * size, shape[1] * size), bool)
    padded[: chosen.shape[0], : chosen.shape[1]] = chosen
    return padded.reshape(shape[0], size, shape[1], size).any(axis=(1, 3))
