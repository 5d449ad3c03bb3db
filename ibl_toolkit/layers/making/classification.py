"""Layers parted by depth, the layer at infinity, and depth made flat where no one sees it.

Source: thesis, sections 6.2.4.1 (eq. 6.18) and 6.2.4.3.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..panorama import Layer, LayeredPanorama
from .discontinuities import TOLERANCE_PX, cuts, nearness
from .grid import grid_of
from .planes import region_planes
from .regions import parallax


def parted(layer: Layer, classes: dict[str, np.ndarray]) -> list[Layer]:
    """The parts of a layer by masks (H, W) bool; those without a pixel are left out.

    A part's name is the mask's, after the layer's; its domain is where layer and mask are, its resolution
    and attributes the layer's.

    >>> layer = Layer("all", "equirectangular", {"depth": np.array([[1.0, 2, 3, 4]] * 2)})
    >>> [part.name for part in parted(layer, {"near": layer.depth < 3, "none": layer.depth < 0})]
    ['all, near']
    """
    inside = layer.mask
    return [
        layer.within(mask, f"{layer.name}, {name}") for name, mask in classes.items() if (inside & mask).any()
    ]


def by_depth(layer: Layer, limits) -> list[Layer]:
    """The parts of a layer between distances [m], nearest first: eq. 6.18.

    limits: distances above 0, ascending. n of them make up to n + 1 parts, each from its lower limit,
    included, to its upper one.
    Raises: ValueError for limits that are not.

    >>> layer = Layer("all", "equirectangular", {"depth": np.array([[1.0, 2, 3, np.inf]] * 2)})
    >>> [(part.name, int(part.mask.sum())) for part in by_depth(layer, [2])]
    [('all, to 2 m', 2), ('all, from 2 m', 6)]
    """
    limits = [float(limit) for limit in limits]
    ends = [0.0, *limits, np.inf]
    if not all(a < b for a, b in pairwise(ends)):
        raise ValueError(f"limits {limits} m must be above 0, finite and ascending")
    classes = {}
    for low, high in pairwise(ends):
        words = [f"from {low:g} m"] * (low > 0) + [f"to {high:g} m"] * (high < np.inf)
        classes[" ".join(words) or "all"] = (layer.depth >= low) & ((layer.depth < high) | np.isinf(high))
    return parted(layer, classes)


def infinite_from(radius: float, pixel: float, tolerance_px: float = TOLERANCE_PX) -> float:
    """The distance [m] from which on a view within `radius` [m] shifts nothing by more than `tolerance_px`.

    d = r / sin(tolerance · pixel), pixel: [rad]; section 6.2.4.3 names it d_dirmin.

    >>> round(infinite_from(0.5, 2 * np.pi / 4096), 3)
    325.949
    """
    return radius / np.sin(min(tolerance_px * pixel, np.pi / 2))


def with_infinity(panorama: LayeredPanorama, tolerance_px: float = TOLERANCE_PX) -> LayeredPanorama:
    """The panorama with all that is beyond `infinite_from` in a layer `infinity`, at a depth of +inf.

    Layers of another resolution or mapping have one of their own, `infinity 2` and so on. Of several layers
    in one pixel the nearest counts. It has the attributes that all it comes from have.
    """
    kept, far = [], {}
    for layer in panorama.layers:
        grid = grid_of(layer)
        beyond = layer.mask & (layer.depth >= infinite_from(panorama.radius, grid.pixel, tolerance_px))
        if (layer.mask & ~beyond).any():
            kept.append(layer.within(~beyond))
        if beyond.any():
            far.setdefault((layer.mapping, layer.size), []).append((layer, beyond))
    taken = {layer.name for layer in kept}
    names = (
        name for k in range(1, 1 << 30) if (name := f"infinity {k}" if k > 1 else "infinity") not in taken
    )
    layers = [_at_infinity(next(names), parts) for parts in far.values()]
    place = panorama.world_from_panorama, panorama.origin, panorama.radius
    return LayeredPanorama((*kept, *layers), *place)


def flattened(layer: Layer, radius: float, tolerance_px: float = TOLERANCE_PX) -> Layer:
    """The layer with the depth of thin parts made one distance, or one plane.

    Part by part, as the domain hangs together without a jump: where distances differ by no more than
    2 · tolerance of parallax at `radius` [m] they become the one in their middle, so that nothing shifts by
    more than the tolerance; else, where 1/depth is as near to a plane as that, it becomes the plane. A part
    that comes nearer than the radius stays, for views may be as near to it as they like.
    """
    grid = grid_of(layer)
    inside = grid.flat(layer.mask)
    near = np.where(inside, grid.flat(nearness(layer.depth)), np.float32(np.nan))
    count, labels = grid.components(inside, ~cuts(grid, near, radius))
    allowed = tolerance_px * grid.pixel
    low, high = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(low, labels[inside], near[inside])
    np.maximum.at(high, labels[inside], near[inside])
    beyond = radius * high < 1
    thin = beyond & (parallax(radius, high, low) <= 2 * allowed)
    planes, _ = region_planes(
        grid, np.where(inside, near, 0), count + 1, np.where(inside, labels, count), radius
    )
    chosen = labels[inside]
    on_plane = np.einsum("nk,nk->n", planes[chosen], grid.directions[inside])
    off = np.zeros(count)
    np.maximum.at(off, chosen, np.where(on_plane > 0, np.abs(on_plane - near[inside]), np.inf))
    level = beyond & (off * radius <= allowed)
    result = np.where(level[chosen], on_plane, near[inside])
    result = np.where(thin[chosen], (low + high)[chosen] / 2, result)
    depth = np.full(grid.size, np.nan, np.float32)
    with np.errstate(divide="ignore"):
        depth[inside] = np.where(near[inside] == 0, np.inf, 1 / result)
    return Layer(layer.name, layer.mapping, {**layer.attributes, "depth": grid.image(depth)})


def _at_infinity(name, parts):
    """The layer of what is beyond, of (layer, mask) pairs of one map."""
    depths = np.stack([np.where(mask, layer.depth, np.nan) for layer, mask in parts])
    there = ~np.isnan(depths).all(axis=0)
    # infinity itself comes behind all that is finite
    order = np.where(np.isnan(depths), np.inf, np.where(np.isinf(depths), np.finfo(np.float64).max, depths))
    first = np.argmin(order, axis=0)
    attributes = {"depth": np.where(there, np.float32(np.inf), np.float32(np.nan))}
    for attribute in set.intersection(*(set(layer.attributes) for layer, _ in parts)) - {"depth", "mask"}:
        values = np.stack([layer.attributes[attribute] for layer, _ in parts])
        index = first[None, ..., None] if values.ndim == 4 else first[None]
        attributes[attribute] = np.take_along_axis(values, index, axis=0)[0]
    return Layer(name, parts[0][0].mapping, attributes)
