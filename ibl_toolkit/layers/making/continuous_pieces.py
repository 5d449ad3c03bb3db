"""A layer taken apart where its depth jumps: layers of the same map, each without jumps in its own domain."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count

import numpy as np

from ..panorama import Layer, LayeredPanorama
from .discontinuities import TOLERANCE_PX, creases, cuts, nearness
from .grid import grid_of
from .regions import regions

SHEET_DEG = 1.0
"""A mesh may join two sides of a jump where no view from within the radius sees them farther apart: through a
slit so narrow what is behind shows wrongly more often than such a sheet does."""

RIM_PX = 2
"""As much as layers of surfaces reach beyond what can be seen of them, see `uncovered.MARGIN_PX`."""


def cut_at_jumps(panorama: LayeredPanorama) -> LayeredPanorama:
    """The panorama with each layer in its `mesh_pieces`, named as they are or by the next number that is
    free."""
    names = {layer.name for layer in panorama.layers}
    layers = []
    for layer in panorama.layers:
        first, *others = mesh_pieces(layer, panorama.radius)
        layers.append(first)
        for piece in others:
            name = next(name for k in count(2) if (name := part_name(layer.name, k)) not in names)
            names.add(name)
            layers.append(replace(piece, name=name))
    return replace(panorama, layers=tuple(layers))


def mesh_pieces(layer: Layer, radius: float) -> tuple[Layer, ...]:
    """`continuous_pieces` of a layer for meshes, which may bridge jumps of less than `SHEET_DEG`."""
    return continuous_pieces(layer, radius, _tolerance(grid_of(layer)))


def with_hidden_rim(piece: Layer, layer: Layer, radius: float) -> Layer:
    """A piece of a layer that goes on behind the layer's other pieces, where those are nearer, by `RIM_PX`.

    So it overlaps what another layer has behind them, and no slit is left between the two. It doesn't where
    its depth would come to jump as seen from within ``radius`` [m], as where parts of it meet behind a twig.
    """
    grid = grid_of(layer)
    seen = grid.flat(np.where(layer.mask, nearness(layer.depth), np.float32(np.nan)))
    near = grid.flat(np.where(piece.mask, nearness(piece.depth), np.float32(np.nan))).copy()
    for _ in range(RIM_PX):
        inside = ~np.isnan(near)
        touched = np.zeros(grid.size, dtype=bool)
        touched[grid.beside(np.flatnonzero(inside))] = True
        beyond = np.flatnonzero(~inside & touched & ~np.isnan(seen))
        beside = near[grid.beside(beyond)]
        farther = beside < seen[beyond]
        number = farther.sum(axis=0)
        means = np.where(farther, beside, 0).sum(axis=0) / np.maximum(number, 1)
        near[beyond[number > 0]] = means[number > 0]
    jumps = cuts(grid, near, radius, _tolerance(grid)).any(axis=0)
    hidden = ~np.isnan(grid.image(near)) & ~piece.mask & ~grid.image(jumps)
    with np.errstate(divide="ignore"):
        depth = np.where(hidden, 1 / grid.image(near), piece.depth)
    attributes = {**piece.attributes, "depth": depth}
    if "mask" in attributes:
        attributes["mask"] = piece.mask | hidden
    return replace(piece, attributes=attributes)


def continuous_pieces(layer: Layer, radius: float, tolerance_px: float = TOLERANCE_PX) -> tuple[Layer, ...]:
    """Layers that share out a layer's domain, with all its attributes; itself, where its depth doesn't jump.

    In none of them does the depth jump by a parallax of ``tolerance_px`` from within ``radius`` [m], see
    `cuts`. What a jump parts ends along hollow creases where it goes on without one, as where a box stands on
    the floor (see `regions`). Regions go, the largest first, to the first piece in which they make no jump,
    so there are few. The first one has the layer's name, the others "…, part 2" and so on.

    >>> depth = np.full((32, 64), 3.0, np.float32)
    >>> depth[8:24, 8:20] = depth[8:24, 40:52] = 1.0
    >>> pieces = continuous_pieces(Layer("wall", "equirectangular", {"depth": depth}), 0.5)
    >>> [(piece.name, int(piece.mask.sum())) for piece in pieces]
    [('wall', 1664), ('wall, part 2', 384)]
    """
    grid = grid_of(layer)
    inside = grid.flat(layer.mask)
    near = grid.flat(np.where(layer.mask, nearness(layer.depth), np.float32(np.nan)))
    jumps = cuts(grid, near, radius, tolerance_px)
    if not jumps.any():
        return (layer,)
    number, labels = regions(grid, near, jumps, creases(grid, near), radius)
    pixel, other = grid.pairs(jumps)
    sizes = np.bincount(labels[inside], minlength=number)
    pieces = grid.image(_dealt(sizes, labels[pixel], labels[other])[labels])
    return tuple(_pieces(layer, pieces))


def part_name(name: str, number: int) -> str:
    """The name of a layer's piece: its own for the first."""
    return name if number == 1 else f"{name}, part {number}"


def _tolerance(grid):
    """`SHEET_DEG` in pixels, at least one."""
    return max(TOLERANCE_PX, np.radians(SHEET_DEG) / grid.pixel)


def _pieces(layer, pieces) -> Iterator[Layer]:
    for number in range(pieces[layer.mask].max() + 1):
        yield layer.within(pieces == number, part_name(layer.name, number + 1))


def _dealt(sizes, ones, others):
    """Numbers for regions of these sizes, as small as can be where ones[k] and others[k] must differ."""
    apart = [set() for _ in sizes]
    for one, other in np.unique(np.stack([ones, others], axis=1), axis=0).tolist():
        if one != other:
            apart[one].add(other)
    chosen = np.full(len(sizes), -1)
    for region in np.argsort(-sizes, kind="stable"):
        taken = {chosen[other] for other in apart[region]}
        chosen[region] = next(number for number in range(len(sizes)) if number not in taken)
    return chosen
