"""Layers of one RGB-D panorama: split where depth jumps, and continued behind what hides them.

Source: thesis, section 6.3.1.
"""

from __future__ import annotations

import numpy as np

from ...images import RGBD
from ..panorama import LayeredPanorama, refuse_other_place
from .discontinuities import nearness
from .grid import PixelGrid, mapping_of_size
from .splitting import split_layers
from .uncovered import usual_radius


def layers_of(rgbd: RGBD, radius: float | None = None, count: int | None = None) -> LayeredPanorama:
    """`layers_from_rgbd` of an RGB-D panorama where it stands; radius None: `usual_radius`."""
    return layers_from_rgbd(
        rgbd.image,
        rgbd.depth,
        usual_radius(rgbd.depth) if radius is None else radius,
        world_from_panorama=rgbd.world_from_panorama,
        origin=(0.0, 0.0, rgbd.camera_height),
        count=count,
    )


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
    colours = grid.flat(np.asarray(radiance, dtype=np.float32))
    layers = split_layers(grid, grid.flat(nearness(depth)), colours, radius, count)
    return LayeredPanorama(layers, world_from_panorama, np.asarray(origin, np.float64), radius)


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
