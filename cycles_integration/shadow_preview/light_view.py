"""The shadow map of a Blender light."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np

from ...ibl_toolkit.mobile.shadow_maps import LightCamera, ShadowMap, ShadowSettings, shadow_map
from ...ibl_toolkit.mobile.shadow_maps.light_camera import WIDEST
from .casters import casters_of


def shadow_map_of(
    light: bpy.types.Object, depsgraph: bpy.types.Depsgraph, settings: ShadowSettings
) -> ShadowMap:
    """The map of what throws shadows in the light of an object as it is evaluated.

    Raises ValueError where nothing throws shadows, or the light is at it or in a place that is not finite.
    """
    points, triangles = casters_of(depsgraph)
    if not len(triangles):
        raise ValueError(
            "nothing throws a shadow: there is no object of the role Synthetic that renders show and whose "
            "ray visibility includes shadows"
        )
    return shadow_map(points, triangles, light_camera(light, depsgraph, points, settings), settings)


def light_camera(light, depsgraph, points: np.ndarray, settings: ShadowSettings) -> LightCamera:
    """Where the light looks from: a sun along its beams, any other lamp from its middle to points (n, 3).

    It covers just these, and a border as wide as the filter, so that no blur ends at the map's border. What
    lies beyond them receives shadows all the same, since its depth counts as the farthest.
    """
    matrix = np.array(light.evaluated_get(depsgraph).matrix_world)
    if light.data.type == "SUN":
        camera = LightCamera.of_sun(matrix[:3, 2], points)
        most = np.inf
    else:
        camera, most = LightCamera.of_lamp(matrix[:3, 3], points), WIDEST
    border = settings.window if settings.method != "hard" else 0
    wider = settings.resolution / max(settings.resolution - 2 * border, settings.resolution / 2)
    return replace(
        camera,
        half_width=min(camera.half_width * wider, most),
        half_height=min(camera.half_height * wider, most),
    )
