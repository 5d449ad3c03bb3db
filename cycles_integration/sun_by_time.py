"""A sun light that stands where the sun stood at a place and time."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Vector

from ..ibl_toolkit.mobile.sun_position import DIAMETER_DEG
from .picked_sun import aim
from .place import is_here

NAME = "Sun by Time"
SETTINGS = "panorama_sun_by_time"
"""Custom property of such a sun: what it was made with, by which it is known and can be made anew."""
STRENGTH = 1.0
"""Of a new one, as Blender gives suns of its own [W/m²]: a panorama's radiance has a unit of its own."""


def put_sun_by_time(
    scene: bpy.types.Scene, direction: np.ndarray, settings: dict
) -> tuple[bpy.types.Object, bool]:
    """Add a sun light that shines from a direction (3,) of the world, or turn the scene's one by time.

    Returns it, and whether it is new. Strength and colour stay as the artist has set them.
    """
    sun = sun_by_time(scene)
    is_new = sun is None
    if is_new:
        sun = bpy.data.objects.new(NAME, bpy.data.lights.new(NAME, "SUN"))
        sun.data.energy, sun.data.angle = STRENGTH, float(np.radians(DIAMETER_DEG))
        scene.collection.objects.link(sun)
    sun[SETTINGS] = settings
    place = scene.panorama_place
    has_place = place.origin is not None and is_here(place)
    aim(sun, Vector(direction), place.origin.matrix_world.translation if has_place else Vector())
    return sun, is_new


def sun_by_time(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """The scene's sun by time, or None."""
    own = (thing for thing in scene.objects if thing.library is None and thing.type == "LIGHT")
    return next((thing for thing in own if thing.data.type == "SUN" and SETTINGS in thing), None)
