"""An RGB-D panorama as one closed mesh: its light then comes from where it is (section 5.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import equirectangular
from .meshes import Mesh

LARGEST_WIDTH = 512
"""Columns of vertices at most: a mesh of a quarter of a million triangles."""


@dataclass(frozen=True)
class DepthMesh:
    """A mesh of a depth map, and how far it is from it."""

    mesh: Mesh
    median_error: float
    """Median over the faces of |distance of the face's middle ÷ depth of the map there − 1|."""
    percentile_95_error: float
    """95 % of the faces are nearer to the map than this; the rest span jumps of the depth."""


def mesh_from_depth(
    depth: np.ndarray, world_from_panorama: np.ndarray, camera_height: float, width: int = LARGEST_WIDTH
) -> DepthMesh:
    """Mesh an equirectangular depth map (H, W) [m] with quads, at most about ``width`` round the horizon.

    The vertices are pixels of the map, at z·ω; the mesh is closed round the seam and at the poles. Where
    depth jumps, a quad stretches from the near surface to the far one, so that no light leaks through. What
    has no depth (+inf) stays open. Faces look at the panorama.

    Source: thesis section 5.1, and 7.4.1 for the uniform mesh. Raises ValueError for a map that is not 2:1,
    that has a depth that is not positive, or no finite depth.
    """
    height, full_width = depth.shape
    if full_width != 2 * height:
        raise ValueError(f"depth map is {full_width} × {height}; expected 2:1")
    if not (depth > 0).all():
        raise ValueError(f"depth map has {np.count_nonzero(~(depth > 0))} depths that are not positive [m]")
    step = -(-full_width // width)
    chosen = (slice(step // 2, None, step),) * 2
    points = (equirectangular.pixel_directions(full_width, height)[chosen] * depth[chosen][..., None]).astype(
        float
    )
    rows, columns, _ = points.shape
    poles = [(0, 0, np.median(depth[0])), (0, 0, -np.median(depth[-1]))]
    points = np.vstack([points.reshape(-1, 3), poles])
    points, faces = _only_known(points, _faces(rows, columns))
    if not faces:
        raise ValueError("depth map has no finite depth: there is nothing to mesh")
    world_from_local = np.eye(4)
    world_from_local[:3, :3], world_from_local[2, 3] = world_from_panorama, camera_height
    errors = _errors(depth, points, faces)
    mesh = Mesh(points, faces, world_from_local)
    return DepthMesh(mesh, float(np.median(errors)), float(np.percentile(errors, 95)))


def _faces(height, width):
    """Quads between rows, wrapped round the seam, and a fan of triangles at either pole; all face inwards."""
    columns = np.arange(width)
    after = (columns + 1) % width
    rows = np.arange(height - 1)[:, None] * width
    quads = np.stack([rows + columns, rows + width + columns, rows + width + after, rows + after], axis=2)
    last, zenith, nadir = (height - 1) * width, height * width, height * width + 1
    top = np.column_stack([np.full(width, zenith), columns, after])
    bottom = np.column_stack([np.full(width, nadir), last + after, last + columns])
    return [
        *map(tuple, quads.reshape(-1, 4).tolist()),
        *map(tuple, top.tolist()),
        *map(tuple, bottom.tolist()),
    ]


def _only_known(points, faces):
    """Points and faces without those that lie at infinity."""
    known = np.isfinite(points).all(axis=1)
    faces = [face for face in faces if known[list(face)].all()]
    used = np.unique([corner for face in faces for corner in face]).astype(int)
    number = np.zeros(len(points), int)
    number[used] = np.arange(len(used))
    return points[used], tuple(tuple(number[list(face)].tolist()) for face in faces)


def _errors(depth, points, faces):
    """Relative distance (F,) of the middles of faces from the map."""
    middles = np.array([points[list(face)].mean(axis=0) for face in faces])
    found = equirectangular.sample(depth.astype(np.float32)[..., None], middles)[..., 0]
    return np.abs(np.linalg.norm(middles, axis=1) / found - 1)
