"""All that a page of a phone's shadows shows of a Blender scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy

from ...ibl_toolkit.layers.views.pinhole import Pinhole
from ...ibl_toolkit.mobile.shadow_maps import ShadowSettings, reaching
from ...ibl_toolkit.mobile.shadow_maps.shadow_map import warnings_of
from ...ibl_toolkit.mobile.shadow_scene import MOST_LIGHTS, ShadowScene
from ...ibl_toolkit.mobile.web_page import Background
from ..place import place_in
from ..shadow_preview.casters import NOTHING_THROWS
from .camera import background_of, camera_of
from .lighting import lighting_of
from .meshes import joined, meshes_of


@dataclass(frozen=True, eq=False)
class PageScene:
    """What a page is written of. light_names: where each light comes from. warnings: a sentence each."""

    scene: ShadowScene
    camera: Pinhole
    background: Background
    light_names: tuple[str, ...]
    warnings: tuple[str, ...]


def page_scene(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    kinds: Sequence[ShadowSettings],
    light_from: str = "auto",
    most: int = MOST_LIGHTS,
    camera_name: str | None = None,
    exposure: float | None = None,
) -> PageScene:
    """The scene as it is evaluated, for a page with some kinds of shadow map.

    light_from: of LIGHT_FROM. most: lights, 1 to MOST_LIGHTS. exposure: factor from radiance to the screen,
    by default as bright as the 3D View shows it.

    Raises: ValueError that says why where nothing throws a shadow, no light or no camera is there, or the
    camera is one that the page does not have.
    """
    meshes, warnings = meshes_of(depsgraph)
    throwing = [mesh for mesh in meshes if mesh.throws]
    if not throwing:
        raise ValueError(NOTHING_THROWS)
    if all(mesh.is_new for mesh in meshes):
        warnings.append("nothing has the role Support: only new things receive the shadows")
    points, triangles = joined(throwing)
    camera = camera_of(scene, depsgraph, points, camera_name)
    background, camera, amiss = background_of(scene, camera, camera_name, exposure)
    panorama = background if background.kind == "panorama" and place_in(scene) else None
    lights, ambient, amiss_of_lights = lighting_of(scene, depsgraph, panorama, meshes, light_from, most)
    softest = max(kinds, key=lambda kind: (kind.method != "hard") * kind.window / kind.resolution)
    ground = joined([mesh for mesh in meshes if mesh.is_ground])
    cameras = [one.light.camera.with_border(softest) for one in lights]
    if any(kind.has_moments for kind in kinds):
        cameras = [reaching(view, *ground) for view in cameras]
    amiss_of_maps = [
        f"'{one.name}': {text}"
        for one, view in zip(lights, cameras, strict=True)
        for text in warnings_of(points, triangles, view)
    ]
    return PageScene(
        ShadowScene(
            meshes,
            [replace(one.light, camera=view) for one, view in zip(lights, cameras, strict=True)],
            *map(tuple, ambient),
        ),
        camera,
        background,
        tuple(one.name for one in lights),
        (*warnings, *amiss, *amiss_of_lights, *amiss_of_maps),
    )
