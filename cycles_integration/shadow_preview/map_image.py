"""A shadow map's texels in a Blender image, bit by bit."""

from __future__ import annotations

import bpy
import numpy as np

from ...ibl_toolkit.mobile.shadow_maps import ShadowMap


def store_map(
    made: ShadowMap, image: bpy.types.Image | None, name: str, *, as_floats: bool = False
) -> bpy.types.Image:
    """Put a map's texels into an image: the one given or, where kind or size differ, one in its stead.

    32-bit floats become a float image; bytes become RGBA8 as on the device, the high byte first. Colours are
    no colours there, and alpha is a number as the others. The compositor takes alpha for opacity all the same
    and multiplies bytes with it: for it ``as_floats`` keeps the bytes as floats, 0 to 1.
    """
    size, _, channels = made.texels.shape
    has_floats = made.texels.dtype == np.float32
    is_float = has_floats or as_floats
    if image is None or image.is_float != is_float or tuple(image.size) != (size, size):
        image = _instead_of(image, name, size, is_float)
    pixels = np.zeros((size, size, 4), np.float32)
    pixels[..., 3] = 1
    pixels[..., :channels] = made.texels if has_floats else made.texels / np.float32(255)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()  # else the file would not keep it
    image.update_tag()
    return image


def _instead_of(old, name, size, is_float):
    image = bpy.data.images.new(name, size, size, alpha=True, float_buffer=is_float, is_data=True)
    image.alpha_mode = "CHANNEL_PACKED"
    image.use_half_precision = False
    if old is not None:
        old.user_remap(image)
        own_name = old.name
        bpy.data.images.remove(old)
        image.name = own_name
    return image
