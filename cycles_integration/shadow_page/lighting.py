"""Which lights a page has, and its light from all around: of the scene, of its panorama, or of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...ibl_toolkit.light.light_map import LUMINANCE
from ...ibl_toolkit.mobile.device_lights import device_lights, floor_irradiance
from ...ibl_toolkit.mobile.shadow_scene import SceneMesh
from ...ibl_toolkit.mobile.web_page import Background
from .. import maps
from .camera import world_colour
from .lights import PageLight, own_lights
from .meshes import joined

LIGHTS_WIDTH = 1024
"""A panorama's lights are looked for on a map of at most this width [px]."""


def lighting_of(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    panorama: Background | None,
    meshes: Sequence[SceneMesh],
    light_from: str,
    most: int,
) -> tuple[list[PageLight], np.ndarray, list[str]]:
    """The strongest lights on what throws shadows, ``most`` at most; ambient light (2, 3) [W/m²] of faces
    that look up and down; warnings.

    panorama: that of the scene's place. light_from: of LIGHT_FROM. Lights that there are too many of, and
    those that throw no shadows, brighten the ambient light. A sun that was picked from the panorama stands
    for its part of it.

    Raises ValueError without any light, and for a panorama's without one.
    """
    points, triangles = joined([mesh for mesh in meshes if mesh.throws])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    own = own_lights(depsgraph, points, triangles)
    if light_from == "auto":
        light_from = "scene" if panorama is None or any(one.throws for one in own) else "panorama"
    if light_from != "scene" and panorama is None:
        raise ValueError(f"scene '{scene.name}' has no panorama whose lights could be taken")
    if light_from == "scene":
        found, (ambient, warnings) = own, _ambient(scene, panorama, own, middle)
    else:
        found, ambient, warnings = _of_panorama(panorama, points, meshes, most, middle)
    if light_from == "both":
        found += [one for one in own if not one.is_picked]
    throwing = _strongest_first([one for one in found if one.throws], middle)
    if not throwing:
        raise ValueError("no light shines on what throws shadows: add one, or show it in renders")
    if throwing[most:]:
        names = ", ".join(f"'{one.name}'" for one in throwing[most:])
        warnings = [*warnings, f"{names}: only brighten and throw no shadow, for there are more than {most}"]
    left = throwing[most:] + [one for one in found if not one.throws]
    return throwing[:most], ambient + sum((one.on_faces(middle) for one in left), np.zeros((2, 3))), warnings


def _of_panorama(panorama, points, meshes, most, middle):
    found = device_lights(
        maps.shrink(panorama.image, LIGHTS_WIDTH),
        points,
        most,
        panorama.origin,
        panorama.world_from_panorama,
        _reach(panorama, [mesh for mesh in meshes if not mesh.is_new]),
    )
    lights = _strongest_first([PageLight("panorama", light) for light in found.lights], middle)
    lights = [replace(one, name=f"{one.name} {k}") for k, one in enumerate(lights, 1)]
    return lights, np.array([found.ambient, found.ambient_down]), list(found.warnings)


def _reach(panorama, surfaces):
    """Distances (n,) [m] of the real surfaces in directions (n, 3) of a panorama; None without surfaces."""
    if not surfaces:
        return None
    trees = [BVHTree.FromPolygons(one.points.tolist(), one.triangles.tolist()) for one in surfaces]
    origin = Vector(panorama.origin)

    def distance(direction):
        hits = (tree.ray_cast(origin, Vector(direction))[3] for tree in trees)
        return min((hit for hit in hits if hit is not None), default=np.inf)

    return lambda directions: np.array([distance(one) for one in directions @ panorama.world_from_panorama.T])


def _ambient(scene, panorama, own, middle):
    """Irradiance (2, 3) [W/m²] of faces that look up and down besides the scene's lights, and warnings."""
    if panorama is None:
        colour, warnings = world_colour(scene)
        return np.tile(np.zeros(3) if colour is None else np.pi * colour, (2, 1)), warnings
    image, up = maps.shrink(panorama.image, LIGHTS_WIDTH), panorama.world_from_panorama[2]
    whole = np.array([floor_irradiance(image, way) for way in (up, -up)])
    picked = sum((one.on_faces(middle) for one in own if one.is_picked), np.zeros((2, 3)))
    return np.maximum(whole - picked, 0), []


def _strongest_first(lights, place):
    return sorted(lights, key=lambda one: -float(one.irradiance(place) @ LUMINANCE))
