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
    photograph shows throws its shadows there already. What views alone show, by a collection that renders
    leave out, throws none.
    """
    hidden = _hidden(depsgraph.view_layer)
    points, triangles, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for instance in depsgraph.object_instances:
        if not _is_caster(instance, hidden):
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


def throwing_names(scene: bpy.types.Scene) -> frozenset[str]:
    """Names of the scene's objects that throw shadows as far as it is theirs to say: compared with those of
    an earlier moment, it tells a change that no update names."""
    return frozenset(thing.name for thing in scene.objects if thing.type in KINDS and _throws(thing, thing))


def _is_caster(instance, hidden):
    thing = instance.object
    own = thing.original
    stands = instance.parent.original if instance.is_instance else own  # an instance is where its parent is
    if thing.type not in KINDS or not instance.show_self or stands in hidden:
        return False
    return _throws(thing, own)


def _throws(thing, own):
    if own.hide_render or roles.LAMP in own:
        return False
    return thing.visible_shadow and own.panorama_role == roles.SYNTHETIC


def _hidden(view_layer):
    """Objects of a view layer that are only in collections which renders leave out."""
    hidden, shown = set(), set()

    def sort_out(layer, is_hidden):
        is_hidden = is_hidden or layer.collection.hide_render
        if not layer.exclude:
            (hidden if is_hidden else shown).update(layer.collection.objects)
        for child in layer.children:
            sort_out(child, is_hidden)

    sort_out(view_layer.layer_collection, False)
    return hidden - shown


def _numbers(items, name, kind):
    values = np.empty(3 * len(items), kind)
    items.foreach_get(name, values)
    return values.reshape(-1, 3).astype(np.float64 if kind is np.float32 else np.int64)
