"""The maps of a place in the panorama's own frame: depth, irradiance, and the support's gloss (Fig. 5-1)."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import cv2
import numpy as np

from . import capture, lookup, materials, roles
from .place import Place

FAR = 1e9
"""Cycles writes 1e10 where a ray meets nothing."""
SUPPORT_INDEX = 1


@dataclass(frozen=True)
class DepthMap:
    """Ray distances (H, W) [m] from the origin, +inf where nothing is, and where the support is seen."""

    depth: np.ndarray
    is_support: np.ndarray

    @property
    def coverage(self) -> float:
        """Share of the sphere that has depth."""
        height = len(self.depth)
        rows = np.sin((np.arange(height) + 0.5) / height * np.pi)
        return float(rows @ np.isfinite(self.depth).mean(axis=1) / rows.sum())


def render_depth(scene: bpy.types.Scene, place: Place, width: int) -> DepthMap:
    """Render the ray distance of the real surfaces at every pixel's centre (width × width/2).

    Synthetic objects are not in it. Raises ValueError where the place has no surface at all.
    """
    real = roles.real_objects(scene)
    if not real:
        raise ValueError(
            "the place has no surfaces: build shapes, or give objects the role SUPPORT or ENVIRONMENT"
        )
    with capture.temporary_scene(place, width, samples=1, with_lamps=False) as taken:
        capture.sample_pixel_centres(taken)
        taken.world = None
        layer = taken.view_layers[0]
        layer.use_pass_z = layer.use_pass_object_index = True
        for thing in real:
            thing.pass_index = SUPPORT_INDEX if thing.panorama_role == roles.SUPPORT else 0
        layer.material_override = materials.black_material(place)
        passes = capture.render_in_strips(taken, ("Depth", "Object Index"))
    depth = np.where(passes["Depth"] < FAR, passes["Depth"], np.inf).astype(np.float32)
    return DepthMap(depth, np.isfinite(depth) & (passes["Object Index"] == SUPPORT_INDEX))


def render_irradiance(scene: bpy.types.Scene, place: Place, width: int, samples: int) -> np.ndarray:
    """Render E/π (H, W, 3) that the place throws on each of its own visible surfaces (section 5.6.3.1).

    Every real surface is white and diffuse where the camera sees it and emits the photograph to all other
    rays, so light that bounces between real surfaces is in it. Denoised: it varies slowly.
    """
    lookup.build_lookup(place)
    return _render_light(scene, place, width, samples, materials.irradiance_material(place))


def render_gloss(scene: bpy.types.Scene, place: Place, width: int, samples: int) -> np.ndarray | None:
    """Render the reflection (H, W, 3) that the panorama saw in glossy supports; None where none is glossy."""
    if not any(thing.panorama_reflectivity > 0 for thing in roles.with_role(scene, roles.SUPPORT)):
        return None
    return _render_light(scene, place, width, samples, materials.gloss_material(place))


def shrink(image: np.ndarray, width: int) -> np.ndarray:
    """Average (H, W, C) down to a width, or leave it where it is no wider."""
    if image.shape[1] <= width:
        return image
    return cv2.resize(image, (width, width // 2), interpolation=cv2.INTER_AREA)


def _render_light(scene, place, width, samples, material):
    with capture.temporary_scene(place, width, samples) as taken:
        taken.world = scene.world
        taken.cycles.use_denoising = True
        taken.cycles.max_bounces = taken.cycles.diffuse_bounces = taken.cycles.glossy_bounces = 1
        material.cycles.emission_sampling = "NONE" if place.lights.objects else "AUTO"
        with materials.worn_by(roles.real_objects(scene), material):
            return capture.render_passes(taken)["Combined"][..., :3]
