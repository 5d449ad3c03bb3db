"""Blender's lights as a phone has them: suns and lamps without a size."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...ibl_toolkit.mobile.shadow_maps import LightCamera
from ...ibl_toolkit.mobile.shadow_scene import SceneLight
from ..picked_sun import LAMP_DIRECTION
from ..shadow_preview.casters import shown_instances
from ..shadow_preview.strength import strength_at


@dataclass(frozen=True)
class PageLight:
    """A light, and the name of where it comes from. is_picked: the artist took it from the panorama. throws:
    it throws shadows; else it only brightens."""

    name: str
    light: SceneLight
    is_picked: bool = False
    throws: bool = True

    def irradiance(self, place: np.ndarray) -> np.ndarray:
        """(3,) [W/m²] of a surface at a place (3,) [m] that faces the light."""
        _, (distance,) = self.light.camera.to_light(place[None])
        return np.array(self.light.strength) / max(distance, 1e-6) ** 2

    def on_faces(self, place: np.ndarray) -> np.ndarray:
        """(2, 3) irradiance [W/m²] at a place (3,) [m] of faces that look up and down."""
        (to_light,), _ = self.light.camera.to_light(place[None])
        return np.outer(np.maximum([to_light[2], -to_light[2]], 0), self.irradiance(place))


def own_lights(depsgraph: bpy.types.Depsgraph, points: np.ndarray, triangles: np.ndarray) -> list[PageLight]:
    """The lights that renders show and that shine on points (n, 3) [m] of triangles (T, 3), which throw
    shadows; those of instanced collections, too.

    Suns that stand for the whole panorama of a place are left out. A spot counts if its cone has one of the
    points in it, or its middle meets a triangle; an area light shines evenly, as strongly as it does on the
    points in the mean.
    """
    suns = depsgraph.scene.original.panorama_place.suns
    of_place = set(suns.objects) if suns else set()
    found = []
    for instance in shown_instances(depsgraph, {"LIGHT"}):
        own = instance.object.original
        if own in of_place:
            continue
        light = _light(instance.object.data, instance.matrix_world, points, triangles)
        if light is not None and max(light.strength) > 0:
            found.append(PageLight(own.name, light, LAMP_DIRECTION in own, _throws(own.data)))
    return found


def _light(data, world_from_light, points, triangles):
    """None where it throws no light on the points."""
    strength = strength_at(data, world_from_light)
    matrix = np.array(world_from_light)
    eye, forward = matrix[:3, 3], -matrix[:3, 2]
    if data.type == "SUN":
        return SceneLight(LightCamera.of_sun(-forward, points), tuple(strength))
    cosines = _cosines(points - eye, forward)
    if data.type == "SPOT" and cosines.max() < np.cos(data.spot_size / 2):
        things = BVHTree.FromPolygons(points.tolist(), triangles.tolist())
        if things.ray_cast(Vector(eye), Vector(forward))[0] is None:
            return None
    if data.type == "AREA":
        strength = strength * np.maximum(cosines, 0).mean()
    return SceneLight(LightCamera.of_lamp(eye, points), tuple(strength))


def _throws(data):
    """A preview switches the shadows off for which it stands."""
    previews = (scene.panorama_shadow_preview for scene in bpy.data.scenes)
    return data.use_shadow or any(row.light == data for preview in previews for row in preview.switched_off)


def _cosines(away, axis):
    lengths = np.linalg.norm(away, axis=1) * np.linalg.norm(axis)
    return away @ axis / np.maximum(lengths, 1e-12)
