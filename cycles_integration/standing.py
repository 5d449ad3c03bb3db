"""Where something can stand in a place: the support or floor that a ray meets, and how objects get there."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

from . import roles
from .place import Place

LEAST_SLOPE = 0.005
"""A ray that falls by less than this share of its length is at the horizon: it meets no floor nearby."""
LEVEL = 0.7
"""Cosine between the vertical and the normal of the steepest surface on which something stands."""
FLOOR = "the floor"


def spot_under(scene: bpy.types.Scene, depsgraph, origin: Vector, direction: Vector) -> tuple[Vector, str]:
    """Return where a ray of the world meets the nearest support or else the floor z = 0, and its name.

    Raises ValueError where it goes level or upwards, starts below the floor, or meets a support's side.
    """
    direction = direction.normalized()
    if direction.z > -LEAST_SLOPE:
        raise ValueError("no floor there: the cursor is at the horizon or above it")
    hits = (_hit(thing, depsgraph, origin, direction) for thing in roles.with_role(scene, roles.SUPPORT))
    hits = sorted((hit for hit in hits if hit), key=lambda hit: hit[0])
    if not hits and origin.z <= 0:
        raise ValueError("no floor there: it is seen from below")
    if not hits:
        return origin - direction * (origin.z / direction.z), FLOOR
    distance, normal, name = hits[0]
    if abs(normal.z) < LEVEL:
        raise ValueError(f"that is a side of '{name}', which carries nothing: point at its top or the floor")
    return origin + direction * distance, f"'{name}'"


def bounds(objects: list[bpy.types.Object], depsgraph) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner (3,) [m] of all that objects show in the world, with children and instances.

    What shows nothing (a light, a camera) counts as a point.
    """
    names = {child.name_full for thing in objects for child in (thing, *thing.children_recursive)}
    points = [np.array([thing.matrix_world.translation for thing in objects])]
    for instance in depsgraph.object_instances:
        owner = instance.parent if instance.is_instance else instance.object
        if owner.name_full in names:
            points.append(_points(instance.object, instance.matrix_world))
    shown = points[1:] if any(map(len, points[1:])) else points
    whole = np.concatenate([each for each in shown if len(each)])
    return whole.min(axis=0), whole.max(axis=0)


def move_by(objects: list[bpy.types.Object], offset: Vector):
    """Move objects in the world; what hangs on another of them moves along with it."""
    moved = set(objects)
    matrices = {thing: thing.matrix_world.copy() for thing in objects}
    for thing in objects:
        if not moved.intersection(_ancestors(thing)):
            thing.matrix_world = Matrix.Translation(offset) @ matrices[thing]


def belongs_to(place: Place, thing: bpy.types.Object) -> bool:
    """Whether an object is one that the place made for itself: its origin, its lamps and suns."""
    ours = place.lights.objects, place.suns.objects
    return thing in (place.origin, place.catcher) or any(thing.name in objects for objects in ours)


def _hit(thing, depsgraph, origin, direction):
    """(distance [m], normal in the world, name) of the first point of a mesh on a world ray, or None."""
    # A mesh that the view layer leaves out has no evaluated one; the depsgraph then gives its own.
    mesh = thing.evaluated_get(depsgraph).data
    matrix = thing.matrix_world
    vertices = [matrix @ vertex.co for vertex in mesh.vertices]
    tree = BVHTree.FromPolygons(vertices, [polygon.vertices for polygon in mesh.polygons])
    _, normal, _, distance = tree.ray_cast(origin, direction)
    return None if distance is None else (distance, normal, thing.name)


def _points(shown, matrix):
    """What an evaluated object shows as points (n, 3) of the world: vertices, or corners of its bounds."""
    if shown.type == "MESH":
        local = np.empty(3 * len(shown.data.vertices), np.float32)
        shown.data.vertices.foreach_get("co", local)
        local = local.reshape(-1, 3)
    elif shown.type in {"CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME"}:
        local = np.array([tuple(corner) for corner in shown.bound_box])
    else:
        return np.empty((0, 3))
    matrix = np.array(matrix)
    return local @ matrix[:3, :3].T + matrix[:3, 3]


def _ancestors(thing):
    while thing.parent is not None:
        thing = thing.parent
        yield thing
