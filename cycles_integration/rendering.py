"""The render job: one picture of a prepared place, through a camera or as a whole panorama."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

import bpy
import cv2

from ..ibl_toolkit.images.atomic import replacing
from . import blender_images, capture, methods, roles
from .lookup import STORED_POSITION
from .place import Place, place_of

OUTPUT_SETTINGS = ("media_type", "file_format", "color_mode", "color_depth")


@dataclass(frozen=True)
class Picture:
    """What a picture is to be."""

    width: int = 960
    height: int = 540
    samples: int = 64
    seed: int = 0
    method: str = methods.CATCHER
    denoise: bool = False


def set_up_picture(scene: bpy.types.Scene, camera: bpy.types.Object, picture: Picture):
    """Set the scene up so that F12 gives the picture.

    Raises ValueError where the scene has no prepared place, or for an unknown method or a size below 4
    pixels.
    """
    if min(picture.width, picture.height) < 4 or picture.samples < 1:
        raise ValueError(
            f"picture is {picture.width} × {picture.height} at {picture.samples} samples; "
            "expected at least 4 × 4 and 1 sample"
        )
    place = place_of(scene)
    if place.irradiance is None:
        raise ValueError(f"the place of scene {scene.name!r} is not prepared: prepare it before rendering")
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = picture.width, picture.height
    scene.render.resolution_percentage = 100
    scene.render.use_compositing = True
    scene.cycles.samples, scene.cycles.seed = picture.samples, picture.seed
    scene.cycles.use_denoising = picture.denoise
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_indirect = 0
    methods.set_up(scene, place, picture.method, _plate(scene, place, camera, picture))


def render_picture(scene: bpy.types.Scene, camera: bpy.types.Object, picture: Picture, path: Path):
    """Render the picture to a float EXR: the old file stays until the new one is whole."""
    set_up_picture(scene, camera, picture)
    write_render(scene, path)


def write_render(scene: bpy.types.Scene, path: Path):
    """Render the scene as it is set up to a float EXR; its own output path and format stay."""
    with _output_kept(scene), replacing(Path(path)) as temporary:
        settings = scene.render.image_settings
        if hasattr(settings, "media_type"):  # Blender 5.0
            settings.media_type = "IMAGE"
        settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
        scene.render.filepath = str(temporary)
        bpy.ops.render.render(write_still=True, scene=scene.name)


@contextlib.contextmanager
def panorama_camera(scene: bpy.types.Scene):
    """The camera of the whole panorama, in the photograph's own frame, for as long as it is needed."""
    camera = capture.panorama_camera(place_of(scene))
    scene.collection.objects.link(camera)
    data = camera.data
    try:
        yield camera
    finally:
        bpy.data.cameras.remove(data)


def _plate(scene, place: Place, camera, picture):
    """The photograph in the picture's size, where the picture is the panorama and nothing real was moved."""
    if camera.data.type != "PANO" or any(
        STORED_POSITION in o.data.attributes for o in roles.real_objects(scene)
    ):
        return None
    if tuple(place.image.size) == (picture.width, picture.height):
        return place.image
    image = blender_images.array_from_image(place.image)
    smaller = picture.width < image.shape[1]
    size = (picture.width, picture.height)
    image = cv2.resize(image, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    place.plate = blender_images.replace_image(place.plate, "Panorama Plate", image)
    return place.plate


@contextlib.contextmanager
def _output_kept(scene):
    """Give the scene its output path and format back afterwards."""
    settings = scene.render.image_settings
    names = [name for name in OUTPUT_SETTINGS if hasattr(settings, name)]
    kept, path = [getattr(settings, name) for name in names], scene.render.filepath
    try:
        yield
    finally:
        scene.render.filepath = path
        for name, value in zip(names, kept, strict=True):
            setattr(settings, name, value)
