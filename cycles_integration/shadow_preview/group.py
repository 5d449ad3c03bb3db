"""The node group "Shadow Map Preview": what shadow maps leave of a light, for any material.

A plain group, not a ShaderNodeCustomGroup: it works where the add-on is not installed, on a render farm.
"""

from __future__ import annotations

import bpy

from ...ibl_toolkit.mobile.shadow_maps import ShadowMap, ShadowSettings
from ..node_trees import add, maths, new_group, output_group, vector_maths
from . import projection, texel
from .depth_test import DepthTest
from .kinds import COMPOSITOR, GROUP_NODES, SHADER

WIDEST_WINDOW = 9
"""Of `pcf` in nodes [texels]: each place costs (window + 1)² look-ups, and a shader that long to compile."""
KEY = "panorama_shadow_map"
"""Custom property of a group: the settings that it was built for."""
_DARKNESS = {"Darkness": "NodeSocketFloat"}
_VISIBILITY = {"Visibility": "NodeSocketFloat"}
_VECTORS = dict.fromkeys(("Position", "Normal"), "NodeSocketVector")
_INPUTS = {
    SHADER: {"Surface": "NodeSocketShader", "Colour": "NodeSocketColor", **_DARKNESS},
    COMPOSITOR: {"Image": "NodeSocketColor", **_VECTORS, **_DARKNESS},
}
_OUTPUTS = {
    SHADER: {"Surface": "NodeSocketShader", "Shaded": "NodeSocketColor", **_VISIBILITY},
    COMPOSITOR: {"Image": "NodeSocketColor", **_VISIBILITY},
}
_LIGHT, _TEXEL = "Light", "Texel"
"""Names of its nodes for the light's numbers, and of the first that reads the map."""


def build_group(
    made: ShadowMap,
    image: bpy.types.Image,
    group: bpy.types.NodeTree | None,
    name: str,
    kind: str = SHADER,
) -> bpy.types.NodeTree:
    """Fill a group, the one given or a new one, with the test of a map whose texels are in an image.

    Inputs: Surface, a shader; Colour; Darkness, how dark full shadow is, 0 to 1. Outputs: Visibility, 1 lit
    and 0 in shadow; Surface and Shaded, the inputs times 1 − Darkness · (1 − Visibility).
    A compositor's has Image for both, and needs the passes Position and Normal; what lies at infinity stays.
    Raises ValueError for a window of `pcf` beyond WIDEST_WINDOW.
    """
    refuse_wide(made.settings)
    if group is None:
        group = new_group(name, kind, _OUTPUTS[kind], _INPUTS[kind])
        _limit(group)
    old = [node.node_tree for node in group.nodes if node.type == "GROUP"]
    group.nodes.clear()
    for tree in set(filter(None, old)):
        if not tree.users:
            bpy.data.node_groups.remove(tree)
    _fill(group, made, image)
    group[KEY] = _key(made)
    return group


def fits(group: bpy.types.NodeTree | None, made: ShadowMap, image: bpy.types.Image) -> bool:
    """Whether a group has the nodes that a map in an image needs, so that `aim_group` is all to do."""
    if group is None or group.get(KEY) != _key(made) or not {_LIGHT, _TEXEL} <= set(group.nodes.keys()):
        return False
    return any(getattr(n, "image", None) == image for n in group.nodes[_TEXEL].node_tree.nodes)


def aim_group(group: bpy.types.NodeTree, made: ShadowMap):
    """Give a group that fits where its map's light looks from: no shader is compiled anew."""
    light = group.nodes[_LIGHT]
    for name, value in projection.light_numbers(made.camera).items():
        light.inputs[name].default_value = value


def _fill(group, made, image):
    kind = group.bl_idname
    given = add(group, "NodeGroupInput").outputs
    where = given if kind == COMPOSITOR else add(group, "ShaderNodeNewGeometry").outputs
    place = add(
        group,
        GROUP_NODES[kind],
        {"Position": where["Position"], "Normal": where["Normal"]},
        node_tree=projection.new_projection(made.camera.perspective, kind),
        name=_LIGHT,
    )
    reader = texel.new_texel(made.settings, image, kind)
    lit = DepthTest(group, made.settings, place.outputs, reader).visibility()
    shadow = maths(group, "MULTIPLY", place.outputs["Inside"], maths(group, "SUBTRACT", 1.0, lit))
    visibility = maths(group, "MULTIPLY", maths(group, "SUBTRACT", 1.0, shadow), place.outputs["Facing"])
    if kind == COMPOSITOR:  # at infinity there is no normal
        nothing = maths(group, "LESS_THAN", vector_maths(group, "LENGTH", given["Normal"]), 0.5)
        visibility = maths(group, "MAXIMUM", visibility, nothing)
    darkness = maths(group, "MULTIPLY", given["Darkness"], maths(group, "SUBTRACT", 1.0, visibility))
    left = maths(group, "SUBTRACT", 1.0, darkness)
    if kind == COMPOSITOR:
        image_left = _darkened(group, given["Image"], darkness)
        output_group(group, Image=image_left, Visibility=visibility)
    else:
        black = add(group, "ShaderNodeEmission", {"Color": (0, 0, 0), "Strength": 0.0}).outputs[0]
        surface = add(group, "ShaderNodeMixShader", {0: left, 1: black, 2: given["Surface"]}).outputs[0]
        shaded = vector_maths(group, "MULTIPLY", given["Colour"], left)
        output_group(group, Surface=surface, Shaded=shaded, Visibility=visibility)
    aim_group(group, made)


def _darkened(tree, image, darkness):
    """The image less a share, with its alpha, which a product of vectors would lose."""
    node = add(tree, "ShaderNodeMix", data_type="RGBA")
    factor, first, second = (socket for socket in node.inputs if socket.enabled)
    tree.links.new(darkness, factor)
    tree.links.new(image, first)
    second.default_value = (0, 0, 0, 1)
    return next(socket for socket in node.outputs if socket.enabled)


def _limit(group):
    for item in group.interface.items_tree:
        if item.name == "Darkness":
            item.default_value, item.min_value, item.max_value, item.subtype = 1.0, 0.0, 1.0, "FACTOR"
        elif item.name == "Colour" and item.in_out == "INPUT":
            item.default_value = (1, 1, 1, 1)


def _key(made):
    return repr((made.settings, made.camera.perspective))


def refuse_wide(settings: ShadowSettings):
    """Raise ValueError for a window of `pcf` beyond WIDEST_WINDOW."""
    if settings.method == "pcf" and settings.window > WIDEST_WINDOW:
        raise ValueError(
            f"window {settings.window} of PCF must not exceed {WIDEST_WINDOW} texels in nodes: each point "
            f"would cost {(settings.window + 1) ** 2} look-ups"
        )
