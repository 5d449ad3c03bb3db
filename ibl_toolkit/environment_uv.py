"""A real UV layer that maps the panorama's image onto a mesh, and its error.

Shading looks the image up by direction and is exact. A UV layer, which exports and other programs need, is
linear on each triangle while the equirectangular mapping is not: it has an error, measured here in pixels of
the image.
uv_subdivision divides faces until that is small. A face across the seam gets a continuous u that runs beyond
1 (the image repeats); a face with a pole inside has no UV until it is divided.

UVs here are Blender's: u from the left, v from the BOTTOM edge of the image, where picks have v from the top.
Source: thesis, section 5.5.4.
"""

import numpy as np

from .equirectangular import direction_from_uv, uv_from_direction
from .meshes import Mesh
from .triangulation import triangulate

POLE = 1e-9  # sine of the angle to a pole below which a corner lies on it
STEPS = 6  # the error is sampled at the crossings of a grid of so many steps along each side of a triangle
GRID = np.array([(i, j, STEPS - i - j) for i in range(STEPS + 1) for j in range(STEPS + 1 - i)]) / STEPS


def corner_uvs(mesh: Mesh, world_from_panorama, camera_height):
    """Blender's UV (L, 2) for each of the L face corners, in the order of the faces.

    u is continuous within a face and may exceed 1. A corner on a pole takes the mean u of its neighbours.

    Raises ValueError, naming the first one, if a face holds a pole inside.

    >>> wall = Mesh([[4, 1, 0], [4, -1, 0], [4, -1, 3], [4, 1, 3]], ((0, 1, 2, 3),), np.eye(4))
    >>> corner_uvs(wall, np.eye(3), 1.5)[:, 0].round(3).tolist()
    [0.461, 0.539, 0.539, 0.461]
    """
    all_rays = rays(mesh.world_vertices, world_from_panorama, camera_height)
    uvs = []
    for index, face in enumerate(mesh.faces):
        face_uvs, winds = _unwrapped(all_rays[list(face)])
        if winds:
            raise ValueError(f"face {index} holds a pole of the image, so it has no UV: divide it first")
        uvs.append(face_uvs)
    return np.concatenate(uvs)


def uv_error_px(mesh: Mesh, world_from_panorama, camera_height, image_width):
    """Largest error of the layer that corner_uvs gives [pixels at the equator]; inf when a face holds a pole.

    Faces of more than three corners are measured on triangles of ours; other programs may divide them
    otherwise.

    >>> wall = Mesh([[4, 1, 0], [4, -1, 0], [4, -1, 3], [4, 1, 3]], ((0, 1, 2, 3),), np.eye(4))
    >>> round(uv_error_px(wall, np.eye(3), 1.5, 1024), 1)
    2.0
    """
    all_rays = rays(mesh.world_vertices, world_from_panorama, camera_height)
    worst = 0.0
    for face in mesh.faces:
        face_uvs, winds = _unwrapped(all_rays[list(face)])
        if winds:
            return float("inf")
        triangles = triangulate(mesh.world_vertices[list(face)])
        worst = max(worst, sample_errors(all_rays[list(face)][triangles], face_uvs[triangles]).max())
    return float(worst * image_width / (2 * np.pi))


def rays(world_points, world_from_panorama, camera_height):
    """Vectors (..., 3) in the panorama frame from its origin to points of the world (..., 3) [m].

    Raises ValueError for a point at the origin itself, which has no direction.
    """
    vectors = (np.asarray(world_points) - (0.0, 0.0, camera_height)) @ np.asarray(world_from_panorama)
    if not np.any(vectors, axis=-1).all():
        raise ValueError("a vertex lies at the panorama's origin, where it has no direction")
    return vectors


def on_pole(vectors):
    """Whether vectors (..., 3) of the panorama frame point to a pole of the image -> (...) bool."""
    return np.hypot(vectors[..., 0], vectors[..., 1]) <= POLE * np.linalg.norm(vectors, axis=-1)


def _unwrapped(vectors):
    """Blender's UV (k, 2) of one face with corners at vectors (k, 3), and whether it winds around a pole.

    A straight side is seen as an arc of less than half a turn, so its u takes the shorter way.
    """
    uv = uv_from_direction(vectors)
    at_pole = on_pole(vectors)
    around = np.flatnonzero(~at_pole)
    steps = np.diff(uv[around, 0], append=uv[around[:1], 0])
    steps -= np.round(steps)
    u = np.zeros(len(uv))
    u[around] = uv[around[0], 0] + np.cumsum(steps) - steps
    for i in np.flatnonzero(at_pole):
        u[i] = 0.5 * (u[i - 1] + u[(i + 1) % len(u)])
    return np.column_stack([u - np.floor(u.min()), 1 - uv[:, 1]]), bool(abs(steps.sum()) > 0.5)


def triangle_uvs(vectors):
    """Blender's UV (T, 3, 2) of triangles with corners at vectors (T, 3, 3), none with a pole inside."""
    uv = uv_from_direction(vectors)
    at_pole = on_pole(vectors)
    base = np.take_along_axis(uv[..., 0], np.argmin(at_pole, axis=1)[:, None], axis=1)
    steps = uv[..., 0] - base
    u = base + steps - np.round(steps)
    mean_of_others = 0.5 * (u.sum(axis=1, keepdims=True) - u)
    u = np.where(at_pole, mean_of_others, u)
    return np.stack([u - np.floor(u.min(axis=1, keepdims=True)), 1 - uv[..., 1]], axis=-1)


def sample_errors(vectors, uvs):
    """Angle [rad] between the shown and the right direction at the samples GRID of triangles -> (T, S).

    vectors (T, 3, 3) to the corners, uvs (T, 3, 2) Blender's.
    """
    right = GRID @ vectors
    right /= np.linalg.norm(right, axis=-1, keepdims=True)
    shown_uv = GRID @ uvs
    shown = direction_from_uv(np.stack([shown_uv[..., 0], 1 - shown_uv[..., 1]], axis=-1))
    return 2 * np.arcsin(np.clip(0.5 * np.linalg.norm(shown - right, axis=-1), 0, 1))
