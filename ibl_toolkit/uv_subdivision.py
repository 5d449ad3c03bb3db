"""Division of a mesh until a UV layer can map the panorama onto it within a stated error."""

from dataclasses import dataclass

import numpy as np

from .environment_uv import rays, sample_errors, triangle_uvs
from .meshes import Mesh, transformed
from .triangulation import triangulate

MOST_FACES = 200_000
SLACK = 1e-9  # in barycentric coordinates: a pole this near to a side or a corner lies on it
SIDES = ((0, 1), (1, 2), (2, 0))


@dataclass(frozen=True, eq=False)
class UvMesh:
    """A mesh of triangles with its UV layer.

    corner_uvs (3 F, 2): Blender's UV per face corner, in the order of the faces. error_px: largest distance
    between the image point that the layer shows and the right one [pixels at the equator].
    """

    mesh: Mesh
    corner_uvs: np.ndarray
    error_px: float


def subdivide_for_uv(mesh, world_from_panorama, camera_height, image_width, max_error_px=1.0):
    """The same surface in about as few triangles as keep its UV layer within max_error_px -> UvMesh.

    The mesh's vertices come first, in their order. Poles become vertices; then the worst side of each
    triangle beyond the limit is halved, for both its neighbours, so that no gaps open. What it took is
    len(result.mesh.faces), what is left result.error_px.

    Raises ValueError for a limit that is not above 0 or takes more than MOST_FACES triangles.

    >>> floor = Mesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], ((0, 1, 2, 3),), np.eye(4))
    >>> result = subdivide_for_uv(floor, np.eye(3), 1.5, 1024, max_error_px=4)
    >>> len(result.mesh.faces) < 200, result.error_px <= 4
    (True, True)
    """
    if not max_error_px > 0:
        raise ValueError(f"max_error_px is {max_error_px:g}, must be above 0")
    limit = max_error_px * 2 * np.pi / image_width
    local = [tuple(vertex) for vertex in mesh.vertices]
    triangles = _triangles(mesh)
    for pole in (1.0, -1.0):
        direction = pole * np.asarray(world_from_panorama)[:, 2]
        triangles = _split_at(direction, camera_height, local, triangles, mesh.world_from_local)
    errors = {}  # of the triangles measured so far
    while True:
        new = [triangle for triangle in triangles if triangle not in errors]
        vectors = _rays_to_corners(local, new, mesh, world_from_panorama, camera_height)
        worst = sample_errors(vectors, triangle_uvs(vectors)).max(axis=1)
        errors.update(zip(new, worst, strict=True))
        beyond = np.flatnonzero(worst > limit)
        if not len(beyond):
            break
        sides = _longest_sides([new[index] for index in beyond], vectors[beyond])
        triangles = _halved(local, triangles, sides)
        if len(triangles) > MOST_FACES:
            raise ValueError(f"max_error_px {max_error_px:g} takes over {MOST_FACES} triangles: allow more")
    vectors = _rays_to_corners(local, triangles, mesh, world_from_panorama, camera_height)
    error_px = max(errors[triangle] for triangle in triangles) * image_width / (2 * np.pi)
    divided = Mesh(local, tuple(triangles), mesh.world_from_local)
    return UvMesh(divided, triangle_uvs(vectors).reshape(-1, 2), float(error_px))


def _rays_to_corners(local, triangles, mesh, world_from_panorama, camera_height):
    corners = np.array(local)[np.array(triangles)]
    return rays(transformed(mesh.world_from_local, corners), world_from_panorama, camera_height)


def _triangles(mesh):
    points = mesh.world_vertices
    return [
        tuple(face[corner] for corner in triangle)
        for face in mesh.faces
        for triangle in triangulate(points[list(face)]).tolist()
    ]


def _split_at(direction, camera_height, local, triangles, world_from_local):
    """Make a vertex wherever the ray from the panorama's origin in `direction` meets a triangle."""
    origin = np.array([0.0, 0.0, camera_height])
    world = transformed(world_from_local, np.array(local))
    made = {}
    result = []
    for triangle in triangles:
        weights = _met(world[list(triangle)] - origin, direction)
        inside = np.abs(weights) > SLACK if weights is not None else np.zeros(3, dtype=bool)
        if np.count_nonzero(inside) < 2:  # not met, or met at a corner that is there already
            result.append(triangle)
            continue
        touched = tuple(sorted(np.array(triangle)[inside].tolist()))
        if touched not in made:  # a point on a side belongs to both its triangles
            weights = np.where(inside, weights, 0) / weights[inside].sum()
            local.append(tuple(weights @ np.array([local[corner] for corner in triangle])))
            made[touched] = len(local) - 1
        result += [
            (triangle[a], triangle[b], made[touched])
            for (a, b), opposite in zip(SIDES, (2, 0, 1), strict=True)
            if inside[opposite]
        ]
    return result


def _met(corners, direction):
    """Barycentric weights (3,) of the point where a ray from the origin meets a triangle (3, 3), or None."""
    a, b, c = corners
    volumes = np.array([direction @ np.cross(b, c), direction @ np.cross(c, a), direction @ np.cross(a, b)])
    total = volumes.sum()
    scale = np.abs(volumes).max()
    if abs(total) <= SLACK * scale or scale == 0:  # seen edge-on
        return None
    weights = volumes / total
    if weights.min() < -SLACK or np.dot(direction, weights @ corners) <= 0:
        return None
    return weights


def _longest_sides(triangles, vectors):
    """The side of each triangle that is seen under the largest angle; halving those avoids slivers."""
    unit = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    longest = np.linalg.norm(unit - np.roll(unit, -1, axis=1), axis=-1).argmax(axis=1)
    return {_key(*(corners[end] for end in SIDES[s])) for corners, s in zip(triangles, longest, strict=True)}


def _key(a, b):
    return (a, b) if a < b else (b, a)


def _halved(local, triangles, sides):
    """The triangles with these sides halved; the new vertices are appended to `local`."""
    middles = {}
    for a, b in sides:
        middles[a, b] = len(local)
        local.append(tuple(0.5 * (np.array(local[a]) + local[b])))
    result = []
    waiting = list(reversed(triangles))
    while waiting:
        triangle = waiting.pop()
        for turn in range(3):
            a, b, c = triangle[turn:] + triangle[:turn]
            middle = middles.get(_key(a, b))
            if middle is not None:
                waiting += [(middle, b, c), (a, middle, c)]
                break
        else:
            result.append(triangle)
    return result
