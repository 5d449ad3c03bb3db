"""From a built place to one that is ready to render: depth, lights, irradiance, materials."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..ibl_toolkit.emitters import split_bright_part
from . import blender_images, lights, lookup, maps, materials, world
from .place import Place, place_of, sort_objects

LIGHTS_WIDTH = 2048
"""Bright regions are looked for on a map of at most this width."""
IRRADIANCE_WIDTH, IRRADIANCE_SAMPLES = 512, 64


@dataclass
class Preparation:
    """What the preparation spent and found."""

    seconds: dict[str, float] = field(default_factory=dict)
    coverage: float = 0.0
    light_count: int = 0
    light_share: float = 0.0


def prepare(scene: bpy.types.Scene, most_lights: int | None = None) -> Preparation:
    """Make the maps, lights and materials of a place.

    ``most_lights``: at most so many lights are taken out of the map, the strongest; 0 for none, None for as
    many as there are. Raises ValueError where the scene has no place or no surfaces.
    """
    place = place_of(scene)
    report = Preparation()
    sort_objects(scene, place)
    depth = _timed(report, "depth", lambda: maps.render_depth(scene, place, _lights_width(place)))
    report.coverage = depth.coverage
    _timed(report, "lights", lambda: _split_lights(place, depth, most_lights, report))
    lookup.build_lookup(place)
    materials.assign(scene, place)
    world.build_world(scene, place)
    _timed(report, "irradiance", lambda: _measure_light(scene, place))
    lookup.build_lookup(place)
    return report


def _split_lights(place: Place, depth: maps.DepthMap, most_lights: int | None, report: Preparation):
    """Replace the place's lights, residual map and sky."""
    image = maps.shrink(blender_images.array_from_image(place.image), depth.depth.shape[1])
    at_depth = np.where(depth.is_support, np.inf, depth.depth)
    bright = split_bright_part(image, at_depth, most=most_lights)
    lights.replace_lights(place, bright.emitters)
    residual = bright.residual if bright.emitters else None
    place.residual = blender_images.replace_image(place.residual, "Panorama Residual", residual)
    sky = None if np.isfinite(depth.depth).all() else np.where(np.isfinite(depth.depth)[..., None], 0, image)
    place.sky = blender_images.replace_image(place.sky, "Panorama Sky", sky)
    report.light_count, report.light_share = len(bright.emitters), bright.share


def _measure_light(scene, place):
    """Replace the place's irradiance and gloss maps."""
    width = min(IRRADIANCE_WIDTH, place.image.size[0])
    irradiance = maps.render_irradiance(scene, place, width, IRRADIANCE_SAMPLES)
    gloss = maps.render_gloss(scene, place, width, IRRADIANCE_SAMPLES)
    place.irradiance = blender_images.replace_image(place.irradiance, "Panorama Irradiance", irradiance)
    place.gloss = blender_images.replace_image(place.gloss, "Panorama Gloss", gloss)


def _lights_width(place):
    return min(LIGHTS_WIDTH, place.image.size[0])


def _timed(report, name, step):
    start = time.perf_counter()
    result = step()
    report.seconds[name] = time.perf_counter() - start
    return result
