"""The cameras from which the sample room is looked at: those of Table 8.1, and C₀ and C₁ of section 7.4.3."""

from __future__ import annotations

import math
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Vector

from ...ibl_toolkit.layers.views.pinhole import Pinhole

FOV_DEG = 60.0
"""Of a view's width (thesis, 8.6)."""


class View(NamedTuple):
    """A perspective camera that stands upright."""

    name: str
    eye: tuple[float, float, float]
    """[m] in the world."""
    direction: tuple[float, float, float]
    """Of sight, in the world; about a unit vector, as printed."""


# Source: thesis, Table 8.1.
TABLE_8_1 = (
    View("S1", (0.0, 0.0, 1.15), (0.93, 0.34, -0.10)),
    View("S2", (0.0, 0.0, 1.15), (0.34, -0.93, -0.10)),
    View("S3", (0.0, 0.0, 1.15), (-0.95, -0.29, -0.10)),
    View("S4", (0.0, 0.0, 1.15), (-0.05, 0.99, -0.10)),
    View("S5", (0.327, -0.503, 1.15), (0.83, 0.54, -0.10)),
    View("S6", (0.686, -0.515, 1.119), (0.84, 0.53, -0.10)),
    View("S7", (-0.053, -0.645, 1.119), (0.02, 0.99, -0.10)),
    View("S8", (-0.041, -0.744, 1.119), (-0.98, -0.14, -0.10)),
    View("S9", (0.158, -0.720, 1.119), (0.30, -0.93, -0.19)),
    View("S10", (-0.023, -0.850, 1.138), (0.95, -0.24, -0.21)),
    View("S11", (-0.063, -0.859, 1.333), (-0.96, -0.20, -0.21)),
    View("S12", (-0.387, 0.9125, 1.089), (-0.86, -0.50, -0.14)),
    View("S13", (0.023, 0.622, 1.052), (-0.86, -0.51, -0.03)),
)
C0 = View("C0", (0.0, 0.0, 1.15), TABLE_8_1[0].direction)
C1 = View("C1", (-0.6, 0.6, 1.15), TABLE_8_1[0].direction)
"""The centre, and the place beside it, of Figures 7-22 to 7-24, whose captions print (−0.6, 0.6, 1.15) where
the text of 7.4.3 has (−0.6, −0.6, 1.15). No direction is printed: they look as S1 does.
"""


def pinhole(view: View, width: int, height: int) -> Pinhole:
    """The camera of a view, as methods of views take it."""
    return Pinhole.looking_at(view.eye, np.add(view.eye, view.direction), FOV_DEG, width, height)


def add_camera(scene: bpy.types.Scene, view: View) -> bpy.types.Object:
    """Add a view's camera, and make it the scene's."""
    data = bpy.data.cameras.new(view.name)
    data.sensor_fit, data.angle = "HORIZONTAL", math.radians(FOV_DEG)
    data.clip_start, data.clip_end = 1e-3, 1e3
    camera = bpy.data.objects.new(view.name, data)
    camera.location = view.eye
    camera.rotation_euler = Vector(view.direction).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera
