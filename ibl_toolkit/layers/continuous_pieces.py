"""A layer taken apart where its depth jumps: layers of the same map, each continuous in its own domain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .making.discontinuities import TOLERANCE_PX, cuts, nearness
from .making.grid import grid_of
from .panorama import Layer

_FEWEST = 256


def continuous_pieces(
    layer: Layer, radius: float, *, tolerance_px: float = TOLERANCE_PX, fewest: int = _FEWEST
) -> tuple[Layer, ...]:
    """Layers whose masks share out a layer's domain but for infinity, the largest first; all else is shared.

    They end where the depth jumps by a parallax of ``tolerance_px`` from within ``radius`` [m], see `cuts`.
    Parts of fewer than ``fewest`` pixels are put together in one, the last, in which it may jump. Names are
    the layer's and a number. Nothing is left of a layer at infinity.

    >>> depth = np.full((32, 64), 3.0, np.float32)
    >>> depth[8:24, 8:40] = 1.0
    >>> pieces = continuous_pieces(Layer("wall", "equirectangular", {"depth": depth}), 0.5)
    >>> [(piece.name, int(piece.mask.sum())) for piece in pieces]
    [('wall 1', 1536), ('wall 2', 512)]
    """
    grid = grid_of(layer)
    inside = layer.mask & np.isfinite(layer.depth)
    near = grid.flat(nearness(np.where(inside, layer.depth, np.nan)))
    _, parts = grid.components(grid.flat(inside), ~cuts(grid, near, radius, tolerance_px))
    parts = grid.image(parts)
    counts = np.bincount(parts[inside])
    order = np.argsort(-counts, kind="stable")
    large = order[counts[order] >= fewest]
    number = np.full(len(counts), len(large))
    number[large] = np.arange(len(large))
    pieces = np.append(number, -1)[parts]  # no part is -1
    return tuple(
        replace(
            layer,
            name=f"{layer.name} {piece + 1}",
            attributes={**layer.attributes, "mask": pieces == piece},
        )
        for piece in range(number.max(initial=-1) + 1)
    )
