"""A layer taken apart where its depth jumps: layers of the same map, each without jumps in its own domain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..making.discontinuities import TOLERANCE_PX, creases, cuts, nearness
from ..making.grid import grid_of
from ..making.regions import regions
from ..panorama import Layer


def continuous_pieces(
    layer: Layer, radius: float, *, tolerance_px: float = TOLERANCE_PX
) -> tuple[Layer, ...]:
    """Layers whose masks share out a layer's domain but for infinity; all else is the layer's.

    In none of them does the depth jump by a parallax of ``tolerance_px`` or more from within ``radius`` [m],
    see `cuts`. What a jump parts ends along hollow creases where it goes on without one, as where a box
    stands on the floor (see `regions`). Regions go, the largest first, to the first piece in which they make
    no jump, so there are few. Names are the layer's and a number. Nothing is left of a layer at infinity.

    >>> depth = np.full((32, 64), 3.0, np.float32)
    >>> depth[8:24, 8:20] = depth[8:24, 40:52] = 1.0
    >>> pieces = continuous_pieces(Layer("wall", "equirectangular", {"depth": depth}), 0.5)
    >>> [(piece.name, int(piece.mask.sum())) for piece in pieces]
    [('wall 1', 1664), ('wall 2', 384)]
    """
    grid = grid_of(layer)
    inside = layer.mask & np.isfinite(layer.depth)
    if not inside.any():
        return ()
    near = grid.flat(nearness(np.where(inside, layer.depth, np.nan)))
    jumps = cuts(grid, near, radius, tolerance_px)
    count, labels = regions(grid, near, jumps, creases(grid, near), radius)
    pixel, other = grid.pairs(jumps)
    sizes = np.bincount(labels[grid.flat(inside)], minlength=count)
    pieces = grid.image(_dealt(sizes, labels[pixel], labels[other])[labels])
    return tuple(
        replace(
            layer,
            name=f"{layer.name} {number + 1}",
            attributes={**layer.attributes, "mask": inside & (pieces == number)},
        )
        for number in range(pieces[inside].max() + 1)
    )


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
