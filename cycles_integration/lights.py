"""Emitters of a light map as Blender area lights at their depth."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from ..ibl_toolkit.emitters import Emitter
from .place import Place


def replace_lights(place: Place, emitters: tuple[Emitter, ...]) -> list[bpy.types.Object]:
    """Put one area light for each emitter into the place, in the stead of those before.

    They light diffuse surfaces only: camera, mirror and glass rays see the photograph, whose lamps they are.
    """
    for thing in list(place.lights.objects):
        bpy.data.lights.remove(thing.data)
    return [_area_light(place, number, emitter) for number, emitter in enumerate(emitters)]


def _area_light(place, number, emitter):
    data = bpy.data.lights.new(f"Panorama Light {number}", "AREA")
    data.shape = "RECTANGLE"
    data.size, data.size_y = emitter.size
    strongest = float(emitter.radiance.max())
    data.color = (emitter.radiance / strongest).tolist()
    data.energy = strongest * np.pi * emitter.area  # radiant power [W] of a Lambertian emitter
    light = bpy.data.objects.new(data.name, data)
    light.matrix_world = place.origin.matrix_world @ _panorama_from_light(emitter)
    light.visible_camera = light.visible_glossy = light.visible_transmission = False
    light.visible_volume_scatter = True
    place.lights.objects.link(light)
    return light


def _panorama_from_light(emitter):
    """Blender's area light shines along its −z."""
    first, second, normal = emitter.axes.T
    rotation = np.column_stack([first, -second, -normal])
    return Matrix.Translation(emitter.position.tolist()) @ Matrix(rotation.tolist()).to_4x4()
