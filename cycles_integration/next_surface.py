"""Where the next surface on each ray is: renders of geometry alone, in which closed solids have no inside.

Two are needed. In one the back faces of solids are transparent. Cycles goes on behind a transparent face, so
that it misses what touches it, as the floor under a box; in the other there are no solids at all. The nearer
of both is the next surface.
"""

from __future__ import annotations

import contextlib

import bpy
import numpy as np

from .node_trees import add, maths, vector_maths
from .ray_start import BOX_INDEX, RayStart, new_material

SOLID_INDEX = 32000
"""The object index of solids meanwhile."""
_INSIDE = (1, 2, 0)


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
def geometry_only(layer: bpy.types.ViewLayer, start: RayStart, *, with_inside: bool = False):
    """While the block runs, a view layer shows geometry: black, and the back faces of solids not at all.

    with_inside: these show instead how far their tangent plane is from the rays' origin, see `to_plane`.
    """
    own, cycles = layer.material_override, layer.id_data.cycles
    clamps = cycles.sample_clamp_direct, cycles.sample_clamp_indirect
    material = new_material("Panorama Geometry of Layers", lambda tree: _shader(tree, start, with_inside))
    layer.material_override = material
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0  # distances are no light
    try:
        yield
    finally:
        cycles.sample_clamp_direct, cycles.sample_clamp_indirect = clamps
        layer.material_override = own
        bpy.data.materials.remove(material)


def to_plane(picture: np.ndarray) -> np.ndarray:
    """How far (H, W) [m] the tangent planes of the back faces in a picture (H, W, 4) are, NaN elsewhere.

    The colour tells them from the sky and from lamps, which the picture has, too.
    """
    red, green, blue = np.moveaxis(picture[..., :3], -1, 0)
    is_inside = (red > 0) & (np.abs(green - 2 * red) < 1e-3 * red) & (np.abs(blue) < 1e-3 * red)
    return np.where(is_inside, red, np.float32(np.nan))


def _shader(tree, start, with_inside):
    index = add(tree, "ShaderNodeObjectInfo").outputs["Object Index"]
    geometry = add(tree, "ShaderNodeNewGeometry").outputs
    is_solid = maths(tree, "COMPARE", index, float(SOLID_INDEX), 0.5)
    is_inside = maths(tree, "MULTIPLY", is_solid, geometry["Backfacing"])
    black = add(tree, "ShaderNodeEmission", {"Color": (0, 0, 0)})
    if with_inside:
        from_origin = vector_maths(tree, "SUBTRACT", geometry["Position"], tuple(start.origin))
        along_normal = vector_maths(tree, "DOT_PRODUCT", from_origin, geometry["True Normal"])
        distance = maths(tree, "ABSOLUTE", along_normal)
        inside = add(tree, "ShaderNodeEmission", {"Color": _INSIDE, "Strength": distance})
    else:
        inside = add(tree, "ShaderNodeBsdfTransparent")
    surface = add(tree, "ShaderNodeMixShader", {0: is_inside, 1: black.outputs[0], 2: inside.outputs[0]})
    is_box = maths(tree, "COMPARE", index, float(BOX_INDEX), 0.5)
    worn = add(tree, "ShaderNodeMixShader", {0: is_box, 1: surface.outputs[0], 2: start.shader(tree)})
    return worn.outputs[0]
