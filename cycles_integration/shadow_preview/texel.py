"""Nodes that read a texel of the map and unpack what it stands for: filters have to mix unpacked numbers."""

from __future__ import annotations

import bpy

from ...ibl_toolkit.mobile.shadow_maps import ShadowSettings
from ...ibl_toolkit.mobile.shadow_maps.storage import STEPS
from ..node_trees import add, maths, new_group, output_group
from .kinds import SHADER

NAME = "Shadow Map Texel"
MOST_ABOVE = 30.0
"""Exponent up to which an exponential moment is taken over that of the point: beyond all is lit, and a 32-bit
float is full."""


def new_texel(settings: ShadowSettings, image: bpy.types.Image, kind: str = SHADER):
    """A node group: column and row [texels, from the map's lower left; cut off at its border] → numbers.

    First and Second are the depth, or the two moments. Those of `evsm` are divided by x and x² of the point
    whose linear depth is the input Depth: exp(2c z) alone is more than a 32-bit float holds well.
    After: any number that has to be there first. Without it Cycles computes the places of all look-ups before
    it reads the first, and its stack is too small for many (a shader that does not fit is black).
    """
    inputs = dict.fromkeys(("Column", "Row", "Depth", "After"), "NodeSocketFloat")
    tree = new_group(NAME, kind, dict.fromkeys(("First", "Second"), "NodeSocketFloat"), inputs)
    given = add(tree, "NodeGroupInput").outputs
    size = settings.resolution
    middles = [_middle(tree, given[side], size) for side in ("Column", "Row")]
    read, third = (_read_in_shader, given["After"]) if kind == SHADER else (_read_in_compositor, 1.0)
    place = add(tree, "ShaderNodeCombineXYZ", {0: middles[0], 1: middles[1], 2: third}).outputs[0]
    first, second = _numbers(tree, read(tree, image, place), settings.storage)
    if settings.method == "evsm":
        first, second = _exponential(tree, first, second, given["Depth"], settings)
    output_group(tree, First=first, Second=second)
    return tree


def _read_in_shader(tree, image, place):
    looks = {"image": image, "interpolation": "Closest", "extension": "EXTEND"}
    texture = add(tree, "ShaderNodeTexImage", {"Vector": place}, **looks)
    channels = add(tree, "ShaderNodeSeparateColor", {"Color": texture.outputs["Color"]}).outputs
    return (*channels, texture.outputs["Alpha"])


def _read_in_compositor(tree, image, place):
    """The third coordinate, 1, is what the node multiplies the image with."""
    picture = add(tree, "CompositorNodeImage", image=image).outputs["Image"]
    texture = add(tree, "CompositorNodeMapUV", {"Image": picture, "UV": place})
    if "Interpolation" in texture.inputs:  # Blender 5.0
        texture.inputs["Interpolation"].default_value = "Nearest"
    else:
        texture.filter_type = "NEAREST"
    return add(tree, "CompositorNodeSeparateColor", {"Image": texture.outputs["Image"]}).outputs


def _middle(tree, index, size):
    index = maths(tree, "MINIMUM", maths(tree, "MAXIMUM", index, 0.0), size - 1.0)
    return maths(tree, "DIVIDE", maths(tree, "ADD", index, 0.5), float(size))


def _numbers(tree, channels, storage):
    """First and second number of a texel; of whole ones, 0 to 1."""
    if storage != "16+16":
        return channels[0], channels[1]
    step = 255 * STEPS[storage]
    pairs = (channels[:2], channels[2:])
    return [
        maths(tree, "MULTIPLY", maths(tree, "MULTIPLY_ADD", high, 256.0, low), step) for high, low in pairs
    ]


def _exponential(tree, first, second, depth, settings):
    if settings.storage == "float32":
        x = maths(tree, "EXPONENT", _times(tree, settings.exponent, maths(tree, "SUBTRACT", depth, 1.0)))
        return maths(tree, "DIVIDE", first, x), maths(tree, "DIVIDE", maths(tree, "DIVIDE", second, x), x)
    above = _times(tree, settings.exponent, maths(tree, "SUBTRACT", first, depth))
    mean = maths(tree, "EXPONENT", maths(tree, "MINIMUM", above, MOST_ABOVE))
    share = maths(tree, "MINIMUM", second, 1 - STEPS[settings.storage] / 2)
    deviation = maths(tree, "DIVIDE", share, maths(tree, "SUBTRACT", 1.0, share))
    spread = maths(tree, "MULTIPLY_ADD", deviation, deviation, 1.0)
    return mean, maths(tree, "MULTIPLY", maths(tree, "MULTIPLY", mean, mean), spread)


def _times(tree, number, socket):
    return maths(tree, "MULTIPLY", socket, number)
