"""From a built place to one that is ready to render: depth, lights, irradiance, materials.

In two halves, since the first takes seconds to minutes: what is measured is arrays and numbers without any
Blender data, so that another process can do it on a copy of the file; to apply it renders nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..ibl_toolkit.light.discs import DiscSplit
from ..ibl_toolkit.light.extraction_warnings import warnings_of_map
from ..ibl_toolkit.light.lamps import LampSplit, split_into_lamps
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


@dataclass(frozen=True)
class MeasuredSuns:
    """The suns of a map, and what they leave of it."""

    split: DiscSplit
    lights: Lights


@dataclass(frozen=True)
class MeasuredLamps:
    """The lamps of a map, what they leave of it, and the part of it that lies at infinity."""

    split: LampSplit
    sky: np.ndarray | None
    """(H, W, 3), black where there is depth; None where there is depth everywhere."""
    suns: MeasuredSuns


@dataclass(frozen=True)
class MeasuredLight:
    """All that is measured of a place."""

    lamps: MeasuredLamps
    irradiance: np.ndarray
    """(h, w, 3) E/π."""
    gloss: np.ndarray | None
    """(h, w, 3); None where no support is glossy."""
    report: Preparation


def prepare(scene: bpy.types.Scene, most_lights: int | None = None) -> Preparation:
    """Make the maps, lights and materials of a place: what `measure` and `apply` do, in one go.

    ``most_lights``: at most so many lights are taken out of the map, the strongest; 0 for none; None lets the
    map decide. Raises ValueError where the scene has no place or no surfaces.
    """
    measured = measure(scene, most_lights)  # which has put the lamps into the scene already
    _put_maps(place_of(scene), measured)
    return measured.report


def measure(
    scene: bpy.types.Scene, most_lights: int | None = None, tell: Callable[[str], None] = lambda step: None
) -> MeasuredLight:
    """Measure the light of a place by renders, for `apply`; ``tell`` hears the name of each step first.

    The scene ends half prepared, since its irradiance is that of the lamps found: do it on a copy, or apply
    the result. ``most_lights`` and errors as in `prepare`.
    """
    place = place_of(scene)
    report = Preparation()

    def timed(name, step):
        tell(name)
        start = time.perf_counter()
        result = step()
        report.seconds[name] = time.perf_counter() - start
        return result

    sort_objects(scene, place)
    depth = timed("depth", lambda: maps.render_depth(scene, place, _lights_width(place)))
    report.coverage = depth.coverage
    found = timed("lights", lambda: _measure_lamps(place, depth, most_lights, report))
    _put_lamps(scene, place, found)
    irradiance, gloss = timed("irradiance", lambda: _measure_maps(scene, place))
    return MeasuredLight(found, irradiance, gloss, report)


def apply(scene: bpy.types.Scene, measured: MeasuredLight) -> Preparation:
    """Give a place what was measured of it, or of a copy of it. Raises ValueError where there is no place."""
    place = place_of(scene)
    sort_objects(scene, place)
    _put_lamps(scene, place, measured.lamps)
    _put_maps(place, measured)
    return measured.report


def prepare_suns(scene: bpy.types.Scene, place: Place, most_lights: int | None = None) -> Lights:
    """Light the scene from infinity: suns of the whole map, and a World of what they leave of it.

    ``most_lights`` as in `prepare`. A place without surfaces will do.
    """
    return apply_suns(scene, place, measure_suns(place, most_lights))


def measure_suns(place: Place, most_lights: int | None = None) -> MeasuredSuns:
    """The first half of `prepare_suns`."""
    split = suns.split_map(_light_map(place, _lights_width(place)), most_lights)
    left_alone = "without its lamps this map would not be quiet: left to Cycles' own sampling"
    return MeasuredSuns(split, _lights(split.discs, "sun", split.share, most_lights, left_alone))


def apply_suns(scene: bpy.types.Scene, place: Place, measured: MeasuredSuns) -> Lights:
    """The second half of `prepare_suns`."""
    suns.replace_suns(place, measured.split)
    world.build_world(scene, place, whole_map_lights=True)
    view_layers.show_suns(scene, place, True)
    return measured.lights


def _measure_lamps(place, depth: maps.DepthMap, most_lights: int | None, report: Preparation):
    """The lamps and suns of the map, what they leave of it, and the sky."""
    image = _light_map(place, depth.depth.shape[1])
    at_depth = np.where(depth.is_support, np.inf, depth.depth)
    split = split_into_lamps(image, at_depth, most_lights)
    sky = None if np.isfinite(depth.depth).all() else np.where(np.isfinite(depth.depth)[..., None], 0, image)
    left_alone = "no surface stands out of this map: left alone"
    report.at_depth = _lights(split.lamps, "lamp", split.share, most_lights, left_alone)
    found = MeasuredLamps(split, sky, measure_suns(place, most_lights))
    report.at_infinity = found.suns.lights
    report.warnings = warnings_of_map(image)
    return found


def _measure_maps(scene, place):
    """The irradiance and gloss of the place as it is lit now."""
    width = min(IRRADIANCE_WIDTH, place.image.size[0])
    irradiance = maps.render_irradiance(scene, place, width, IRRADIANCE_SAMPLES)
    return irradiance, maps.render_gloss(scene, place, width, IRRADIANCE_SAMPLES)


def _put_lamps(scene, place, found: MeasuredLamps):
    """Replace the place's lamps and suns, what they leave of the map, and the sky; light it by them."""
    lookup.build_lookup(place)  # the lamps' materials use it
    lamps.replace_lamps(place, found.split.lamps)
    quiet = found.split.quiet if found.split.lamps else None
    place.residual = blender_images.replace_image(place.residual, "Panorama Residual", quiet)
    place.sky = blender_images.replace_image(place.sky, "Panorama Sky", found.sky)
    suns.replace_suns(place, found.suns.split)
    lookup.build_lookup(place)
    materials.assign(scene, place)
    world.build_world(scene, place)
    view_layers.show_suns(scene, place, False)


def _put_maps(place, measured: MeasuredLight):
    """Replace the place's irradiance and gloss maps."""
    irradiance, gloss = measured.irradiance, measured.gloss
    place.irradiance = blender_images.replace_image(place.irradiance, "Panorama Irradiance", irradiance)
    place.gloss = blender_images.replace_image(place.gloss, "Panorama Gloss", gloss)
    lookup.build_lookup(place)


def _light_map(place, width):
    """The photograph at a width, without the radiance below zero that denoisers and resizers leave."""
    return np.maximum(maps.shrink(blender_images.array_from_image(place.image), width), 0)


def _lights(found, thing, share, most_lights, left_alone) -> Lights:
    """What was found, with the reason in one sentence."""
    plural = "" if len(found) == 1 else "s"
    reason = f"{len(found)} {thing}{plural} with {100 * share:.0f} % of the light" if found else left_alone
    return Lights(len(found), share, "no lights, as asked" if most_lights == 0 else reason)


def _lights_width(place):
    return min(LIGHTS_WIDTH, place.image.size[0])
