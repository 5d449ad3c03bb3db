"""What receives shadows and throws none: floor and walls that the photograph shows already.

`vsm` and `evsm` blur depths. Where nothing throws a shadow they need the depth of what is lit there, or the
edges of shadows on it are too hard and lie up to half a window too far inside.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .depth_buffer import depth_buffer
from .light_camera import LightCamera
from .settings import ShadowSettings

MOST = 2.0
"""Times the range of depths, to which it grows for the ground: beyond, `evsm` in 8 bits shows gaps."""
_TEXELS = 128  # a side, for a look at how far the ground is
_MARGIN = 1.02


def filled(
    depth: np.ndarray,
    points: np.ndarray,
    triangles: np.ndarray,
    camera: LightCamera,
    settings: ShadowSettings,
    step: float | None,
) -> np.ndarray:
    """Depths (N, N) of what throws shadows, with those of the ground where nothing does.

    Of the ground, triangles (T, 3) of points (V, 3) [m], it is the farthest, which is in front of no other:
    so none throws a shadow. A slope that goes on at one depth would be darkened by the filter: so the
    outermost texels, which filters repeat, have no ground, and what comes to far within a window counts as
    there. step: of the storage, see `depth_buffer`.
    """
    offset = settings.offset_factor, settings.offset_units
    ground = depth_buffer(points, triangles, camera, len(depth), *offset, step, settings.window)
    inner = np.s_[1:-1, 1:-1]
    depth = depth.copy()
    depth[inner] = np.where(depth[inner] < 1, depth[inner], ground[inner])
    return depth


def reaching(camera: LightCamera, points: np.ndarray, triangles: np.ndarray) -> LightCamera:
    """A camera whose range of depths holds the ground within its map, as far as MOST allows.

    >>> noon = LightCamera(np.array([0, 0, 4.0]), np.diag([-1.0, 1, -1]), False, 1, 1, 0, 2)
    >>> floor = np.array([[-9.0, -9, 1], [9, -9, 1], [0, 9, 1]])
    >>> reaching(noon, floor, np.array([[0, 1, 2]])).far
    3.06
    """
    longest = replace(camera, far=camera.near + MOST * (camera.far - camera.near))
    depth = depth_buffer(points, triangles, longest, _TEXELS, 0, 0, None, ground_reach=0)
    farthest = float(longest.linear_depth(depth[depth < 1]).max(initial=0.0))
    reached = (longest.far - longest.near) * min(farthest * _MARGIN, 1.0)
    return replace(camera, far=max(camera.far, camera.near + reached))
