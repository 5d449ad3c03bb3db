"""Closed solids of a scene: objects whose inside no one outside of them sees."""

from __future__ import annotations

import contextlib

import bpy
import numpy as np
from mathutils import Vector


def closed_solids(layer: bpy.types.ViewLayer, origin: Vector) -> set[bpy.types.Object]:
    """The objects of a view layer that are closed all round, face outwards, and don't hold the origin.

    A face's edges must each be shared with one other face that goes round it the other way; vertices in one
    place count as one. An object with instances is one of these if none of them holds the origin. Objects,
    collections and modifiers count as they are rendered, whatever the viewport shows.
    """
    layer.update()
    with _as_rendered(layer):
        layer.update()
        return _closed_in(layer.depsgraph, origin)


def _closed_in(depsgraph, origin):
    found, others, known = set(), set(), {}
    for instance in depsgraph.object_instances:
        thing = instance.object.original
        if instance.object.type != "MESH":
            continue
        mesh = instance.object.data
        key = mesh.as_pointer()
        if key not in known:
            known[key] = _outward_triangles(mesh)
        triangles = known[key]
        is_solid = triangles is not None and not _holds(triangles, instance.matrix_world, origin)
        (found if is_solid else others).add(thing)
    return found - others


@contextlib.contextmanager
def _as_rendered(layer):
    """While the block runs, the viewport shows what is rendered of a view layer."""
    things, kept = _things(layer.objects), []
    unseen = [thing for thing in layer.objects if thing.hide_get(view_layer=layer)]

    def lend(owner, name, value):
        kept.append((owner, name, getattr(owner, name)))
        setattr(owner, name, value)

    try:
        for child in _children(layer.layer_collection):
            lend(child, "hide_viewport", False)
            lend(child.collection, "hide_viewport", child.collection.hide_render)
        for thing in things:
            lend(thing, "hide_viewport", thing.hide_render)
            for modifier in thing.modifiers:
                lend(modifier, "show_viewport", modifier.show_render)
        for thing in unseen:
            thing.hide_set(False, view_layer=layer)
        yield
    finally:
        for owner, name, value in reversed(kept):
            setattr(owner, name, value)
        for thing in unseen:
            thing.hide_set(True, view_layer=layer)


def _things(objects):
    """Objects, and those of the collections that they instance."""
    found, left = set(), list(objects)
    while left:
        thing = left.pop()
        if thing not in found:
            found.add(thing)
            instanced = thing.instance_collection
            left.extend(instanced.all_objects if instanced is not None else ())
    return found


def _children(collection):
    for child in collection.children:
        yield child
        yield from _children(child)


def _outward_triangles(mesh):
    """(n, 3, 3) corners of a closed mesh that faces outwards; None for any other."""
    count = len(mesh.loops)
    if not count:
        return None
    corners = np.empty(count, np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    places = places.reshape(-1, 3)
    _, welded = np.unique(places, axis=0, return_inverse=True)
    if not _is_closed(welded.reshape(-1)[corners], mesh):
        return None
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    triangles = places[triangles].astype(np.float64).reshape(-1, 3, 3)
    volume = np.einsum("ni,ni->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    return triangles if volume > 0 else None


def _is_closed(corners, mesh):
    """Whether each edge is gone along once in either direction."""
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    following = np.arange(1, len(corners) + 1)
    following[np.append(starts[1:], len(corners)) - 1] = starts
    pairs = np.stack([corners, corners[following]], axis=1).astype(np.int64)
    there, back = (np.sort(pairs[:, k] * (corners.max() + 1) + pairs[:, 1 - k]) for k in (0, 1))
    return np.array_equal(there, back) and (np.diff(there) > 0).all()


def _holds(triangles, matrix_world, point):
    """Whether a point lies in a closed mesh: its faces then surround it, as seen from there."""
    matrix = np.array(matrix_world)
    corners = triangles @ matrix[:3, :3].T + (matrix[:3, 3] - np.array(point))
    if (corners > 0).all(axis=(0, 1)).any() or (corners < 0).all(axis=(0, 1)).any():
        return False
    first, second, third = np.moveaxis(corners, 1, 0)
    a, b, c = (np.linalg.norm(corner, axis=1) for corner in (first, second, third))
    above = np.einsum("ni,ni->n", first, np.cross(second, third))
    dots = [np.einsum("ni,ni->n", p, q) for p, q in ((first, second), (second, third), (third, first))]
    below = a * b * c + dots[0] * c + dots[1] * a + dots[2] * b
    solid_angle = 2 * np.arctan2(above, below).sum()  # Van Oosterom and Strackee, 1983
    return abs(solid_angle) > 2 * np.pi
