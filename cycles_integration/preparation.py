"""From a built place to one that is ready to render: depth, lights, irradiance, materials."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..ibl_toolkit.light.extraction_warnings import warnings_of_map
from ..ibl_toolkit.light.lamps import split_into_lamps
from . import blender_images, lamps, lookup, maps, materials, suns, view_layers, world
from .place import Place, place_of, sort_objects

LIGHTS_WIDTH = 2048
"""Bright regions are looked for on a map of at most this width."""
IRRADIANCE_WIDTH, IRRADIANCE_SAMPLES = 512, 64


@dataclass(frozen=True)
class Lights:
    """Lights that were taken out of a map: how many, with which share of its light, and why."""

    count: int = 0
    share: float = 0.0
    reason: str = ""


@dataclass
class Preparation:
    """What the preparation spent and found."""

    seconds: dict[str, float] = field(default_factory=dict)
    coverage: float = 0.0
    at_depth: Lights = field(default_factory=Lights)
    """Lamps on the surfaces."""
    at_infinity: Lights = field(default_factory=Lights)
    """Suns, for the method that lights from infinity alone."""
    warnings: tuple[str, ...] = ()
    """What is suspicious in the map's light, one sentence each."""


def prepare(scene: bpy.types.Scene, most_lights: int | None = None) -> Preparation:
    """Make the maps, lights and materials of a place.

    ``most_lights``: at most so many lights are taken out of the map, the strongest; 0 for none; None lets the
    map decide. Raises ValueError where the scene has no place or no surfaces.
    """
    place = place_of(scene)
    report = Preparation()
    sort_objects(scene, place)
    depth = _timed(report, "depth", lambda: maps.render_depth(scene, place, _lights_width(place)))
    report.coverage = depth.coverage
    _timed(report, "lights", lambda: _split_lights(scene, place, depth, most_lights, report))
    lookup.build_lookup(place)
    materials.assign(scene, place)
    world.build_world(scene, place)
    view_layers.show_suns(scene, place, False)
    _timed(report, "irradiance", lambda: _measure_light(scene, place))
    lookup.build_lookup(place)
    return report


def prepare_suns(scene: bpy.types.Scene, place: Place, most_lights: int | None = None) -> Lights:
    """Light the scene from infinity: suns of the whole map, and a World of what they leave of it.

    ``most_lights`` as in `prepare`. A place without surfaces will do.
    """
    split = suns.replace_suns(place, _light_map(place, _lights_width(place)), most_lights)
    world.build_world(scene, place, whole_map_lights=True)
    view_layers.show_suns(scene, place, True)
    left_alone = "without its lamps this map would not be quiet: left to Cycles' own sampling"
    return _lights(split.discs, "sun", split.share, most_lights, left_alone)


def _split_lights(scene, place: Place, depth: maps.DepthMap, most_lights: int | None, report: Preparation):
    """Replace the place's lamps and suns, what they leave of the map, and the sky."""
    image = _light_map(place, depth.depth.shape[1])
    at_depth = np.where(depth.is_support, np.inf, depth.depth)
    split = split_into_lamps(image, at_depth, most_lights)
    lookup.build_lookup(place)  # the lamps' materials use it
    lamps.replace_lamps(place, split.lamps)
    quiet = split.quiet if split.lamps else None
    place.residual = blender_images.replace_image(place.residual, "Panorama Residual", quiet)
    sky = None if np.isfinite(depth.depth).all() else np.where(np.isfinite(depth.depth)[..., None], 0, image)
    place.sky = blender_images.replace_image(place.sky, "Panorama Sky", sky)
    left_alone = "no surface stands out of this map: left alone"
    report.at_depth = _lights(split.lamps, "lamp", split.share, most_lights, left_alone)
    report.at_infinity = prepare_suns(scene, place, most_lights)
    report.warnings = warnings_of_map(image)


def _light_map(place, width):
    """The photograph at a width, without the radiance below zero that denoisers and resizers leave."""
    return np.maximum(maps.shrink(blender_images.array_from_image(place.image), width), 0)


def _lights(found, thing, share, most_lights, left_alone) -> Lights:
    """What was found, with the reason in one sentence."""
    plural = "" if len(found) == 1 else "s"
    reason = f"{len(found)} {thing}{plural} with {100 * share:.0f} % of the light" if found else left_alone
    return Lights(len(found), share, "no lights, as asked" if most_lights == 0 else reason)


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
