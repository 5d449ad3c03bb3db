"""The node group "Shadow Map Preview": what shadow maps leave of one light or several, for any material.

A plain group, not a ShaderNodeCustomGroup: it works where the add-on is not installed, on a render farm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...ibl_toolkit.mobile.shadow_maps import ShadowMap, ShadowSettings
from ..node_trees import add, maths, new_group, output_group, vector_maths
from . import projection, texel
from .depth_test import DepthTest
from .kinds import COMPOSITOR, GROUP_NODES, SHADER
from .lights_together import together

MOST_LOOK_UPS = 100
"""Of `pcf` in nodes: each place costs (window + 1)² for each light, and a shader that long to compile."""
KEY = "panorama_shadow_map"
"""Custom property of a group: the nodes that it was built with."""
_LAYOUT = 2
"""Number of what is built: raise it with each change, so that groups in older files are built anew."""
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


@dataclass(frozen=True, eq=False)
class ShownLight:
    """A light's map, the image of its texels, and its strength (3,), see `strength_of`."""

    made: ShadowMap
    image: bpy.types.Image
    strength: np.ndarray


def build_group(
    lights: Sequence[ShownLight], group: bpy.types.NodeTree | None, name: str, kind: str = SHADER
) -> bpy.types.NodeTree:
    """Fill a group, the one given or a new one, with the test of the maps of one light or several.

    Inputs: Surface, a shader; Colour; Darkness, how dark full shadow is, 0 to 1. Outputs: Visibility, 1 lit
    and 0 in shadow; Surface and Shaded, the inputs times 1 − Darkness · (1 − Visibility). Of several lights
    it is what remains of them together: Shaded has it per channel, the others have its luminance.
    A compositor's has Image for both, per channel, and needs the passes Position and Normal; what lies at
    infinity stays.
    Raises ValueError for a window of `pcf` that takes more than MOST_LOOK_UPS.
    """
    refuse_wide(lights[0].made.settings, len(lights))
    if group is None:
        group = new_group(name, kind, {})
    _give_sockets(group)
    old = [node.node_tree for node in group.nodes if node.type == "GROUP"]
    group.nodes.clear()
    for tree in set(filter(None, old)):
        if not tree.users:
            bpy.data.node_groups.remove(tree)
    _fill(group, lights)
    group[KEY] = _key(lights)
    return group


def fits(group: bpy.types.NodeTree | None, lights: Sequence[ShownLight]) -> bool:
    """Whether a group has the nodes that lights need, so that `aim_group` is all to do."""
    return (
        group is not None
        and group.get(KEY) == _key(lights)
        and images_of(group) == [light.image for light in lights]
        and all(_name(number) in group.nodes for number in range(len(lights)))
    )


def aim_group(group: bpy.types.NodeTree, lights: Sequence[ShownLight]):
    """Give a group that fits where its lights look from, and how strong they are: no shader is compiled."""
    for number, light in enumerate(lights):
        node = group.nodes[_name(number)]
        for name, value in projection.light_numbers(light.made.camera, light.strength).items():
            node.inputs[name].default_value = value


def images_of(group: bpy.types.NodeTree | None) -> list[bpy.types.Image]:
    """The images that a group reads maps from, in the order of its lights; of no group none."""
    nodes = () if group is None else sorted(group.nodes, key=lambda node: node.name)
    trees = [node.node_tree for node in nodes if node.type == "GROUP" and node.node_tree]
    found = [getattr(node, "image", None) for tree in trees for node in tree.nodes]
    return list(dict.fromkeys(filter(None, found)))


def refuse_wide(settings: ShadowSettings, lights: int):
    """Raise ValueError for a window of `pcf` that takes more than MOST_LOOK_UPS for so many lights."""
    widest = int((MOST_LOOK_UPS / lights) ** 0.5) - 1
    widest -= (widest + 1) % 2  # windows are odd
    if settings.method == "pcf" and settings.window > widest:
        several = f" for {lights} lights" if lights > 1 else ""
        raise ValueError(
            f"window {settings.window} of PCF must not exceed {widest} texels in nodes{several}: each point "
            f"would cost {lights * (settings.window + 1) ** 2} look-ups"
        )


def _fill(group, lights):
    kind = group.bl_idname
    given = add(group, "NodeGroupInput").outputs
    where = given if kind == COMPOSITOR else add(group, "ShaderNodeNewGeometry").outputs
    visibilities, received = [], []
    for number, light in enumerate(lights):
        place, lit = _tested(group, where, number, light, (visibilities or [0.0])[-1])
        visibilities.append(lit)
        received.append(place["Light"])
    if len(lights) > 1:
        coloured, visibility = together(group, visibilities, received)
    else:
        visibility = visibilities[0]
        if kind == COMPOSITOR:  # at infinity there is no normal
            nothing = maths(group, "LESS_THAN", vector_maths(group, "LENGTH", given["Normal"]), 0.5)
            visibility = maths(group, "MAXIMUM", visibility, nothing)
        coloured = visibility
    if kind == COMPOSITOR:
        image_left = _darkened(group, given["Image"], coloured, given["Darkness"])
        output_group(group, Image=image_left, Visibility=visibility)
    else:
        darkness = maths(group, "MULTIPLY", given["Darkness"], maths(group, "SUBTRACT", 1.0, visibility))
        black = add(group, "ShaderNodeEmission", {"Color": (0, 0, 0), "Strength": 0.0}).outputs[0]
        mixed = {0: darkness, 1: given["Surface"], 2: black}
        surface = add(group, "ShaderNodeMixShader", mixed).outputs[0]
        shaded = _darkened(group, given["Colour"], coloured, given["Darkness"])
        output_group(group, Surface=surface, Shaded=shaded, Visibility=visibility)
    aim_group(group, lights)


def _tested(group, where, number, light, after):
    """The outputs of a light's projection, and its visibility; computed after another's."""
    kind, settings = group.bl_idname, light.made.settings
    place = add(
        group,
        GROUP_NODES[kind],
        {"Position": where["Position"], "Normal": where["Normal"]},
        node_tree=projection.new_projection(light.made.camera.perspective, kind),
        name=_name(number),
    ).outputs
    reader = texel.new_texel(settings, light.image, kind)
    lit = DepthTest(group, settings, place, reader, f"{texel.NAME} {number}", after).visibility()
    shadow = maths(group, "MULTIPLY", place["Inside"], maths(group, "SUBTRACT", 1.0, lit))
    return place, maths(group, "MULTIPLY", maths(group, "SUBTRACT", 1.0, shadow), place["Facing"])


def _darkened(tree, colour, visibility, darkness):
    """A colour times 1 − darkness · (1 − visibility); its alpha stays, which a product of vectors loses."""
    node = add(tree, "ShaderNodeMix", data_type="RGBA", blend_type="MULTIPLY")
    sockets = [socket for socket in node.inputs if socket.enabled]
    for source, socket in zip((darkness, colour, visibility), sockets, strict=True):
        tree.links.new(source, socket)
    return next(socket for socket in node.outputs if socket.enabled)


def _give_sockets(group):
    """Those that it lacks; what an older version had beside them goes."""
    kind, interface = group.bl_idname, group.interface
    for side, wanted in (("OUTPUT", _OUTPUTS[kind]), ("INPUT", _INPUTS[kind])):
        there = [one for one in interface.items_tree if one.item_type == "SOCKET" and one.in_out == side]
        kept = {one.name for one in there if wanted.get(one.name) == one.socket_type}
        for item in there:
            if item.name not in kept:
                interface.remove(item)
        for name, socket_type in wanted.items():
            if name not in kept:
                _limit(interface.new_socket(name, in_out=side, socket_type=socket_type))


def _limit(socket):
    if socket.name == "Darkness":
        socket.default_value, socket.min_value, socket.max_value, socket.subtype = 1.0, 0.0, 1.0, "FACTOR"
    elif socket.name == "Colour":
        socket.default_value = (1, 1, 1, 1)


def _name(number):
    return f"{projection.NAME} {number}"


def _key(lights):
    return repr((_LAYOUT, lights[0].made.settings, [light.made.camera.perspective for light in lights]))
