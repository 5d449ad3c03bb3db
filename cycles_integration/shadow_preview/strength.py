"""How strong a Blender light is, so that several can be weighed against each other."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from mathutils import Matrix

from .casters import casters_of


def strength_of(light: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> np.ndarray:
    """(3,): the irradiance of a sun [W/m²], the radiant intensity of a lamp [W/sr], as Cycles has them.

    An area light's is that straight before it, a spot's that within its cone. Light that takes away light
    counts as none. Nodes of the light are left out.
    """
    thing = light.evaluated_get(depsgraph)
    return strength_at(thing.data, thing.matrix_world)


def strength_at(data: bpy.types.Light, matrix: Matrix) -> np.ndarray:
    """`strength_of` evaluated data, which an object or an instance has at a place of the world."""
    colour = np.array(data.color)
    if data.use_temperature:
        colour = colour * data.temperature_color
    solid_angle = {"SUN": 1.0, "AREA": np.pi}.get(data.type, 4 * np.pi)
    strength = colour * data.energy * 2.0**data.exposure / solid_angle
    return np.maximum(strength if data.normalize else strength * _size(data, matrix), 0.0)


def strongest_first(
    lights: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[bpy.types.Object]:
    """Lights by the irradiance that they throw towards the middle of what throws shadows."""
    points, _ = casters_of(depsgraph)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2 if len(points) else np.zeros(3)

    def darkness(light):
        squared = 1.0
        if light.data.type != "SUN":
            away = middle - np.array(light.evaluated_get(depsgraph).matrix_world.translation)
            squared = max(float(away @ away), 1e-9)
        return -strength_of(light, depsgraph).sum() / squared

    return sorted(lights, key=darkness)


def _size(data, matrix):
    """What the power of a light without Normalize is multiplied with: its area [m²], a sun's in the sky."""
    if data.type == "SUN":
        return np.pi * np.sin(data.angle / 2) ** 2 or 1.0
    if data.type != "AREA":
        return 4 * np.pi * data.shadow_soft_size**2 or 4.0  # of no size: Cycles' own convention
    across, along, _ = matrix.to_scale()
    is_long = data.shape in {"RECTANGLE", "ELLIPSE"}
    area = data.size * across * (data.size_y if is_long else data.size) * along
    return area * (np.pi / 4 if data.shape in {"DISK", "ELLIPSE"} else 1.0)
