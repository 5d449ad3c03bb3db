"""Which region of a depth map goes to which layer: those that hide others before them."""

from __future__ import annotations

import heapq
from collections import Counter, defaultdict

import numpy as np

from .grid import PixelGrid


def levels(count: int, labels, grid: PixelGrid, near, jumps, most: int | None = None) -> np.ndarray:
    """The level (count,) of every region: 0 behind all, and regions with a jump between them never the same.

    count, labels: of `regions`. near: (size,) 1/depth. jumps: (4, size), of `cuts`. A region is one level
    before the foremost of those that it hides part of. Where regions hide each other in a circle the weakest
    of these, of the fewest pixels, gives way. A region that hides nothing, and has more of its rim along
    regions before level 0 than along others, as a seat has between its armrests, goes to the level of these.
    most: levels above it are made one, and jumps stay within them.
    """
    hides, hidden_by = defaultdict(dict), defaultdict(list)
    pixel, other = grid.pairs(jumps)
    for (a, b), weight in _counted(labels, pixel, other, near[pixel] > near[other]):
        hides[a][b] = weight
        hidden_by[b].append(a)
    level = _ordered(count, hides, hidden_by)
    pixel, other = grid.pairs(~jumps & (labels != labels[grid.neighbours]))
    along = defaultdict(Counter)
    for (a, b), weight in _counted(labels, pixel, other, slice(None)):
        along[a][b] = weight
    _join_objects(level, along, hides, hidden_by)
    found = np.array(level, dtype=np.int32)
    return found if most is None else np.minimum(found, most - 1)


def _counted(labels, pixel, other, chosen):
    """How often two regions meet: ((a, b), n)."""
    pairs, weights = np.unique(
        np.stack([labels[pixel[chosen]], labels[other[chosen]]], axis=1), axis=0, return_counts=True
    )
    return zip(map(tuple, pairs.tolist()), weights.tolist(), strict=True)


def _ordered(count, hides, hidden_by):
    """Levels, taking next the region whose regions behind are all done, or of the least weight not done."""
    waiting = [sum(hides[region].values()) for region in range(count)]
    heap = [(weight, region) for region, weight in enumerate(waiting)]
    heapq.heapify(heap)
    level = [-1] * count
    while heap:
        weight, region = heapq.heappop(heap)
        if level[region] >= 0 or weight != waiting[region]:
            continue
        beside = [*hides[region], *hidden_by[region]]
        level[region] = 1 + max((level[other] for other in beside), default=-1)
        for other in hidden_by[region]:
            if level[other] < 0:
                waiting[other] -= hides[other][region]
                heapq.heappush(heap, (waiting[other], other))
    return level


def _join_objects(level, along, hides, hidden_by):
    for region, rim in along.items():
        if level[region]:
            continue
        of_level = Counter()
        for other, weight in rim.items():
            of_level[level[other]] += weight
        taken = {level[other] for other in (*hides[region], *hidden_by[region])}
        if 2 * of_level[0] < of_level.total():
            free = [found for found, _ in of_level.most_common() if found and found not in taken]
            level[region] = free[0] if free else 0
