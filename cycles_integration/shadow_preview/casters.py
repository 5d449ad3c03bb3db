"""The triangles of what throws shadows in a scene, as it is evaluated: modifiers and instances included."""

from __future__ import annotations

import bpy
import numpy as np

from .. import roles

KINDS = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
"""Types of objects that have triangles."""


def casters_of(depsgraph: bpy.types.Depsgraph) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) [m] of the world and triangles (T, 3), their indices, of all that throws shadows.

    That is what renders show of the role SYNTHETIC, unless its ray visibility leaves shadows out: what the
    photograph shows throws its shadows there already.
    """
    points, triangles, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for instance in depsgraph.object_instances:
        if not _throws(instance):
            continue
        mesh = instance.object.to_mesh()
        if mesh is not None:
            matrix = np.array(instance.matrix_world)
            points.append(_numbers(mesh.vertices, "co", np.float32) @ matrix[:3, :3].T + matrix[:3, 3])
            mesh.calc_loop_triangles()
            triangles.append(_numbers(mesh.loop_triangles, "vertices", np.int32) + count)
            count += len(points[-1])
        instance.object.to_mesh_clear()
    return np.concatenate(points), np.concatenate(triangles)


def _throws(instance):
    thing = instance.object
    own = thing.original
    if thing.type not in KINDS or not instance.show_self or own.hide_render or roles.LAMP in own:
        return False
    return thing.visible_shadow and own.panorama_role == roles.SYNTHETIC


def _numbers(items, name, kind):
    values = np.empty(3 * len(items), kind)
    items.foreach_get(name, values)
    return values.reshape(-1, 3).astype(np.float64 if kind is np.float32 else np.int64)
