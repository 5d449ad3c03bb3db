"""The lights that a photograph of a probe told, as sun lights under one Empty that carries their frame."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .picked_sun import aim

COLLECTION, FRAME, SUN = "Probe Lights", "Probe Frame", "Probe Light"
TOLD = "panorama_probe"
"""Custom property of such a collection: the photograph's name and the warnings of the estimate."""


@dataclass(frozen=True, eq=False)
class ProbeSun:
    """A light as it is to be put.

    direction: (3,) unit vector to it, irradiance: (3,) RGB [W/m²], diameter_deg [°].
    """

    direction: np.ndarray
    irradiance: np.ndarray
    diameter_deg: float


def put_probe_lights(
    scene: bpy.types.Scene, suns: list[ProbeSun], world_from_frame: Matrix, told: dict
) -> list[bpy.types.Object]:
    """Put sun lights into the scene's collection of probe lights, instead of those there -> the lights.

    suns: the strongest first, their directions in a frame that the matrix (4, 4) puts into the world; an
    Empty there carries them, so that turning it turns all. told: kept for the panel.
    """
    collection = _emptied(scene)
    collection[TOLD] = told
    frame = bpy.data.objects.new(FRAME, None)
    frame.empty_display_type, frame.empty_display_size = "ARROWS", 0.2
    frame.matrix_world = Matrix(world_from_frame)
    frame[TOLD] = True
    collection.objects.link(frame)
    return [_put(collection, frame, number, sun) for number, sun in enumerate(suns, 1)]


def collection_of(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """The scene's collection of probe lights, or None."""
    own = (c for c in scene.collection.children_recursive if c.library is None)
    return next((collection for collection in own if TOLD in collection), None)


def suns_in(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Its sun lights that a photograph told, the strongest first."""
    found = [thing for thing in collection.objects if thing.type == "LIGHT" and TOLD in thing]
    return sorted(found, key=lambda thing: thing[TOLD])


def _emptied(scene):
    """The scene's collection, without the lights and the Empty that were put there before."""
    collection = collection_of(scene)
    if collection is None:
        collection = bpy.data.collections.new(COLLECTION)
        scene.collection.children.link(collection)
    for thing in [thing for thing in collection.objects if TOLD in thing]:
        data = thing.data
        bpy.data.objects.remove(thing)
        if data is not None and not data.users:
            bpy.data.lights.remove(data)
    return collection


def _put(collection, frame, number, sun):
    data = bpy.data.lights.new(f"{SUN} {number}", "SUN")
    strongest = float(sun.irradiance.max())
    data.energy, data.angle = strongest, float(np.radians(sun.diameter_deg))
    data.color = (sun.irradiance / max(strongest, 1e-30)).tolist()
    thing = bpy.data.objects.new(data.name, data)
    thing[TOLD] = number
    thing.parent = frame
    aim(thing, Vector(sun.direction.tolist()), Vector())
    collection.objects.link(thing)
    return thing
