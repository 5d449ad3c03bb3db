"""Shadow maps as small devices have them, in numpy: the reference of every shader that draws them.

    camera = LightCamera.of_sun(direction, points)
    shadows = shadow_map(points, triangles, camera, suggested_settings(extent=3.0))
    visibility(shadows, places, normals)        0 in shadow, 1 lit

Sources: "Realistic Shadows for Mobile AR", section IV; V. Pamplona, "Shadow Mapping sem Shaders", 2009.
"""

from .ground import reaching
from .light_camera import LightCamera
from .settings import METHODS, STORAGES, ShadowSettings
from .shadow_map import ShadowMap, remaining_light, shadow_map, visibility
from .suggestion import settings_with, suggested_settings

__all__ = [
    "METHODS",
    "STORAGES",
    "LightCamera",
    "ShadowMap",
    "ShadowSettings",
    "reaching",
    "remaining_light",
    "settings_with",
    "shadow_map",
    "suggested_settings",
    "visibility",
]
