"""The sample room as Cycles sees it: its panorama in two layers, and true views from beside its origin."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from ...cycles_integration import capture
from ...cycles_integration.view_layers import layer_collection
from ...ibl_toolkit.layers.panorama import EQUIRECTANGULAR, Layer, LayeredPanorama
from . import sizes
from .scene import BACK, FRONT, layer_collection_of
from .views import View, add_camera

FAR = 1e6
"""Cycles' depth of what no surface covers is larger [m]."""


def capture_layers(
    scene: bpy.types.Scene, width: int, samples: int | None, *, denoise: bool = True, seed: int = 0
) -> LayeredPanorama:
    """Render the room's panorama, width × width/2, in two layers: "room" and "objects".

    Each layer has what is seen of its collection with the other out of sight, yet lit, shadowed and
    mirrored by it. Radiance is the mean over a pixel, of the layer's own surfaces alone; depth is that of
    the pixel's centre, NaN where no object is. Without samples there is no radiance.

    Source: thesis, 6.3.2, Fig. 6-12.
    """
    camera = capture.new_panorama_camera(Matrix.Translation(sizes.ORIGIN))
    scene.collection.objects.link(camera)
    scene.camera = camera
    _settings(scene, (width, width // 2), seed)
    try:
        layers = tuple(
            _capture_layer(scene, name, shown, hidden, samples, denoise)
            for name, shown, hidden in (("room", BACK, FRONT), ("objects", FRONT, BACK))
        )
    finally:
        _remove_camera(camera)
    return LayeredPanorama(layers, np.eye(3), np.array(sizes.ORIGIN), sizes.RADIUS)


def render_view(
    scene: bpy.types.Scene,
    view: View,
    size: tuple[int, int],
    samples: int,
    *,
    denoise: bool = True,
    seed: int = 0,
) -> np.ndarray:
    """Render the room as a view truly sees it: (H, W, 3) of radiance, of a size (W, H) [px]."""
    camera = add_camera(scene, view)
    _settings(scene, size, seed)
    try:
        scene.cycles.samples, scene.cycles.use_denoising = samples, denoise
        picture = capture.render_passes(scene)["Combined"][..., :3]
    finally:
        _remove_camera(camera)
    return np.maximum(picture, 0)


def render_view_distance(scene: bpy.types.Scene, view: View, size: tuple[int, int]) -> np.ndarray:
    """How far the room's surfaces are in a view: (H, W) [m] along its forward axis, at pixels' centres."""
    camera = add_camera(scene, view)
    view_layer = scene.view_layers[0]
    _settings(scene, size, 0)
    view_layer.use_pass_z = True
    try:
        return _depth_of_centres(scene)
    finally:
        view_layer.use_pass_z = False
        _remove_camera(camera)


def _capture_layer(scene, name, shown, hidden, samples, denoise):
    view_layer = scene.view_layers[0]
    layer_collection(view_layer, layer_collection_of(scene, hidden)).indirect_only = True
    scene.render.film_transparent = view_layer.use_pass_z = True
    try:
        depth = _depth_of_centres(scene)
        if samples is None:
            return Layer(name, EQUIRECTANGULAR, {"depth": np.where(depth < FAR, depth, np.nan)})
        scene.cycles.samples, scene.cycles.use_denoising = samples, denoise
        picture = capture.render_passes(scene)["Combined"]
    finally:
        layer_collection(view_layer, layer_collection_of(scene, hidden)).indirect_only = False
        scene.render.film_transparent = view_layer.use_pass_z = False
    cover = picture[..., 3:]
    radiance = np.maximum(picture[..., :3], 0) / np.where(cover > 0, cover, 1)
    seen = (depth < FAR) & (cover[..., 0] > 0)
    attributes = {"radiance": radiance.astype(np.float32), "depth": np.where(seen, depth, np.nan)}
    return Layer(name, EQUIRECTANGULAR, attributes)


def _depth_of_centres(scene):
    view_layer, black = scene.view_layers[0], bpy.data.materials.new("Black")
    black.use_nodes = True
    black.node_tree.nodes.clear()
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    capture.sample_pixel_centres(scene)
    view_layer.material_override = black  # light takes most of the time, and isn't kept
    try:
        return capture.render_passes(scene)["Depth"]
    finally:
        view_layer.material_override = None
        bpy.data.materials.remove(black)
        _box_filter(scene)


def _settings(scene, size, seed):
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = *size, 100
    render.use_compositing = render.use_sequencer = False
    scene.cycles.seed = seed
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_indirect = 0
    _box_filter(scene)


def _box_filter(scene):
    """Pixels that are the mean over their own area."""
    scene.cycles.pixel_filter_type = "BOX"


def _remove_camera(camera):
    data = camera.data
    bpy.data.objects.remove(camera)
    bpy.data.cameras.remove(data)
