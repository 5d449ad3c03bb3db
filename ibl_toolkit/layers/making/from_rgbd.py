"""Layers of one RGB-D panorama: split where depth jumps, and continued behind what hides them.

Source: thesis, section 6.3.1.
"""

from __future__ import annotations

import numpy as np

from ..panorama import Layer, LayeredPanorama, refuse_other_place
from .discontinuities import creases, cuts, nearness
from .grid import PixelGrid, mapping_of_size
from .inpainting import filled_radiance
from .levels import levels
from .planes import region_planes
from .regions import regions
from .strips import hidden_strip

_EDGE_PX = 1  # beside an edge colours are mixed: those are kept, but not continued


def layers_from_rgbd(
    radiance: np.ndarray,
    depth: np.ndarray,
    radius: float,
    *,
    world_from_panorama=None,
    origin=(0.0, 0.0, 0.0),
    count: int | None = None,
) -> LayeredPanorama:
    """Layers of an RGB-D panorama, `background` first, then `front 1`, `front 2`, …

    radiance: (H, W, 3), linear. depth: (H, W) [m] along the ray, +inf at infinity. An equirectangular map or
    a cube map, by its size. radius: [m] round the origin within which views will be. count: layers at most;
    None for as many as it takes to have no jump of depth in any. With fewer, objects that hide parts of
    each other share the last layer.

    Each layer has `radiance` and `depth`, and goes on behind those before it as far as views within the
    radius can look there.

    Raises: ValueError for arrays of other shapes, a depth that is NaN or not above 0, radiance that is not
    finite, a count below 1, and what LayeredPanorama refuses.
    """
    world_from_panorama = np.eye(3) if world_from_panorama is None else np.asarray(world_from_panorama)
    refuse_other_place(world_from_panorama, origin, radius)
    _refuse_other_pictures(radiance, depth, count)
    height, width = depth.shape
    grid = PixelGrid(mapping_of_size(width, height), width, height)
    near = grid.flat(nearness(depth))
    jumps = cuts(grid, near, radius)
    number, labels = regions(grid, near, jumps, creases(grid, near), radius)
    level = levels(number, labels, grid, near, jumps, count)[labels]
    planes, flat = region_planes(grid, near, number, labels, radius)
    mixed = _beside(grid, jumps)
    colours = grid.flat(np.asarray(radiance, dtype=np.float32))
    layers = []
    for this in range(int(level.max()) + 1):
        strip = hidden_strip(grid, near, labels, level, this, planes, flat, radius)
        values = _layer_values(grid, colours, near, labels, level == this, mixed, strip)
        name = f"front {this}" if this else "background"
        layers.append(Layer(name, grid.mapping, {k: grid.image(v) for k, v in values.items()}))
    return LayeredPanorama(tuple(layers), world_from_panorama, np.asarray(origin, np.float64), radius)


def _layer_values(grid, colours, near, labels, visible, mixed, strip):
    """Radiance (size, 3) and depth (size,) of a layer: what is visible of it and its strip."""
    with np.errstate(divide="ignore"):
        depth = np.where(visible, 1 / near, np.float32(np.nan))
        depth[strip.pixels] = 1 / strip.near
    radiance = np.where(visible[:, None], colours, np.float32(0))
    if len(strip.pixels):
        region = np.where(visible, labels, -1)
        region[strip.pixels] = strip.labels
        source = visible & ~mixed
        unsure = np.flatnonzero(visible & mixed)
        pixels = np.concatenate([strip.pixels, unsure])
        filled = filled_radiance(grid, colours, source if source.any() else visible, pixels, region)
        radiance[strip.pixels] = filled[: len(strip.pixels)]
    return {"radiance": radiance, "depth": depth}


def _beside(grid, jumps):
    """Pixels (size,) so near to an edge that their colours may be mixed with what is beyond it."""
    mixed = jumps.any(axis=0)
    for _ in range(_EDGE_PX):
        mixed = mixed | (mixed[grid.neighbours] & ~jumps).any(axis=0)
    return mixed


def _refuse_other_pictures(radiance, depth, count):
    radiance, depth = np.asarray(radiance), np.asarray(depth)
    if depth.ndim != 2 or radiance.shape != (*depth.shape, 3):
        raise ValueError(
            f"radiance of shape {radiance.shape} and depth of {depth.shape}: must be (H, W, 3) and (H, W)"
        )
    mapping_of_size(depth.shape[1], depth.shape[0])
    for name, bad, right in (
        ("depth", ~(depth > 0), "above 0 or +inf; NaN is unknown, and must be filled first"),
        ("radiance", ~np.isfinite(radiance).all(axis=2), "finite"),
    ):
        if bad.any():
            row, column = (int(k) for k in np.unravel_index(np.argmax(bad), bad.shape))
            value = {"depth": depth, "radiance": radiance}[name][row, column]
            raise ValueError(
                f"{name} of {np.count_nonzero(bad)} pixels, the first at ({column}, {row}), is {value}: "
                f"must be {right}"
            )
    if count is not None and count < 1:
        raise ValueError(f"count {count} of layers must be 1 or more")
