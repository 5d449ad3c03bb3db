"""numpy arrays as Blender images, kept inside the .blend."""

from __future__ import annotations

import bpy
import numpy as np

LINEAR = "Linear Rec.709"


def image_from_array(name: str, array: np.ndarray) -> bpy.types.Image:
    """Store (H, W, 3) linear Rec. 709 radiance, top row first, as a packed float image."""
    height, width, _ = array.shape
    image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=True)
    image.colorspace_settings.name = LINEAR
    image.alpha_mode = "NONE"
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = array[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def replace_image(old: bpy.types.Image | None, name: str, array: np.ndarray | None) -> bpy.types.Image | None:
    """Drop ``old``, unless another scene uses it too, and store ``array`` in its stead, if there is one."""
    if old is not None:
        users = bpy.data.user_map(subset={old})[old]
        if sum(isinstance(user, bpy.types.Scene) for user in users) < 2:  # else a copy of the scene has it
            bpy.data.images.remove(old)
    return None if array is None else image_from_array(name, array)


def load_radiance(path: str) -> bpy.types.Image:
    """Load an HDR file as linear Rec. 709 radiance, once per .blend."""
    image = bpy.data.images.load(path, check_existing=True)
    image.colorspace_settings.name = LINEAR
    image.alpha_mode = "NONE"
    return image


def array_from_image(image: bpy.types.Image) -> np.ndarray:
    """Return an image's (H, W, 3) values, top row first."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, image.channels)[::-1, :, :3]
