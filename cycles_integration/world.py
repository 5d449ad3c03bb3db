"""The World: what no rebuilt surface covers is seen, and lights, from infinity."""

from __future__ import annotations

import bpy

from .lookup import environment_texture
from .node_trees import add, maths, mix_vectors
from .place import Place, own_name

NAME = "Panorama World"


def build_world(scene: bpy.types.Scene, place: Place, *, whole_map_lights: bool = False) -> bpy.types.World:
    """Show the panorama at infinity, through the origin's rotation.

    Camera, mirror and glass rays see the whole map, so that gaps between surfaces show no hole. Light comes
    from the sky alone, the part of the map without depth (nothing where the place is closed), or from the
    whole map where ``whole_map_lights``.
    """
    name = own_name(place, NAME)
    world = bpy.data.worlds.get(name) or bpy.data.worlds.new(name)
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    direction = _panorama_direction(tree, place.origin)
    seen = environment_texture(tree, place.image, direction)
    colour = seen
    if not whole_map_lights:
        sky = environment_texture(tree, place.sky, direction) if place.sky else (0, 0, 0)
        colour = mix_vectors(tree, _is_looked_at(tree), sky, seen)
    background = add(tree, "ShaderNodeBackground", {"Color": colour})
    add(tree, "ShaderNodeOutputWorld", {"Surface": background.outputs[0]})
    world.cycles.sampling_method = "AUTOMATIC" if whole_map_lights or place.sky else "NONE"
    scene.world = world
    return world


def _is_looked_at(tree):
    """1 for camera, glossy and transmission rays; Cycles samples the World's light as none of these."""
    rays = add(tree, "ShaderNodeLightPath").outputs
    either = maths(tree, "MAXIMUM", rays["Is Camera Ray"], rays["Is Glossy Ray"])
    return maths(tree, "MAXIMUM", either, rays["Is Transmission Ray"])


def _panorama_direction(tree, origin):
    """The ray's direction in the panorama frame.

    The World's Texture Coordinate → Object would carry the origin's translation too, so a Mapping follows the
    rotation by drivers; of type TEXTURE it applies the inverse.
    """
    generated = add(tree, "ShaderNodeTexCoord").outputs["Generated"]
    mapping = add(tree, "ShaderNodeMapping", {"Vector": generated}, vector_type="TEXTURE")
    for axis in range(3):
        driver = mapping.inputs["Rotation"].driver_add("default_value", axis).driver
        driver.type = "SUM"
        variable = driver.variables.new()
        variable.type = "TRANSFORMS"
        variable.targets[0].id = origin
        variable.targets[0].transform_type = f"ROT_{'XYZ'[axis]}"
        variable.targets[0].transform_space = "WORLD_SPACE"
    return mapping.outputs[0]
