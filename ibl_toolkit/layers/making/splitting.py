"""Splitting what is seen from one place into layers, and continuing each behind those before it.

Source: thesis, section 6.3.1.
"""

from __future__ import annotations

import numpy as np

from ..panorama import Layer
from .discontinuities import creases, cuts, smoothed
from .grid import LEFT, RIGHT, PixelGrid
from .inpainting import filled_radiance
from .levels import levels
from .planes import region_planes
from .regions import regions
from .strips import hidden_strip

_NOISY = 0.05  # [rad], 3°: median turn of surfaces from pixel to pixel; creases are 15°
_EDGE_PX = 1  # beside an edge colours are mixed: those are kept, but not continued


def split_layers(
    grid: PixelGrid, near, colours, radius: float, count=None, behind=None, behind_colours=None
) -> tuple[Layer, ...]:
    """Layers `background`, `front 1`, … of what is seen: 1/depth (size,) [1/m], colours (size, 3).

    radius: [m] round the origin within which views will be. count: layers at most; None for as many as it
    takes. behind, behind_colours: 1/depth (size,) and colours (size, 3) of what is known to be behind, NaN
    where nothing is: they go to the background, in place of what would be found for it.
    """
    jumps = cuts(grid, near, radius)
    number, labels = regions(grid, near, jumps, _creases(grid, near, jumps), radius)
    level = levels(number, labels, grid, near, jumps, count)[labels]
    planes, flat = region_planes(grid, near, number, labels, radius)
    mixed = _beside(grid, jumps)
    layers = []
    for this in range(int(level.max()) + 1):
        seen = behind if this == 0 else None
        strip = hidden_strip(grid, near, labels, level, this, planes, flat, radius, seen)
        known = None if seen is None else behind_colours
        values = _layer_values(grid, colours, near, labels, level == this, mixed, strip, known)
        name = f"front {this}" if this else "background"
        layers.append(Layer(name, grid.mapping, {k: grid.image(v) for k, v in values.items()}))
    return tuple(layers)


def _creases(grid, near, jumps):
    """Hollow creases, of 1/depth without its noise if that alone makes surfaces turn from pixel to pixel."""
    right, left = near[grid.neighbours[RIGHT]], near[grid.neighbours[LEFT]]
    finite = near > 0
    turn = np.abs(right + left - 2 * near)[finite] / (grid.pixel * near[finite])
    noisy = finite.any() and np.median(turn) > _NOISY
    return creases(grid, smoothed(grid, near, jumps) if noisy else near)


def _layer_values(grid, colours, near, labels, visible, mixed, strip, known):
    """Radiance (size, 3) and depth (size,) of a layer: what is visible of it and its strip."""
    with np.errstate(divide="ignore"):
        depth = np.where(visible, 1 / near, np.float32(np.nan))
        depth[strip.pixels] = 1 / strip.near
    radiance = np.where(visible[:, None], colours, np.float32(0))
    if known is not None:
        radiance[strip.pixels[strip.seen]] = known[strip.pixels[strip.seen]]
    hidden = strip.pixels[~strip.seen]
    if len(hidden):
        region = np.where(visible, labels, -1)
        region[hidden] = strip.labels[~strip.seen]
        source = visible & ~mixed
        unsure = np.flatnonzero(visible & mixed)
        pixels = np.concatenate([hidden, unsure])
        filled = filled_radiance(grid, colours, source if source.any() else visible, pixels, region)
        radiance[hidden] = filled[: len(hidden)]
    return {"radiance": radiance, "depth": depth}


def _beside(grid, jumps):
    """Pixels (size,) so near to an edge that their colours may be mixed with what is beyond it."""
    mixed = jumps.any(axis=0)
    for _ in range(_EDGE_PX):
        mixed = mixed | (mixed[grid.neighbours] & ~jumps).any(axis=0)
    return mixed
