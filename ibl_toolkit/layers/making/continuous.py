"""Continuous layers of the successive surfaces along rays.

A layer of successive surfaces is of many things, and its depth jumps from one to the next. The first surfaces
are split as those of an RGB-D panorama are; the farthest that was found behind them goes to the background,
where a picture alone would have to be continued. What is between stays in layers of its own.

Source: thesis, 6.2 (eq. 6.10, a layer is continuous) and 6.3.2.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..panorama import Layer, LayeredPanorama
from .discontinuities import cuts, nearness
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
    dealt = [part for layer in rest for part in _dealt(layer, radius)]
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
            depth = np.where(inside, layer.depth, np.float32(np.nan))
            attributes = {name: values for name, values in layer.attributes.items() if name != "mask"}
            yield Layer(layer.name, layer.mapping, {**attributes, "depth": depth})


def _dealt(layer: Layer, radius):
    """The layer's parts, between which depth jumps, in as few layers as a greedy choice finds."""
    grid = grid_of(layer)
    inside = grid.flat(layer.mask)
    near = np.where(inside, grid.flat(nearness(layer.depth)), np.float32(np.nan))
    jumps = cuts(grid, near, radius)
    count, labels = grid.components(inside, ~jumps & inside[grid.neighbours])
    pixel, other = grid.pairs(jumps & inside & inside[grid.neighbours])
    apart = np.unique(np.stack([labels[pixel], labels[other]], axis=1), axis=0)
    beside = [[] for _ in range(count)]
    for one, another in apart[apart[:, 0] != apart[:, 1]].tolist():
        beside[one].append(another)
    chosen = np.full(count + 1, -1)
    for part in np.argsort(-np.bincount(labels[inside], minlength=count)):
        taken = {chosen[another] for another in beside[part]}
        chosen[part] = next(k for k in range(count) if k not in taken)
    for number in range(chosen.max() + 1):
        mask = grid.image(inside & (chosen[labels] == number))
        depth = np.where(mask, layer.depth, np.float32(np.nan))
        name = layer.name if number == 0 else f"{layer.name}, part {number + 1}"
        yield Layer(name, layer.mapping, {**layer.attributes, "depth": depth})
