"""Blender's lights as a phone has them: suns and lamps without a size."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...ibl_toolkit.mobile.shadow_maps import LightCamera
from ...ibl_toolkit.mobile.shadow_scene import SceneLight
from ..picked_sun import LAMP_DIRECTION
from ..shadow_preview.casters import shown_instances
from ..shadow_preview.strength import strength_of


@dataclass(frozen=True)
class PageLight:
    """A light, and the name of where it comes from. is_picked: the artist took it from the panorama. throws:
    it throws shadows; else it only brightens."""

    name: str
    light: SceneLight
    is_picked: bool = False
    throws: bool = True

    def irradiance(self, place: np.ndarray) -> np.ndarray:
        """(3,) of a surface at a place (3,) [m] that faces the light."""
        _, (distance,) = self.light.camera.to_light(place[None])
        return np.array(self.light.strength) / max(distance, 1e-6) ** 2

    def on_faces(self, place: np.ndarray) -> np.ndarray:
        """(2, 3) irradiance at a place (3,) [m] of faces that look up and down."""
        (to_light,), _ = self.light.camera.to_light(place[None])
        return np.outer(np.maximum([to_light[2], -to_light[2]], 0), self.irradiance(place))


def own_lights(depsgraph: bpy.types.Depsgraph, points: np.ndarray) -> list[PageLight]:
    """The lights that renders show and that shine on points (n, 3) [m] which throw shadows.

    Suns that stand for the whole panorama of a place are left out. A spot counts as far as its cone has one
    of the points in it; an area light shines evenly, as strongly as it does on the points in the mean.
    """
    suns = depsgraph.scene.original.panorama_place.suns
    of_place = set(suns.objects) if suns else set()
    shown = [one.object.original for one in shown_instances(depsgraph, {"LIGHT"}) if not one.is_instance]
    lights = [(one, _light(one, depsgraph, points)) for one in shown if one not in of_place]
    return [
        PageLight(one.name, light, LAMP_DIRECTION in one, _throws(one.data))
        for one, light in lights
        if light is not None and max(light.strength) > 0
    ]


def _light(light, depsgraph, points):
    """None where it throws no light on the points."""
    strength = strength_of(light, depsgraph)
    thing = light.evaluated_get(depsgraph)
    matrix = np.array(thing.matrix_world)
    if thing.data.type == "SUN":
        return SceneLight(LightCamera.of_sun(matrix[:3, 2], points), tuple(strength))
    cosines = _cosines(points - matrix[:3, 3], -matrix[:3, 2])
    if thing.data.type == "SPOT" and cosines.max() < np.cos(thing.data.spot_size / 2):
        return None
    if thing.data.type == "AREA":
        strength = strength * np.maximum(cosines, 0).mean()
    return SceneLight(LightCamera.of_lamp(matrix[:3, 3], points), tuple(strength))


def _throws(data):
    """A preview switches the shadows off for which it stands."""
    previews = (scene.panorama_shadow_preview for scene in bpy.data.scenes)
    return data.use_shadow or any(row.light == data for preview in previews for row in preview.switched_off)


def _cosines(away, axis):
    lengths = np.linalg.norm(away, axis=1) * np.linalg.norm(axis)
    return away @ axis / np.maximum(lengths, 1e-12)
