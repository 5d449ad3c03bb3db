"""Pictures that the program takes for itself: renders of the place in a scene of their own.

The artist's scene is left alone: a temporary scene links the place's surfaces and lights, renders one
multilayer EXR, and is removed with all that it made.
"""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenEXR
from mathutils import Euler, Matrix

from . import roles
from .place import Place

EQUIRECTANGULAR_FROM_CAMERA = Euler((math.pi / 2, 0, -math.pi / 2)).to_matrix().to_4x4()
"""Blender's panoramic camera looks along its −z with +y up; so turned it looks along +x with +z up."""
NAMES_BEFORE_5 = {"IndexOB": "Object Index"}
"""Passes whose name changed in Blender 5.0."""
STRIP_PIXELS = 2**25
"""A render of a map takes some 90 bytes per pixel, most of which it gives back: larger ones go in strips."""
POINT_FILTER = 0.01
"""A pixel filter this narrow [px] puts every sample on the pixel's centre."""


@contextlib.contextmanager
def temporary_scene(place: Place, width: int, samples: int, *, with_lamps: bool = True):
    """A Cycles scene of the place's surfaces and their lamps, seen by a panoramic camera at its origin.

    Its image is width × width/2 and lies in the panorama's own frame, like the photograph. Background, film,
    filter and passes are the caller's to set.
    """
    scene = bpy.data.scenes.new("Panorama Capture")
    camera = panorama_camera(place)
    try:
        for thing in place.surfaces.all_objects:
            if with_lamps or roles.LAMP not in thing:
                scene.collection.objects.link(thing)
        scene.collection.objects.link(camera)
        scene.camera = camera
        render = scene.render
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
        render.use_compositing = render.use_sequencer = False
        scene.cycles.samples = samples
        scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
        scene.cycles.sample_clamp_indirect = 0
        yield scene
    finally:
        data = camera.data
        bpy.data.scenes.remove(scene)
        bpy.data.cameras.remove(data)


def panorama_camera(place: Place) -> bpy.types.Object:
    """A new equirectangular camera at the place's origin, whose image lies in the panorama's frame."""
    return new_panorama_camera(place.origin.matrix_world)


def new_panorama_camera(world_from_panorama: Matrix) -> bpy.types.Object:
    """A new equirectangular camera at the origin of a frame (4, 4)."""
    data = bpy.data.cameras.new("Panorama Camera")
    data.type = "PANO"
    panoramic = data if hasattr(data, "panorama_type") else data.cycles  # moved to the camera in Blender 5.0
    panoramic.panorama_type = "EQUIRECTANGULAR"
    data.clip_start, data.clip_end = 1e-3, 1e6
    camera = bpy.data.objects.new(data.name, data)
    camera.matrix_world = world_from_panorama @ EQUIRECTANGULAR_FROM_CAMERA
    return camera


def sample_pixel_centres(scene: bpy.types.Scene):
    """Make every pixel show its centre alone, as the photograph's pixels are looked up."""
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.cycles.filter_width = POINT_FILTER


def render_in_strips(scene: bpy.types.Scene, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Render and return these passes as `render_passes` does, a large image in strips to spare memory."""
    render = scene.render
    count = 1  # a power of two, so that strips that adjoin agree on the row
    while render.resolution_x * render.resolution_y > count * STRIP_PIXELS:
        count *= 2
    render.use_border = render.use_crop_to_border = count > 1
    strips = []
    for number in reversed(range(count)):  # from the top; Blender counts from the bottom
        render.border_min_y, render.border_max_y = number / count, (number + 1) / count
        passes = render_passes(scene)
        strips.append({name: passes[name] for name in names})
    return {name: np.concatenate([strip[name] for strip in strips]) for name in names}


def render_passes(scene: bpy.types.Scene) -> dict[str, np.ndarray]:
    """Render and return the view layer's passes by name: (H, W) or (H, W, C) float32, top row first."""
    by_layer = render_view_layers(scene)
    return {name: pixels for passes in by_layer.values() for name, pixels in passes.items()}


def render_view_layers(scene: bpy.types.Scene) -> dict[str, dict[str, np.ndarray]]:
    """Render all view layers in one job and return the passes of each, as of `render_passes`.

    Names of layers must not have a full stop in them.
    """
    with tempfile.TemporaryDirectory() as folder:
        settings = scene.render.image_settings
        if hasattr(settings, "media_type"):  # Blender 5.0
            settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
        settings.exr_codec = "NONE"
        scene.render.filepath = str(Path(folder) / "capture.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        parts = OpenEXR.File(scene.render.filepath).parts  # one part per pass from Blender 5.0
        channels = {name: channel.pixels for part in parts for name, channel in part.channels.items()}
    by_layer = {}
    for path, pixels in channels.items():
        layer, name = path.split(".")[:2]
        by_layer.setdefault(layer, {})[NAMES_BEFORE_5.get(name, name)] = pixels
    return by_layer
