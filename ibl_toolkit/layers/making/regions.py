"""Closed regions of a depth map, between curves where depth jumps or a surface has a hollow crease.

Source: thesis, section 6.3.1: curves where depth jumps are joined along those where normals do.
"""

from __future__ import annotations

import numpy as np

from .flood import flood
from .grid import PixelGrid

_JOINED_PX = 2  # curves whose ends are twice as far apart are joined
_ROUNDS = 3
_MARGIN_PX = 1.5


def parallax(radius: float, nearer: np.ndarray, farther: np.ndarray) -> np.ndarray:
    """The widest strip [rad], seen from the origin, that a view within `radius` [m] can see behind an edge.

    nearer, farther: 1/depth [1/m] of the edge and of what is behind it. A line of sight past the edge that
    touches the ball of the radius makes asin(r/d) with the ray to a point of it at distance d, so

        width = asin(r/d_near) − asin(r/d_far).

    Where the edge is nearer than r, an eye within r may go round it and see all that is behind: π.

    >>> float(np.degrees(parallax(0.5, np.array(1.0), np.array(0.0))).round(6))
    30.0
    """
    one, other = (np.arcsin(np.minimum(radius * near, 1)) for near in (nearer, farther))
    return np.where((radius * nearer >= 1) & (nearer > farther), np.pi, np.maximum(one - other, 0))


def regions(grid: PixelGrid, near, jumps, hollows, radius: float) -> tuple[int, np.ndarray]:
    """How many regions there are, and that of every pixel (size,), int32; no jump is inside of one.

    near: (size,) 1/depth, NaN outside of the domain, where the region is -1. jumps, hollows: (4, size), of
    `cuts` and `creases`. Curves of both sorts that end less than 4 px from another are joined. Where a curve
    of jumps ends in the midst of a surface, the near side gets a region of its own, as wide as the parallax
    there.
    """
    count, labels = _between_curves(grid, ~np.isnan(near), ~(jumps | hollows), ~jumps)
    for _ in range(_ROUNDS):
        _, other = _inner_jumps(grid, labels, near, jumps)
        _give_away(grid, labels, np.unique(other), ~jumps)
    for _ in range(_ROUNDS):
        pixel, other = _inner_jumps(grid, labels, near, jumps)
        if not len(pixel):
            return count, labels
        count, labels = _with_tongues(grid, labels, count, near, jumps, radius, pixel, other)
    pixel, _ = _inner_jumps(grid, labels, near, jumps)
    labels[np.unique(pixel)] = count + np.arange(len(np.unique(pixel)))
    return count + len(np.unique(pixel)), labels


def _between_curves(grid, inside, joined, whole):
    """Parts of the domain between the curves: found away from them, so that small gaps are closed, then grown
    up to them.

    joined: slots that no curve is between; whole: those without a jump, by which pixels that lie between two
    curves of creases join a part beside them.
    """
    near_curve = ~joined.all(axis=0)
    for _ in range(_JOINED_PX):
        near_curve[grid.beside(np.flatnonzero(near_curve))] = True
    count, labels = grid.components(inside & ~near_curve, joined)
    for ways in (joined, whole):
        _grow(grid, labels, inside, ways)
    left = inside & (labels < 0)
    more, found = grid.components(left, whole)
    labels[left] = found[left] + count
    return count + more, labels


def _grow(grid, labels, inside, ways):
    """Give the domain's pixels without a label (-1) one of their neighbours', so far as curves are thick."""
    left = np.flatnonzero(inside & (labels < 0))
    for _ in range(2 * _JOINED_PX + 1):
        there = np.where(ways[:, left], labels[grid.beside(left)], -1).max(axis=0)
        labels[left] = there
        left = left[there < 0]


def _give_away(grid, labels, pixels, whole):
    """Give pixels (n,) to the region of a neighbour that no jump parts them from, if another has one."""
    there = np.where(whole[:, pixels], labels[grid.beside(pixels)], -1)
    there = np.where(there == labels[pixels], -1, there).max(axis=0)
    labels[pixels] = np.where(there >= 0, there, labels[pixels])


def _inner_jumps(grid, labels, near, jumps):
    """Near pixels, and far ones, each (n,), of jumps within a region."""
    pixel, other = grid.pairs(jumps)
    inner = (labels[pixel] == labels[other]) & (near[pixel] > near[other])
    return pixel[inner], other[inner]


def _with_tongues(grid, labels, count, near, jumps, radius, pixel, other):
    """Regions with those beside jumps inside of them: what is closer to the near side than to the far one."""
    starts = np.concatenate([other, pixel])
    width = parallax(radius, near[pixel], near[other]) + _MARGIN_PX * grid.pixel
    affected = np.zeros(count, dtype=bool)
    affected[labels[pixel]] = True
    inside = np.flatnonzero(labels >= 0)
    allowed, joined = np.zeros(grid.size, dtype=bool), np.zeros(jumps.shape, dtype=bool)
    allowed[inside] = affected[labels[inside]]
    joined[:, inside] = (labels[grid.beside(inside)] == labels[inside]) & ~jumps[:, inside]
    _, number = flood(grid, starts, starts, np.tile(width, 2), allowed, joined)
    tongue = number >= len(other)
    more, found = grid.components(tongue, joined)
    labels[tongue] = found[tongue] + count
    return count + more, labels
