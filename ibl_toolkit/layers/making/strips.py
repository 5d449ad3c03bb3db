"""What of a layer is hidden, yet near enough to an edge to come into view: where it is, and its depth."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count

import numpy as np

from .discontinuities import cuts
from .flood import flood
from .grid import PixelGrid
from .planes import local_planes
from .regions import parallax

_MARGIN_PX = 1.5
_LEAST_SHARE = 0.25  # of 1/depth where it began: nothing is continued farther away than that
_ROUNDS = 8


@dataclass(frozen=True)
class Strip:
    """Hidden pixels (n,) of a layer, their 1/depth (n,), and the regions (n,) they continue.

    seen: (n,) whether that is known, and not continued; there the region is -1.
    """

    pixels: np.ndarray
    near: np.ndarray
    labels: np.ndarray
    seen: np.ndarray


def hidden_strip(
    grid: PixelGrid, near, labels, level, this: int, planes, flat, radius: float, known=None
) -> Strip:
    """What layer `this` has behind those before it, as wide as `parallax` says.

    near, labels, level: (size,) 1/depth, region and level of pixels. planes, flat: of `region_planes`.
    known: (size,) 1/depth of what is known to be behind, NaN where nothing is, or None: it is taken wherever
    a layer before `this` hides it, however far from an edge.
    A region is continued by no more than its own width, the root of its area: a chink tells little.

    Depth goes on as it was, 1/depth linear: a flat region by its plane, others by that of the edge's
    surroundings. Where strips of two flat regions meet, the nearer of both planes is taken, so that a hidden
    corner of a room is where it is. Nothing is nearer than what hides it, or four times as far as where it
    began. Pixels at which what was found jumps are left out.
    """
    behind, before = grid.pairs((level == this) & (level[grid.neighbours] > this))
    width = np.sqrt(np.bincount(labels))[labels[behind]] * grid.pixel
    reach = np.minimum(parallax(radius, near[before], near[behind]), width) + _MARGIN_PX * grid.pixel
    allowed = level > this
    left, number = flood(grid, before, behind, reach, allowed)
    pixels = np.flatnonzero(number >= 0)
    start = behind[number[pixels]]
    found, regions = _continued(grid, near, labels, pixels, start, reach[number[pixels]], planes, flat)
    found = np.minimum(np.maximum(found, _LEAST_SHARE * near[start]), near[pixels])
    rest, seen = left[pixels], np.zeros(len(pixels), dtype=bool)
    if known is not None:
        hides = allowed & (known < near)
        own = ~hides[pixels]
        there = np.flatnonzero(hides)
        pixels, found = np.append(pixels[own], there), np.append(found[own], known[there])
        regions = np.append(regions[own], np.full(len(there), -1))
        rest = np.append(rest[own], np.full(len(there), np.float32(np.pi)))
        seen = np.arange(len(pixels)) >= np.count_nonzero(own)
    keep = _without_jumps(grid, near, level == this, pixels, found, rest, radius)
    return Strip(pixels[keep], found[keep], regions[keep], seen[keep])


def _continued(grid, near, labels, pixels, start, reach, planes, flat):
    """1/depth (n,) of hidden pixels and the regions (n,) it was taken from."""
    regions = labels[start].copy()
    bent = ~flat[regions]
    chosen = planes[regions]
    if bent.any():
        used, which = np.unique(start[bent], return_inverse=True)
        farthest = np.zeros(len(used))
        np.maximum.at(farthest, which.reshape(-1), reach[bent])
        chosen[bent] = local_planes(grid, near, labels, used, farthest)[which.reshape(-1)]
    directions = grid.directions[pixels]
    found = np.einsum("nk,nk->n", chosen, directions)
    for here, region in _meeting(grid, pixels, regions, flat):
        other = directions[here] @ planes[region]
        nearer = other > found[here]
        found[here[nearer]], regions[here[nearer]] = other[nearer], region
    return found, regions


def _meeting(grid, pixels, regions, flat):
    """Which hidden pixels border on a strip of another flat region: indices into `pixels`, that region."""
    label = np.full(grid.size, -1, dtype=np.int32)
    label[pixels] = np.where(flat[regions], regions, -1)
    number, cell = grid.components(label >= 0, label == label[grid.neighbours])
    own, others = cell[pixels], cell[grid.neighbours[:, pixels]]
    meets = (own >= 0) & (others >= 0) & (own != others)
    slot, place = np.nonzero(meets)
    pairs = np.unique(np.stack([own[place], others[slot, place]], axis=1), axis=0)
    order = np.argsort(own, kind="stable")
    ends = np.searchsorted(own[order], np.arange(number + 1))
    region = regions[order[ends[:-1]]] if number else regions
    return [(order[ends[one] : ends[one + 1]], int(region[other])) for one, other in pairs.tolist()]


def _without_jumps(grid, near, visible, pixels, found, left, radius):
    """Which hidden pixels (n,) to keep, so that 1/depth jumps nowhere in the layer."""
    rest = np.full(grid.size, -np.inf, dtype=np.float32)
    rest[pixels] = left
    values = np.where(visible, near, np.float32(np.nan))
    values[pixels] = found
    rest[visible] = np.inf
    for attempt in count():
        pixel, other = grid.pairs(cuts(grid, values, radius))
        hidden = ~visible[pixel]
        if not hidden.any():
            return ~np.isnan(values[pixels])
        less = (rest[pixel] <= rest[other]) | (attempt >= _ROUNDS)
        values[pixel[hidden & less]] = np.nan
