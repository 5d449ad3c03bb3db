"""What the sample room is made of: all diffuse to be measured, or with gloss to be looked at."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import bpy
import numpy as np

from ...cycles_integration.node_trees import add, maths, vector_maths

MATTE, SHINY = "matte", "shiny"
FINISHES = (MATTE, SHINY)
IOR = 1.45


class Gloss(NamedTuple):
    """What lies over a colour in the shiny finish: a varnish, or a metal of the colour itself."""

    roughness: float
    metal: bool = False


def surface(
    name: str, colour: tuple | Callable, finish: str = MATTE, gloss: Gloss | None = None
) -> bpy.types.Material:
    """A material of a linear colour (3,), or of one that a function makes in its node tree.

    Matte, it reflects evenly whatever its gloss would be.
    """
    material, tree = _new(name)
    shade = colour(tree) if callable(colour) else colour
    shader = add(tree, "ShaderNodeBsdfDiffuse", {"Color": shade})
    if gloss is not None and finish == SHINY:
        tint = shade if gloss.metal else (1, 1, 1)
        over = add(tree, "ShaderNodeBsdfAnisotropic", {"Color": tint, "Roughness": gloss.roughness})
        share = 0.8 if gloss.metal else add(tree, "ShaderNodeFresnel", {"IOR": IOR}).outputs[0]
        shader = add(tree, "ShaderNodeMixShader", {0: share, 1: shader.outputs[0], 2: over.outputs[0]})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return material


def looking_glass(name: str) -> bpy.types.Material:
    """A mirror."""
    material, tree = _new(name)
    glass = add(tree, "ShaderNodeBsdfAnisotropic", {"Color": (0.92, 0.93, 0.92), "Roughness": 0.0})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": glass.outputs[0]})
    return material


def light(name: str, radiance: tuple[float, float, float]) -> bpy.types.Material:
    """Emits a radiance evenly to all sides."""
    material, tree = _new(name)
    emission = add(tree, "ShaderNodeEmission", {"Color": radiance})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": emission.outputs[0]})
    return material


def lit_paper(name: str, radiance, bars: np.ndarray, wood) -> bpy.types.Material:
    """Paper that emits, and bars of wood (H, W, 1: 1 where there is one) before it."""
    material, tree = _new(name)
    mask = painted(np.repeat(bars, 3, axis=2), name)(tree)
    paper = add(tree, "ShaderNodeEmission", {"Color": radiance})
    bar = add(tree, "ShaderNodeBsdfDiffuse", {"Color": wood})
    mixed = add(tree, "ShaderNodeMixShader", {0: mask, 1: paper.outputs[0], 2: bar.outputs[0]})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": mixed.outputs[0]})
    return material


def painted(pixels: np.ndarray, name: str) -> Callable:
    """Colour of an image (H, W, 3), linear, top row first, over the whole of a rectangle's UVs."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new(name, width, height, float_buffer=True)
    image.colorspace_settings.name = "Linear Rec.709"
    rgba = np.concatenate([pixels[::-1], np.ones((height, width, 1))], axis=2)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.pack()

    def colour(tree):
        uv = add(tree, "ShaderNodeTexCoord").outputs["UV"]
        return add(tree, "ShaderNodeTexImage", {"Vector": uv}, image=image, extension="EXTEND").outputs[
            "Color"
        ]

    return colour


def planks(light_wood, dark_wood, *, length=1.7, width=0.16) -> Callable:
    """Boards along x, each of its own shade, with a soft grain."""

    def colour(tree):
        position = add(tree, "ShaderNodeTexCoord").outputs["Object"]
        boards = add(
            tree,
            "ShaderNodeTexBrick",
            {
                "Vector": position,
                "Color1": light_wood,
                "Color2": dark_wood,
                "Mortar": tuple(0.35 * c for c in dark_wood),
                "Scale": 1.0,
                "Mortar Size": 0.003,
                "Mortar Smooth": 0.5,
                "Brick Width": length,
                "Row Height": width,
            },
            offset=0.37,
        ).outputs["Color"]
        stretched = vector_maths(tree, "MULTIPLY", position, (1.2, 14.0, 1.0))
        return _shaded(tree, boards, stretched, 2.0, 0.35)

    return colour


def woven(shade, *, scale=22.0, depth=0.30) -> Callable:
    """Cloth or plaster: one shade with soft irregularities, ``scale`` of them per metre."""

    def colour(tree):
        position = add(tree, "ShaderNodeTexCoord").outputs["Object"]
        return _shaded(tree, shade, position, scale, depth)

    return colour


def _shaded(tree, colour, position, scale, depth):
    """A colour that noise darkens and brightens by up to ``depth`` of it."""
    noise = add(tree, "ShaderNodeTexNoise", {"Vector": position, "Scale": scale, "Detail": 3.0})
    factor = maths(tree, "MULTIPLY_ADD", noise.outputs[0], 2 * depth, 1 - depth)
    return vector_maths(tree, "MULTIPLY", colour, _grey(tree, factor))


def _grey(tree, value):
    return add(tree, "ShaderNodeCombineXYZ", {0: value, 1: value, 2: value}).outputs[0]


def _new(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree
