"""What the light sees: the depth of the nearest triangle in each texel, as a graphics card finds it."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from ...layers.raster.camera_space import NEAR, cut_at_near, to_camera
from ...layers.raster.scan_lines import fragments
from .light_camera import LightCamera


@dataclass(frozen=True, eq=False)
class _Grid:
    """The map as what draws triangles wants its camera: square texels, from −1 to 1."""

    width: int
    height: int

    @property
    def focal(self):
        return self.width / 2


def depth_buffer(
    points: np.ndarray,
    triangles: np.ndarray,
    camera: LightCamera,
    resolution: int,
    offset_factor: float,
    offset_units: float,
    step: float | None,
    ground_reach: int | None = None,
) -> np.ndarray:
    """Depths (resolution, resolution) in 0 to 1, 1 where there is nothing; row 0 is at t = 0.

    In each texel it is that of the nearest triangle. With ``ground_reach`` it is that of the farthest, and
    what comes to far within so many texels counts as being there.

    points: (V, 3) [m]; triangles: (T, 3) indices. As glPolygonOffset does it, each triangle is moved away
    from the light by m · factor + r · units, m being the larger of |∂z/∂x|, |∂z/∂y| [depth per texel] and r
    the buffer's ``step``; without one it is that of a 32-bit float at the triangle's farthest vertex. What is
    nearer than near or farther than far is cut away. Both sides of a triangle are drawn.

    >>> wall = np.array([[-9.0, -9, 1], [9, -9, 1], [0, 9, 1]])
    >>> sun = LightCamera(np.array([0, 0, 4.0]), np.diag([-1.0, 1, -1]), False, 1, 1, 0, 4)
    >>> depth_buffer(wall, np.array([[0, 1, 2]]), sun, 2, 0, 0, None)
    array([[0.75, 0.75],
           [0.75, 0.75]])
    """
    grid = _Grid(resolution, resolution)
    is_ground = ground_reach is not None
    depth = np.full(resolution * resolution, -1.0 if is_ground else 1.0)
    kept = np.maximum if is_ground else np.minimum
    corners = _clip_corners(np.asarray(points, dtype=np.float64), np.asarray(triangles), camera)
    x, y, z = (corners[..., k] / corners[..., 3] for k in (0, 1, 2))
    planes = _Planes.through((x + 1) * grid.focal, (y + 1) * grid.focal, (z + 1) / 2)
    offset = planes.steepest * offset_factor + _resolvable(planes.farthest, step) * offset_units
    for row, column, _, which in fragments(corners[..., [0, 1, 3]], grid):
        z = planes.at(column + 0.5, row + 0.5, which)
        inside = (z >= 0) & (z <= 1)
        moved = np.clip(z + offset[which], 0, 1)
        if is_ground:
            moved[moved + planes.steepest[which] * ground_reach >= 1] = 1
        kept.at(depth, (row.astype(np.int64) * resolution + column)[inside], moved[inside])
    return np.where(depth < 0, 1.0, depth).reshape(resolution, resolution)


def _clip_corners(points, triangles, camera):
    """(n, 3, 4) clip coordinates of the triangles' corners; a lamp's are cut where they pass beside it."""
    pose = SimpleNamespace(eye=camera.eye, axes=camera.axes)
    if not camera.perspective:
        seen = to_camera(points[triangles], pose)
    else:
        beyond = (to_camera(points, pose)[:, 2] > NEAR)[triangles].sum(axis=1)
        seen = to_camera(points[triangles[beyond == 3]], pose)
        crossing = triangles[(beyond > 0) & (beyond < 3)]
        if len(crossing):
            seen = np.concatenate([seen, cut_at_near(points, crossing, pose)[0]])
    light = np.concatenate([seen[..., :2], -seen[..., 2:], np.ones((*seen.shape[:-1], 1))], axis=-1)
    return light @ camera.clip_from_light.T


@dataclass(frozen=True, eq=False)
class _Planes:
    """Depth over the map, a plane for each triangle: in texels depth is linear, in perspective too."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    along_x: np.ndarray
    along_y: np.ndarray
    nearest: np.ndarray
    farthest: np.ndarray

    @classmethod
    def through(cls, x, y, z):
        """Corners (n, 3) each. A triangle seen edge-on has no slopes; it covers no texel's middle."""
        (x1, x2), (y1, y2), (z1, z2) = ((v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]) for v in (x, y, z))
        area = x1 * y2 - x2 * y1
        flat = np.where(np.abs(area) > 1e-12, area, np.inf)
        along_x, along_y = (z1 * y2 - z2 * y1) / flat, (x1 * z2 - x2 * z1) / flat
        return cls(x[:, 0], y[:, 0], z[:, 0], along_x, along_y, z.min(axis=1), z.max(axis=1))

    @property
    def steepest(self):
        return np.maximum(np.abs(self.along_x), np.abs(self.along_y))

    def at(self, x, y, which):
        z = (
            self.z[which]
            + (x - self.x[which]) * self.along_x[which]
            + (y - self.y[which]) * self.along_y[which]
        )
        return np.clip(z, self.nearest[which], self.farthest[which])


def _resolvable(farthest, step):
    """r of glPolygonOffset: fixed for whole numbers; for floats, by the farthest vertex's exponent."""
    if step is not None:
        return step
    return np.exp2(np.floor(np.log2(np.clip(farthest, 2.0**-126, None))) - 23)
