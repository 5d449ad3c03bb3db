"""Continuous layers of the successive surfaces along rays.

A layer of successive surfaces is of many things, and its depth jumps from one to the next. The first surfaces
are split as those of an RGB-D panorama are; the farthest that was found behind them goes to the background,
where a picture alone would have to be continued. What is between stays in layers of its own.

Source: thesis, 6.2 (eq. 6.10, a layer is continuous) and 6.3.2.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..panorama import LayeredPanorama
from .continuous_pieces import continuous_pieces
from .discontinuities import nearness
from .grid import PixelGrid, grid_of
from .splitting import split_layers


def continuous_layers(
    panorama: LayeredPanorama, surfaces: Sequence[str], count: int | None = None
) -> LayeredPanorama:
    """Layers `background`, `front 1`, … of a panorama's surfaces, and its other layers without jumps.

    surfaces: names of the layers that follow each other along the rays, the first of the whole sphere; all of
    one size. count: layers at most that the first is split into; None for as many as it takes. Behind them
    the farthest surface known of each ray is taken. Those between, and each other layer, are dealt to as many
    as it takes for no depth to jump from one of their pieces to the next.

    Raises: ValueError for surfaces of several sizes, or a first that leaves parts of the sphere out.
    """
    by_name = {layer.name: layer for layer in panorama.layers}
    first, *others = [by_name[name] for name in surfaces]
    if not first.mask.all():
        raise ValueError(f"{first} must cover the whole sphere to be split")
    if any((layer.mapping, layer.size) != (first.mapping, first.size) for layer in others):
        raise ValueError("surfaces that follow each other must have one size")
    grid = grid_of(first)
    behind, colours = _farthest(grid, others)
    radius = panorama.radius
    near = grid.flat(nearness(first.depth))
    layers = split_layers(grid, near, grid.flat(first.radiance), radius, count, behind, colours)
    rest = [*_between(others), *(layer for layer in panorama.layers if layer.name not in set(surfaces))]
    dealt = [piece for layer in rest for piece in continuous_pieces(layer, radius)]
    place = panorama.world_from_panorama, panorama.origin, radius
    return LayeredPanorama((*layers, *dealt), *place)


def _farthest(grid: PixelGrid, surfaces):
    """1/depth (size,), NaN where there is none, and colours (size, 3) of the farthest of some layers."""
    near = np.full(grid.size, np.nan, np.float32)
    colours = np.zeros((grid.size, 3), np.float32)
    for layer in surfaces:
        mask = grid.flat(layer.mask)
        near[mask] = grid.flat(nearness(layer.depth))[mask]
        colours[mask] = grid.flat(layer.radiance)[mask]
    return near, colours


def _between(surfaces):
    """Of some layers that follow each other what has one of the later ones behind it."""
    for number, layer in enumerate(surfaces[:-1], 1):
        inside = layer.mask & np.logical_or.reduce([later.mask for later in surfaces[number:]])
        if inside.any():
            yield layer.within(inside)
