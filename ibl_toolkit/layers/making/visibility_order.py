"""Which layer may hide which, from anywhere within the radius.

Source: thesis, section 6.2.4.4: the order is partial, and holds for some places only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..panorama import EQUIRECTANGULAR, LayeredPanorama
from .discontinuities import nearness
from .flood import flood
from .grid import PixelGrid, grid_of

_WIDTH = 512  # of the map on which layers are compared
_MARGIN_PX = 2.0
_APART = 1.1
"""Ratio of distances from which on of two surfaces within the radius one is before the other."""
_NOTHING, _RIM = 9.0, np.pi / 2


@dataclass(frozen=True)
class VisibilityOrder:
    """hides: for each layer those it may hide part of. order: names from back to front, so that painting them
    in turn is right from anywhere within the radius, but for the layers of a cycle. cycles: names of layers
    each of which may hide another and be hidden, directly or by way of others.
    """

    hides: dict[str, tuple[str, ...]]
    order: tuple[str, ...]
    cycles: tuple[tuple[str, ...], ...]


def visibility_order(panorama: LayeredPanorama) -> VisibilityOrder:
    """Compare layers on a map of 512 x 256 px, two of whose pixels are the margin.

    Point x of layer A hides point y of B from somewhere within the radius r only if the angle between them
    is at most asin(r/d_x) − asin(r/d_y). (The line of sight that touches the ball is the widest.) Two layers
    that meet, as floor and wall, do not hide each other. Of two that are nearer than r, the one that is
    nearer in a pixel by a tenth hides the other, as it does from the origin; from the far side, where an eye
    within r may go, the other may hide it: that isn't looked at.

    >>> from ..panorama import Layer
    >>> far = Layer("far", "equirectangular", {"depth": np.full((16, 32), 4.0)})
    >>> post = np.where(np.arange(32) < 4, 1, np.full((16, 32), np.nan))
    >>> near = Layer("near", "equirectangular", {"depth": post})
    >>> found = visibility_order(LayeredPanorama((near, far), np.eye(3), np.zeros(3), 0.5))
    >>> found.hides, found.order, found.cycles
    ({'near': ('far',), 'far': ()}, ('far', 'near'), ())
    """
    grid = PixelGrid(EQUIRECTANGULAR, _WIDTH, _WIDTH // 2)
    extremes = [_angles(grid, layer, panorama.radius) for layer in panorama.layers]
    names = [layer.name for layer in panorama.layers]
    margin, everywhere = _MARGIN_PX * grid.pixel, np.ones(grid.size, dtype=bool)
    hides = {}
    for name, (nearest, _) in zip(names, extremes, strict=True):
        pixels = np.flatnonzero(nearest > -1)
        reach, _ = flood(grid, pixels, pixels, np.minimum(nearest[pixels], _RIM), everywhere)
        hides[name] = tuple(
            other
            for other, (_, farthest) in zip(names, extremes, strict=True)
            if other != name and ((reach > farthest + margin).any() or _is_before(nearest, farthest))
        )
    return VisibilityOrder(hides, *_ordered(hides))


def _is_before(nearest, farthest):
    """Whether in some pixel both are within the radius, and the one before the other."""
    within = (farthest > _RIM) & (farthest < _NOTHING)
    return (within & (nearest > farthest + np.log(_APART))).any()


def _angles(grid, layer, radius):
    """asin(r/d) (size,) of the nearest point of a layer in each pixel, and of the farthest; none: -1, 9.

    Within the radius π/2 + log(r/d).
    """
    own = grid_of(layer)
    inside = own.flat(layer.mask)
    ratio = radius * own.flat(nearness(layer.depth))[inside]
    angle = np.arcsin(np.minimum(ratio, 1)) + np.log(np.clip(ratio, 1, np.exp(_NOTHING - 2)))
    nearest, farthest = np.full(grid.size, -1, np.float32), np.full(grid.size, _NOTHING, np.float32)
    pixel = grid.at(own.directions[inside])
    np.maximum.at(nearest, pixel, angle)
    np.minimum.at(farthest, pixel, angle)
    if own.pixel > grid.pixel:  # pixels between those of a coarse layer
        there = own.at(grid.directions)
        whole = np.full(own.size, np.nan, np.float32)
        whole[inside] = angle
        nearest, farthest = (np.where(inside[there], whole[there], none) for none in (-1, _NOTHING))
    return nearest.astype(np.float32), farthest.astype(np.float32)


def _ordered(hides):
    """Names from back to front, and the cycles among them."""
    reachable = {name: _reached(hides, name) for name in hides}
    group = {
        name: tuple(
            other
            for other in hides
            if other == name or (other in reachable[name] and name in reachable[other])
        )
        for name in hides
    }
    cycles = tuple(dict.fromkeys(names for names in group.values() if len(names) > 1))
    # Whoever may hide more lies farther in front: all that it reaches is among what it comes before.
    order = sorted(hides, key=lambda name: len(reachable[name] | set(group[name])))
    return tuple(order), cycles


def _reached(hides, name):
    found, left = set(), [name]
    while left:
        for other in hides[left.pop()]:
            if other not in found:
                found.add(other)
                left.append(other)
    return found
