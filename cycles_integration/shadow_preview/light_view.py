"""The shadow maps of Blender lights."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ...ibl_toolkit.mobile.shadow_maps import LightCamera, ShadowMap, ShadowSettings, reaching, shadow_map
from .casters import NOTHING_THROWS, casters_of, ground_of


def shadow_maps_of(
    lights: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph, settings: ShadowSettings
) -> list[ShadowMap]:
    """The maps of what throws shadows in the light of each object as it is evaluated.

    They cover just that, and a border as wide as the filter, so that no blur ends at the map's border. What
    lies beyond receives shadows all the same, since its depth counts as the farthest.
    Raises ValueError where nothing throws shadows, or a light is at it or in a place that is not finite.
    """
    points, triangles = casters_of(depsgraph)
    if not len(triangles):
        raise ValueError(NOTHING_THROWS)
    ground = ground_of(depsgraph) if settings.has_moments else None
    maps = []
    for light in lights:
        try:
            camera = light_camera(light, depsgraph, points).with_border(settings)
        except ValueError as error:
            raise ValueError(f"'{light.name}': {error}") from error
        if ground is not None:
            camera = reaching(camera, *ground)
        maps.append(shadow_map(points, triangles, camera, settings, ground))
    return maps


def light_camera(light, depsgraph, points: np.ndarray) -> LightCamera:
    """Where the light looks from: a sun along its beams, any other lamp from its middle to points (n, 3)."""
    matrix = np.array(light.evaluated_get(depsgraph).matrix_world)
    if light.data.type == "SUN":
        return LightCamera.of_sun(matrix[:3, 2], points)
    return LightCamera.of_lamp(matrix[:3, 3], points)
