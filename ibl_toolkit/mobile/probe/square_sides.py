"""The corners of a marker's black square, measured: its sides are where brightness changes most.

A side is a plane of rays of sight, whatever the lens does to it; two planes meet in the ray of a corner.
Linear radiance is looked at: in encoded values a blurred edge lies up to half a pixel on its dark side.
"""

from __future__ import annotations

import numpy as np

from .edges import EdgePicture, steepest

_PER_SIDE = 48
_MARGIN = 0.1  # of a side, at each end, where the next one is near
_TUKEY = 4.685
_MAD = 1.4826
_LEAST = 8  # points of a side


def measured_corners(luminance, camera, corners) -> np.ndarray:
    """The corners (4, 2) [px] of a dark square on white, near given ones, in linear luminance (H, W).

    Where a side cannot be measured, the given corners come back.
    """
    picture = EdgePicture(luminance)
    planes = [_side(picture, camera, corners[k], corners[(k + 1) % 4], corners) for k in range(4)]
    if any(plane is None for plane in planes):
        return corners
    rays = np.array([np.cross(planes[k - 1], planes[k]) for k in range(4)])
    rays *= np.sign(rays[:, 2:])
    measured = camera.pixels(rays)
    limit = max(3.0, 0.05 * np.linalg.norm(corners[0] - corners[2]))
    is_near = np.isfinite(measured).all() and np.linalg.norm(measured - corners, axis=1).max() < limit
    return measured if is_near else corners


def _side(picture, camera, start, end, corners):
    """The unit normal (3,) of the plane of rays through one side; None where it is not seen."""
    length = np.linalg.norm(end - start)
    share = np.linspace(_MARGIN, 1 - _MARGIN, _PER_SIDE)[:, None]
    # Along the rays, not the pixels: a lens bends the side.
    rays = camera.rays(np.stack([start, end]))
    points = camera.pixels((1 - share) * rays[0] + share * rays[1])
    across = np.array([end[1] - start[1], start[0] - end[0]]) / length
    across *= np.sign(across @ ((start + end) / 2 - corners.mean(axis=0)))
    found, _, is_found = steepest(
        picture, points, np.tile(across, (_PER_SIDE, 1)), min(3.0, 0.08 * length), rising=True
    )
    if np.count_nonzero(is_found) < _LEAST:
        return None
    return _plane(camera.rays(found[is_found]))


def _plane(rays):
    weights = np.ones(len(rays))
    for _ in range(5):
        normal = np.linalg.svd(rays * weights[:, None], full_matrices=False)[2][-1]
        off = rays @ normal
        scale = max(_MAD * np.median(np.abs(off)), 1e-7)
        weights = np.maximum(1 - np.square(off / (_TUKEY * scale)), 0)
    return normal
