"""The one colour that a phone gives a material."""

from __future__ import annotations

import bpy
import numpy as np

from ...ibl_toolkit.images.png import linear_from_srgb
from .. import blender_images
from ..shadow_preview.receivers import NODE

_COLOUR_OF = {"BSDF_PRINCIPLED": "Base Color", "BSDF_DIFFUSE": "Color"}
"""Shaders with a base colour, and the input that it is."""
_NOT_MATT = ("Metallic", "Transmission Weight")
"""Inputs of Principled beyond half of which a surface is anything but matt."""


def base_colour(material: bpy.types.Material) -> tuple[tuple[float, float, float], str]:
    """The base colour of a material, linear, 0 to 1, and a warning, "" for none.

    A constant is taken as it is, of an image the mean. For anything else it is the colour that the viewport's
    solid mode has, with a warning; so is what mirrors or lets light through told of.
    """
    if material.node_tree is None or (bpy.app.version < (5,) and not material.use_nodes):
        return tuple(np.clip(np.array(material.diffuse_color[:3], dtype=float), 0, 1).tolist()), ""
    shader, why = _shader(material.node_tree), ""
    colour = None if shader is None else _colour(shader)
    if shader is not None and any(_is_above_half(shader.inputs.get(name)) for name in _NOT_MATT):
        why = f"material '{material.name}' is metal or glass, and is drawn as a matt surface"
    if colour is None:
        colour = material.diffuse_color[:3]
        why = (
            f"material '{material.name}': its base colour is neither a constant nor an image, so it has its "
            "viewport colour"
        )
    return tuple(np.clip(np.asarray(colour, dtype=float), 0, 1).tolist()), why


def _shader(tree):
    """The node that the surface comes from, or None."""
    output = tree.get_output_node("ALL") or tree.get_output_node("CYCLES")
    shader = _source(output.inputs["Surface"] if output else None)
    while shader is not None and shader.type == "GROUP" and shader.name.startswith(NODE):  # our own preview
        shader = _source(shader.inputs["Surface"])
    return shader


def _colour(shader):
    if shader.type not in _COLOUR_OF:
        return None
    socket = shader.inputs[_COLOUR_OF[shader.type]]
    node = _source(socket)
    if node is None:
        return socket.default_value[:3]
    if node.type == "RGB":
        return node.outputs[0].default_value[:3]
    return _mean(node.image) if node.type == "TEX_IMAGE" and node.image else None


def _is_above_half(socket):
    return socket is not None and not socket.is_linked and socket.default_value > 0.5


def _source(socket):
    """The node that a socket's value comes from, or None."""
    while socket is not None and socket.is_linked:
        node = socket.links[0].from_node
        if node.type != "REROUTE":
            return node
        socket = node.inputs[0]
    return None


def _mean(image):
    """Linear colour, or None of an image without pixels."""
    if not image.has_data and not image.size[0]:
        return None
    values = blender_images.array_from_image(image)
    if not image.is_float and image.colorspace_settings.name == "sRGB":
        values = linear_from_srgb(values)
    return np.broadcast_to(values.reshape(-1, values.shape[-1]).mean(axis=0, dtype=float)[:3], 3)
