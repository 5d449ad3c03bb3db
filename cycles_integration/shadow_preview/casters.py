"""The meshes of what renders show of a scene, as it is evaluated: modifiers and instances included."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator

import bpy
import numpy as np

from .. import roles

KINDS = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
"""Types of objects that have triangles."""
NOTHING_THROWS = (
    "nothing throws a shadow: there is no object of the role Synthetic that renders show and whose ray "
    "visibility includes shadows"
)


def casters_of(depsgraph: bpy.types.Depsgraph) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) [m] of the world and triangles (T, 3), their indices, of all that throws shadows.

    That is what renders show of the role SYNTHETIC, unless its ray visibility leaves shadows out: what the
    photograph shows throws its shadows there already. What views alone show, by a collection that renders
    leave out, throws none. Points of no triangle, a path's for instance, are left out.

    Raises ValueError that names a thing whose points are not finite.
    """
    return _triangles(depsgraph, throws_shadow)


def ground_of(depsgraph: bpy.types.Depsgraph) -> tuple[np.ndarray, np.ndarray]:
    """The same of the role SUPPORT, which throws no shadow, but receives them.

    ENVIRONMENT is left out: where a floor ends at a wall that is in the map, the filter darkens the corner.
    """
    return _triangles(depsgraph, lambda thing: thing.original.panorama_role == roles.SUPPORT)


def _triangles(depsgraph, is_wanted):
    points, triangles, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for instance, mesh in shown_meshes(depsgraph, is_wanted):
        corners = numbers(mesh.loop_triangles, "vertices", np.int32)
        is_used = np.zeros(len(mesh.vertices), bool)
        is_used[corners] = True
        points.append(points_of(instance, mesh)[is_used])
        triangles.append((np.cumsum(is_used) - 1)[corners] + count)
        count += len(points[-1])
    return np.concatenate(points), np.concatenate(triangles)


def shown_meshes(
    depsgraph: bpy.types.Depsgraph, is_wanted: Callable[[bpy.types.Object], bool]
) -> Iterator[tuple[bpy.types.DepsgraphObjectInstance, bpy.types.Mesh]]:
    """Each instance that renders show and whose evaluated object is wanted, with its mesh in triangles.

    Both are there for their step of the loop only. The photograph's lamps are left out.
    """
    for instance in shown_instances(depsgraph, KINDS):
        thing = instance.object
        if roles.LAMP in thing.original or not is_wanted(thing):
            continue
        mesh = thing.to_mesh()
        try:
            if mesh is not None:
                mesh.calc_loop_triangles()
                yield instance, mesh
        finally:
            thing.to_mesh_clear()


def shown_instances(
    depsgraph: bpy.types.Depsgraph, kinds: Collection[str]
) -> Iterator[bpy.types.DepsgraphObjectInstance]:
    """Each instance of some types of objects that renders show; it is there for its step of the loop only."""
    hidden, parts = _hidden(depsgraph.view_layer), {}
    for instance in depsgraph.object_instances:
        own = instance.object.original
        # An instance is where its parent is.
        stands = instance.parent.original if instance.is_instance else own
        if own.type not in kinds or not instance.show_self or stands in hidden:
            continue
        by_nodes = instance.is_instance and stands.instance_type == "NONE"
        if stands.hide_render or (own.hide_render and not by_nodes) or own in _hidden_parts(stands, parts):
            continue  # geometry nodes repeat what renders leave out, too
        yield instance


def throws_shadow(thing: bpy.types.Object) -> bool:
    """Whether an object, evaluated or not, throws shadows where renders show it."""
    own = thing.original
    return thing.visible_shadow and own.panorama_role == roles.SYNTHETIC and roles.LAMP not in own


def points_of(instance: bpy.types.DepsgraphObjectInstance, mesh: bpy.types.Mesh) -> np.ndarray:
    """Vertices (V, 3) in the world [m].

    Raises ValueError that names the object where they are not finite.
    """
    matrix = np.array(instance.matrix_world)
    points = numbers(mesh.vertices, "co", np.float32) @ matrix[:3, :3].T + matrix[:3, 3]
    if not np.isfinite(points).all():
        raise ValueError(f"'{instance.object.name}' has vertices whose places are not finite numbers")
    return points


def drawn_things(scene: bpy.types.Scene) -> frozenset[tuple[str, bool]]:
    """Names of the scene's objects that are drawn into maps as far as it is theirs to say, and whether they
    throw shadows: compared with those of an earlier moment, it tells a change that no update names."""
    things = (thing for thing in scene.objects if thing.type in KINDS and not thing.hide_render)
    return frozenset((thing.name, throws_shadow(thing)) for thing in things)


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


def _hidden_parts(thing, known):
    """Objects that an instance of a collection has, itself or by instances in it, but renders leave out.

    known: what was found, by collection.
    """
    whole = thing.instance_collection
    if whole is None or whole in known:
        return known.get(whole, ())
    hidden, shown = set(), set()

    def sort_out(part, is_hidden, above):
        is_hidden = is_hidden or part.hide_render
        for one in part.objects:
            (hidden if is_hidden else shown).add(one)
            inner = one.instance_collection
            if inner is not None and inner not in above:
                sort_out(inner, is_hidden or one.hide_render, {*above, inner})
        for child in part.children:
            sort_out(child, is_hidden, above)

    sort_out(whole, False, {whole})
    known[whole] = hidden - shown
    return known[whole]


def numbers(items, name: str, kind) -> np.ndarray:
    """Three numbers of each item of a mesh, (n, 3): np.float32 comes as float64, np.int32 as int64."""
    values = np.empty(3 * len(items), kind)
    items.foreach_get(name, values)
    return values.reshape(-1, 3).astype(np.float64 if kind is np.float32 else np.int64)
