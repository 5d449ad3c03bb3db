"""Nodes that find a point's place on the map and its depth, in the frame of the light."""

from __future__ import annotations

from ..node_trees import add, maths, new_group, output_group, vector_maths
from .kinds import SHADER

NAME = "Shadow Map Light"
_OUTPUTS = dict.fromkeys(("S", "T", "Depth", "Linear Depth", "Inside", "Facing"), "NodeSocketFloat")
_OUTPUTS |= {"Light": "NodeSocketVector"}
_AXES = ("Right", "Up", "Forward")
_BEFORE_LAMP = 1e-6
"""Distance along forward [m] from which on a lamp sees."""


def new_projection(perspective: bool, kind: str = SHADER):
    """A node group: the numbers of a light camera, as `light_numbers` has them → place, depth and more.

    S, T: on the map, 0 to 1. Depth: r as a depth buffer has it, Linear Depth: linear in metres, both cut off
    at 0 and 1. Inside: 1 on the map, 0 beside and behind it. Facing: 1 where the normal is towards it.
    Light: per channel, what it throws on the surface without shadows, as `remaining_light` weighs it.
    The light's numbers are inputs, so that a light that moves compiles no shader anew. Depths are taken from
    the light's place, not with one matrix from the world's origin: it saves digits of 32-bit floats.
    """
    inputs = {"Position": "NodeSocketVector", "Normal": "NodeSocketVector"}
    inputs |= dict.fromkeys(("Eye", *_AXES, "Strength"), "NodeSocketVector")
    inputs |= dict.fromkeys(("Near", "Far"), "NodeSocketFloat")
    tree = new_group(NAME, kind, _OUTPUTS, inputs)
    given = add(tree, "NodeGroupInput").outputs
    away = vector_maths(tree, "SUBTRACT", given["Position"], given["Eye"])
    right, up, forward = (vector_maths(tree, "DOT_PRODUCT", away, given[k]) for k in _AXES)
    ranges = maths(tree, "SUBTRACT", given["Far"], given["Near"])
    linear = maths(tree, "DIVIDE", maths(tree, "SUBTRACT", forward, given["Near"]), ranges)
    if perspective:
        before = maths(tree, "MAXIMUM", forward, _BEFORE_LAMP)
        right, up = (maths(tree, "DIVIDE", side, before) for side in (right, up))
        nearness = maths(tree, "SUBTRACT", 1.0, maths(tree, "DIVIDE", given["Near"], before))
        depth = maths(tree, "MULTIPLY", maths(tree, "DIVIDE", given["Far"], ranges), nearness)
        inside = maths(tree, "GREATER_THAN", forward, _BEFORE_LAMP)
        to_light = vector_maths(tree, "SUBTRACT", given["Eye"], given["Position"])
        cubed = maths(tree, "POWER", vector_maths(tree, "LENGTH", to_light), 3.0)
    else:
        depth, inside, cubed = linear, 1.0, 1.0
        to_light = vector_maths(tree, "SUBTRACT", (0, 0, 0), given["Forward"])
    for side in (right, up):
        within = maths(tree, "LESS_THAN", maths(tree, "ABSOLUTE", side), 0.5)
        inside = maths(tree, "MULTIPLY", inside, within)
    slant = vector_maths(tree, "DOT_PRODUCT", to_light, given["Normal"])
    received = maths(tree, "DIVIDE", maths(tree, "MAXIMUM", slant, 0.0), cubed)  # cosine / distance²
    output_group(
        tree,
        S=maths(tree, "ADD", right, 0.5),
        T=maths(tree, "ADD", up, 0.5),
        Depth=_cut(tree, depth),
        Linear_Depth=_cut(tree, linear),
        Inside=inside,
        Facing=maths(tree, "GREATER_THAN", slant, 0.0),
        Light=vector_maths(tree, "MULTIPLY", given["Strength"], received),
    )
    return tree


def light_numbers(camera, strength) -> dict:
    """Input → value of a projection, of a light camera and a light's strength (3,)."""
    right, up, forward = camera.axes
    return {
        "Eye": camera.eye.tolist(),
        "Right": (right / (2 * camera.half_width)).tolist(),
        "Up": (up / (2 * camera.half_height)).tolist(),
        "Forward": forward.tolist(),
        "Near": camera.near,
        "Far": camera.far,
        "Strength": strength.tolist(),
    }


def _cut(tree, depth):
    return maths(tree, "MINIMUM", maths(tree, "MAXIMUM", depth, 0.0), 1.0)
