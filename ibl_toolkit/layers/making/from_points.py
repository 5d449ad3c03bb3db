"""Layers of a cloud of points, as of a laser scan or of RGB-D shots put together.

Source: thesis, section 6.3.3.
"""

from __future__ import annotations

import numpy as np

from ..panorama import EQUIRECTANGULAR, LayeredPanorama, refuse_other_place
from .discontinuities import cuts, smoothed
from .flood import flood
from .grid import PixelGrid
from .inpainting import filled_radiance
from .planes import local_planes
from .point_surfaces import splat_width, surfaces_of_points
from .splitting import split_layers

HOLE_PX = 16.0
"""Widest hole [px] that is closed."""


def layers_from_points(
    points: np.ndarray,
    colours: np.ndarray,
    origin,
    width: int,
    radius: float | None = None,
    *,
    world_from_panorama=None,
    mapping: str = EQUIRECTANGULAR,
    splat_px: float | None = None,
    hole_px: float = HOLE_PX,
    count: int | None = None,
) -> LayeredPanorama:
    """Layers of points (n, 3) [m] with colours (n, 3), linear, seen from `origin` (3,), all in the world.

    width: of the map [px]. radius: [m] round the origin within which views will be; None: half of what
    is nearest, but for a hundredth of the points. splat_px: width of a point [px], None to find it from their
    density. hole_px: holes no wider are closed, continuing what is round them; pixels farther than half of it
    from any known one stay outside of all domains: `check_layers` says how much of the sphere. count: as for
    `layers_from_rgbd`.

    Each pixel's first surface is split as an RGB-D panorama is; the last one behind it goes to the
    background. Surfaces between them are left out. Points that aren't finite are passed over, as scanners
    write them where they saw nothing; so are points nearer to the origin than a millimetre.

    Raises: ValueError for arrays of other shapes, without a usable point, for colours that are not finite, a
    width that the mapping can't have, a splat or hole of no width, a count below 1, and what
    LayeredPanorama refuses.
    """
    world_from_panorama = np.eye(3) if world_from_panorama is None else np.asarray(world_from_panorama)
    refuse_other_place(world_from_panorama, origin, 0.0 if radius is None else radius)
    grid = PixelGrid(mapping, width, width // 2 if mapping == EQUIRECTANGULAR else width * 2 // 3)
    offsets, colours = _usable(points, colours, origin, world_from_panorama)
    if radius is None:  # as `usual_radius`, of points in place of directions
        radius = float(np.percentile(np.linalg.norm(offsets, axis=1), 1) / 2)
    if splat_px is None:
        splat_px = splat_width(grid, offsets / np.linalg.norm(offsets, axis=1, keepdims=True))
    for name, value in (("splat_px", splat_px), ("hole_px", hole_px)):
        if not 0 < value < np.inf:
            raise ValueError(f"{name} {value} must be above 0 and finite")
    if count is not None and count < 1:
        raise ValueError(f"count {count} of layers must be 1 or more")
    found = surfaces_of_points(grid, offsets, colours, splat_px, radius)
    near, filled, unknown = _closed(grid, found, hole_px, radius)
    near = smoothed(grid, near, cuts(grid, near, radius))
    layers = split_layers(grid, near, filled, radius, count, found.behind, found.behind_colours)
    known = grid.image(~unknown)
    layers = tuple(layer.within(known) for layer in layers if (layer.mask & known).any())
    return LayeredPanorama(layers, world_from_panorama, np.asarray(origin, np.float64), radius)


def _usable(points, colours, origin, world_from_panorama):
    """Offsets (n, 3) of the usable points in the panorama frame, and their colours (n, 3)."""
    points, colours = np.asarray(points, np.float64), np.asarray(colours, np.float32)
    if points.ndim != 2 or points.shape[1] != 3 or colours.shape != points.shape:
        raise ValueError(
            f"points of shape {points.shape} and colours of {colours.shape}: both must be (n, 3)"
        )
    usable = np.isfinite(points).all(axis=1)
    offsets = (np.where(usable[:, None], points, 0) - np.asarray(origin, np.float64)) @ world_from_panorama
    usable[usable] = np.linalg.norm(offsets[usable], axis=1) > 1e-3
    if not usable.any():
        raise ValueError(f"of {len(points)} points none is finite and over a millimetre from the origin")
    bad = usable & ~np.isfinite(colours).all(axis=1)
    if bad.any():
        first = int(np.argmax(bad))
        raise ValueError(f"colour of point {first} is {colours[first].tolist()}: must be finite")
    return offsets[usable], colours[usable]


def _closed(grid, found, hole_px, radius):
    """1/depth (size,) and colours (size, 3) everywhere, and where (size,) they are unknown all the same."""
    known = ~np.isnan(found.near)
    missing = np.flatnonzero(~known)
    near, colours = found.near.copy(), found.colours.copy()
    if not len(missing):
        return near, colours, ~known
    jumps = cuts(grid, near, radius)
    _, labels = grid.components(known, ~jumps)
    pixel, other = grid.pairs(known & ~known[grid.neighbours])
    left, number = flood(grid, other, pixel, np.full(len(pixel), np.pi + 1), ~known)
    start = pixel[number[missing]]
    far = np.pi + 1 - left[missing]
    used, which = np.unique(start, return_inverse=True)
    planes = local_planes(grid, near, labels, used, np.full(len(used), hole_px / 2 * grid.pixel))
    continued = np.einsum("nk,nk->n", planes[which.reshape(-1)], grid.directions[missing])
    near[missing] = np.clip(continued, 0.5 * near[start], 2 * near[start])
    colours[missing] = filled_radiance(grid, colours, known, missing, np.zeros(grid.size, np.int8))
    unknown = np.zeros(grid.size, dtype=bool)
    unknown[missing] = far > hole_px / 2 * grid.pixel
    return near, colours, unknown
