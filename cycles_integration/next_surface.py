"""Where the next surface on each ray is: renders of geometry alone, in which closed solids have no inside.

Two are needed. In one the back faces of solids are transparent. Cycles goes on behind a transparent face, so
that it misses what touches it, as the floor under a box; in the other there are no solids at all. The nearer
of both is the next surface.
"""

from __future__ import annotations

import contextlib

import bpy

from .node_trees import add, maths
from .ray_start import BOX_INDEX, RayStart, new_material

SOLID_INDEX = 32000
"""The object index of solids meanwhile."""


@contextlib.contextmanager
def marked(things: set[bpy.types.Object]):
    """Give objects the index of solids for a while."""
    with _kept(things, "pass_index"):
        for thing in things:
            thing.pass_index = SOLID_INDEX
        yield


@contextlib.contextmanager
def unseen(things: set[bpy.types.Object]):
    """Hide objects from the camera for a while."""
    with _kept(things, "visible_camera"):
        for thing in things:
            thing.visible_camera = False
        yield


@contextlib.contextmanager
def _kept(things, name):
    before = {thing: getattr(thing, name) for thing in things}
    try:
        yield
    finally:
        for thing, value in before.items():
            setattr(thing, name, value)


@contextlib.contextmanager
def geometry_only(layer: bpy.types.ViewLayer, start: RayStart):
    """While the block runs, a view layer shows geometry: black, and the back faces of solids not at all."""
    own = layer.material_override
    material = new_material("Panorama Geometry of Layers", lambda tree: _shader(tree, start))
    layer.material_override = material
    try:
        yield
    finally:
        layer.material_override = own
        bpy.data.materials.remove(material)


def _shader(tree, start):
    index = add(tree, "ShaderNodeObjectInfo").outputs["Object Index"]
    backfacing = add(tree, "ShaderNodeNewGeometry").outputs["Backfacing"]
    is_inside = maths(tree, "MULTIPLY", maths(tree, "COMPARE", index, float(SOLID_INDEX), 0.5), backfacing)
    black = add(tree, "ShaderNodeEmission", {"Color": (0, 0, 0)})
    clear = add(tree, "ShaderNodeBsdfTransparent")
    surface = add(tree, "ShaderNodeMixShader", {0: is_inside, 1: black.outputs[0], 2: clear.outputs[0]})
    is_box = maths(tree, "COMPARE", index, float(BOX_INDEX), 0.5)
    return add(
        tree, "ShaderNodeMixShader", {0: is_box, 1: surface.outputs[0], 2: start.shader(tree)}
    ).outputs[0]
