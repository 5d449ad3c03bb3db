"""What renders show of a scene as meshes for a phone: one colour each, with the normals that are shaded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from ...ibl_toolkit.mobile.shadow_scene import SceneMesh
from ..shadow_preview.casters import numbers, points_of, shown_meshes, throws_shadow
from .colours import base_colour

BARE = (0.8, 0.8, 0.8)
"""What Blender shows without a material."""
_STEPS = 1000  # of a normal's coordinates, within which corners are one: 0.06°


@dataclass
class _Parts:
    """Of one thing and material, instance by instance."""

    points: list = field(default_factory=list)
    normals: list = field(default_factory=list)
    triangles: list = field(default_factory=list)
    count: int = 0

    def add(self, points, normals, triangles):
        self.points.append(points)
        self.normals.append(normals)
        self.triangles.append(triangles + self.count)
        self.count += len(points)


def meshes_of(depsgraph: bpy.types.Depsgraph) -> tuple[list[SceneMesh], list[str]]:
    """Meshes of all that renders show, and warnings; all instances of a thing are one mesh for each material.

    Of the role Synthetic: new, in the base colour of the material, and throws shadows unless the ray
    visibility leaves them out. Support and Environment: real, and throws none.
    """
    parts = {}
    for instance, mesh in shown_meshes(depsgraph, lambda thing: True):
        thing = instance.object
        role = thing.original.panorama_role.lower()
        is_new = role == "synthetic"
        worn = [slot.material for slot in thing.material_slots] or [None]
        of_triangle = np.minimum(_values(mesh.loop_triangles, "material_index", np.int32), len(worn) - 1)
        corners, normals = _corners(instance, mesh)
        points = points_of(instance, mesh)
        for number in np.unique(of_triangle):
            key = thing.original, worn[number].original if is_new and worn[number] else None
            throws = throws_shadow(thing)
            name = f"{thing.original.name}, {key[1].name}" if key[1] else thing.original.name
            one = parts.setdefault((key, role, throws, name), _Parts())
            one.add(*_welded(points, corners[of_triangle == number], normals[of_triangle == number]))
    colours = {key[1]: base_colour(key[1]) if key[1] else (BARE, "") for key, *_ in parts}
    return [
        SceneMesh(
            name,
            np.concatenate(one.points),
            np.concatenate(one.triangles),
            role,
            colours[key[1]][0],
            np.concatenate(one.normals),
            throws,
        )
        for (key, role, throws, name), one in parts.items()
    ], [warning for _, warning in colours.values() if warning]


def joined(meshes: Sequence[SceneMesh]) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) and triangles (T, 3) of all together."""
    points, triangles, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for mesh in meshes:
        points.append(mesh.points)
        triangles.append(mesh.triangles + count)
        count += len(mesh.points)
    return np.concatenate(points), np.concatenate(triangles)


def _corners(instance, mesh):
    """Of each triangle its corners' vertices (T, 3), and normals (T, 3, 3) in the world."""
    which = numbers(mesh.loop_triangles, "loops", np.int32)
    vertices = _values(mesh.loops, "vertex_index", np.int32)[which]
    matrix = np.array(instance.matrix_world)[:3, :3]
    turn = np.linalg.pinv(matrix)  # of normals; flattened things have no inverse
    normals = numbers(mesh.corner_normals, "vector", np.float32)[which] @ turn
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.where(length > 0, normals / np.where(length > 0, length, 1), (0.0, 0.0, 1.0))
    if np.linalg.det(matrix) < 0:  # a mirror turns the other side up
        return vertices[:, ::-1], normals[:, ::-1]
    return vertices, normals


def _welded(points, corners, normals):
    """Points (n, 3), normals (n, 3), triangles (T, 3): corners of one vertex and normal are one point."""
    codes = np.rint(normals.reshape(-1, 3) * _STEPS).astype(np.int64) + _STEPS
    key = corners.reshape(-1).astype(np.int64)
    for k in range(3):
        key = key * (2 * _STEPS + 1) + codes[:, k]
    _, first, number = np.unique(key, return_index=True, return_inverse=True)
    return points[corners.reshape(-1)[first]], normals.reshape(-1, 3)[first], number.reshape(-1, 3)


def _values(items, name, kind):
    values = np.empty(len(items), kind)
    items.foreach_get(name, values)
    return values
