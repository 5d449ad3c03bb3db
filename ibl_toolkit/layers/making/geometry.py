"""What of a layer is floor, ceiling, wall or light.

Source: thesis, section 6.2.4.2, which shows the classes (Fig. 6-8); how they are told apart is ours.
"""

from __future__ import annotations

import numpy as np

from ... import cube_map, equirectangular
from ...light.light_map import LUMINANCE
from ..meshes.corners import Corners
from ..meshes.normals import normals_from_depth
from ..panorama import Layer
from .classification import parted
from .grid import grid_of

_LEVEL_DEG = 20.0  # normals off the vertical, or off the horizontal, by no more
_BIN = 0.05  # [m] in which heights are counted
_SAME_HEIGHT = 0.1  # [m] from the floor's or the ceiling's
_BRIGHTER = 10.0  # a light's luminance, in that of the layer's median


def by_geometry(layer: Layer, world_from_panorama, light_luminance: float | None = None) -> list[Layer]:
    """The parts of a layer: `lights`, `floor`, `ceiling`, `walls` and, what is none of these, `rest`.

    world_from_panorama: (3, 3), z up in the world. light_luminance: from which on a pixel is a light; None
    for ten times the median over the layer's solid angle, and none where that is 0. Floor is what faces up,
    within 20°, at the height at which there is the most of it in square metres, give or take 0.1 m; the
    ceiling likewise, facing down; walls face sideways. Normals are those the layer has, or those of its
    depth. What is at infinity is `rest`, unless it shines.

    Raises: ValueError for a light_luminance that is not above 0.
    """
    if light_luminance is not None and not light_luminance > 0:
        raise ValueError(f"light_luminance {light_luminance} must be above 0")
    grid = grid_of(layer)
    inside = layer.mask
    upward = _normals(layer) @ np.asarray(world_from_panorama, np.float64)[2]
    directions = grid.image(grid.directions)
    finite = inside & np.isfinite(layer.depth)
    depth = np.where(finite, layer.depth, 0).astype(np.float64)
    height = (directions @ np.asarray(world_from_panorama, np.float64)[2]) * depth
    angles = _solid_angles(grid)
    lights = inside & _shines(layer, angles, light_luminance)
    left = finite & ~lights
    classes = {"lights": lights}
    steep = np.cos(np.radians(_LEVEL_DEG))
    for name, facing in (("floor", upward >= steep), ("ceiling", upward <= -steep)):
        level = left & facing & ((height < 0) == (name == "floor"))
        classes[name] = level & _at_main_height(height, level, angles * depth**2)
    classes["walls"] = left & (np.abs(upward) <= np.sin(np.radians(_LEVEL_DEG)))
    classes["rest"] = inside & ~np.any(list(classes.values()), axis=0)
    return parted(layer, classes)


def _at_main_height(height, level, area):
    """Pixels (H, W) at the height [m] of the bin with the most area among those that are level."""
    if not level.any():
        return level
    bins = np.floor(height[level] / _BIN).astype(np.int64)
    lowest = bins.min()
    most = lowest + np.argmax(np.bincount(bins - lowest, area[level]))
    near = np.abs(height[level] - (most + 0.5) * _BIN) < _BIN
    return np.abs(height - np.median(height[level][near])) <= _SAME_HEIGHT


def _shines(layer, angles, light_luminance):
    if layer.radiance is None:
        return np.zeros(layer.depth.shape, dtype=bool)
    luminance = layer.radiance @ LUMINANCE
    if light_luminance is None:
        inside = layer.mask
        order = np.argsort(luminance[inside])
        share = np.cumsum(angles[inside][order])
        middle = luminance[inside][order][np.searchsorted(share, share[-1] / 2)]
        light_luminance = _BRIGHTER * middle if middle > 0 else np.inf
    return luminance >= light_luminance


def _normals(layer):
    """Normals (H, W, 3), panorama frame: the layer's own, or those of its depth."""
    if "normals" in layer.attributes:
        return layer.attributes["normals"]
    grid, corners = grid_of(layer), Corners(layer.mapping, *layer.size)
    finite = layer.mask & np.isfinite(layer.depth)
    sheets = corners.as_sheets(np.where(finite, layer.depth, 0)), corners.as_sheets(finite)
    return grid.image(normals_from_depth(corners, *sheets).reshape(grid.size, 3))


def _solid_angles(grid):
    """Solid angles (H, W) [sr] of pixels."""
    if grid.is_cube:
        return cube_map.solid_angles(grid.sheet_shape[1])
    rows = equirectangular.row_solid_angles(grid.width, grid.height)
    return np.repeat(rows[:, None], grid.width, axis=1)
