"""What is rendered for layers: a copy of the artist's scene, seen by a panoramic camera."""

from __future__ import annotations

import contextlib
import math

import bpy
from mathutils import Matrix

from . import capture, view_layers
from .place import place_in


def frame_of(scene: bpy.types.Scene, origin: tuple[float, float, float] | None = None) -> Matrix:
    """The frame (4, 4) world_from_panorama of a scene's layers.

    That of the scene's place; without one, or with an origin (3,) [m], level: its +x is the world's. Without
    an origin it is where the active camera stands.

    Raises: ValueError for a scene with neither, or an origin that is not finite.
    """
    if origin is not None:
        if not all(map(math.isfinite, origin)):
            raise ValueError(f"origin {tuple(origin)} must be three finite numbers")
        return Matrix.Translation(origin)
    scene.view_layers[0].update()
    place = place_in(scene)
    if place is not None:
        return place.origin.matrix_world.copy()
    if scene.camera is None:
        raise ValueError(f"scene '{scene.name}' has no active camera: give the origin")
    return Matrix.Translation(scene.camera.matrix_world.translation)


@contextlib.contextmanager
def rendered_scene(scene: bpy.types.Scene, world_from_panorama: Matrix):
    """A copy of a scene with a panoramic camera at a frame's (4, 4) origin, all passes at pixel centres.

    It has the scene's own objects, light and settings of light paths, and one view layer: what its first
    layer that renders shows, or of a scene with a place the place and what stands in it. Both the copy and
    its camera are removed afterwards.
    """
    copied = scene.copy()
    copied.name = "Panorama Layers"
    camera = capture.new_panorama_camera(world_from_panorama)
    try:
        copied.collection.objects.link(camera)
        copied.camera = camera
        _set_up_layer(copied)
        _set_up_render(copied)
        yield copied
    finally:
        data = camera.data
        bpy.data.scenes.remove(copied)
        bpy.data.cameras.remove(data)


def _set_up_layer(copied):
    place = place_in(copied)
    if place is not None:
        view_layers.remove_ours(copied)
        for layer in copied.view_layers:
            view_layers.layer_collection(layer, place.catchers).exclude = True
    shown = next((layer for layer in copied.view_layers if layer.use), copied.view_layers[0])
    for layer in list(copied.view_layers):
        if layer != shown:
            copied.view_layers.remove(layer)
    shown.use = True
    shown.name = "Layer"
    shown.samples = 0
    shown.use_pass_z = True


def _set_up_render(copied):
    render = copied.render
    render.engine = "CYCLES"
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1
    render.use_border = render.use_multiview = render.use_motion_blur = render.use_freestyle = False
    render.use_compositing = render.use_sequencer = render.film_transparent = False
    render.use_persistent_data = False  # rays would begin where those of the surface before did
    cycles = copied.cycles
    cycles.film_exposure = 1
    cycles.use_adaptive_sampling = False
    cycles.transparent_max_bounces += 1  # the camera's box is one
    cycles.texture_limit_render = "OFF"  # it would shrink the map of distances
    capture.sample_pixel_centres(copied)
