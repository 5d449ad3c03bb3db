"""A lamp of the panorama as a sun light of the artist's own, which shines as the calibration turns it."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from ..ibl_toolkit.light.discs import Disc
from .place import Place

NAME = "Sun from Panorama"
LAMP_DIRECTION = "panorama_sun"
"""Custom property of such a sun: the direction (3,) of its lamp in the panorama frame, by which it is known
again after another calibration."""
DISTANCE = 2.0
"""So far [m] from the panorama's origin a sun is drawn, on the ray to its lamp."""
SAME_DEG = 1.0
"""Lamps nearer to each other than this, or than their radius, are one."""


@dataclass(frozen=True)
class PickedSun:
    """A sun light, and where it stands in the world."""

    light: bpy.types.Object
    is_new: bool
    elevation_deg: float
    azimuth_deg: float
    """From +x towards +y, in [0, 360)."""


def put_sun(scene: bpy.types.Scene, place: Place, lamp: Disc) -> PickedSun:
    """Add a sun light for a lamp of the panorama, or bring the one that stands for it up to date.

    It has the lamp's direction through the place's origin, its diameter, colour and irradiance. It is the
    artist's own: neither Prepare Light nor Build touches it.
    """
    sun = _sun_of(scene, lamp)
    is_new = sun is None
    if is_new:
        sun = bpy.data.objects.new(NAME, bpy.data.lights.new(NAME, "SUN"))
        scene.collection.objects.link(sun)
    strongest = float(lamp.irradiance.max())
    sun.data.energy, sun.data.angle = strongest, 2 * lamp.radius
    sun.data.color = (lamp.irradiance / strongest).tolist()
    sun[LAMP_DIRECTION] = lamp.direction.tolist()
    origin = place.origin.matrix_world
    direction = (origin.to_3x3() @ Vector(lamp.direction.tolist())).normalized()
    aim(sun, direction, origin.translation)
    azimuth_deg = float(np.degrees(np.arctan2(direction.y, direction.x))) % 360
    return PickedSun(sun, is_new, float(np.degrees(np.arcsin(direction.z))), azimuth_deg)


def aim(sun: bpy.types.Object, direction: Vector, origin: Vector):
    """Let a sun light shine from a direction of the world, drawn on the ray from ``origin`` towards it."""
    sun.rotation_mode = "XYZ"
    sun.rotation_euler = direction.to_track_quat("Z", "Y").to_euler()  # it shines along its −z
    sun.location = origin + DISTANCE * direction


def _sun_of(scene, lamp):
    """The scene's sun that was picked for a lamp before, or None."""
    least = np.cos(max(lamp.radius, np.radians(SAME_DEG)))
    for thing in scene.objects:
        is_picked = thing.type == "LIGHT" and thing.data.type == "SUN" and LAMP_DIRECTION in thing
        if is_picked and thing.library is None and np.dot(thing[LAMP_DIRECTION], lamp.direction) >= least:
            return thing
    return None
