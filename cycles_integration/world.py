"""The World: what no rebuilt surface covers is seen, and lights, from infinity."""

from __future__ import annotations

import bpy

from .lookup import environment_texture, in_panorama_frame, is_looked_at
from .node_trees import add, maths, mix_vectors, vector_maths
from .place import Place, own_name
from .suns import number_at

NAME = "Panorama World"


def build_world(scene: bpy.types.Scene, place: Place, *, whole_map_lights: bool = False) -> bpy.types.World:
    """Show the panorama at infinity, through the origin's rotation.

    Camera, mirror and glass rays see the whole map, so that gaps between surfaces show no hole. Light comes
    from the sky alone, the part of the map without depth (nothing where the place is closed), or from the
    whole map where ``whole_map_lights``: from its suns and what these leave of it, if it has any.
    """
    name = own_name(place, NAME)
    world = bpy.data.worlds.get(name) or bpy.data.worlds.new(name)
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    direction = in_panorama_frame(tree, place.origin, add(tree, "ShaderNodeTexCoord").outputs["Generated"])
    colour = photograph = environment_texture(tree, place.image, direction)
    is_aimed_at = True
    if whole_map_lights and place.sun_numbers:
        quiet = environment_texture(tree, place.sun_quiet, direction)
        seen = _between_suns(tree, place, direction, photograph)
        colour = mix_vectors(tree, is_looked_at(tree), quiet, seen)
        is_aimed_at = False
    elif not whole_map_lights:
        sky = environment_texture(tree, place.sky, direction) if place.sky else (0, 0, 0)
        colour = mix_vectors(tree, is_looked_at(tree), sky, photograph)
        is_aimed_at = place.sky is not None
    background = add(tree, "ShaderNodeBackground", {"Color": colour})
    add(tree, "ShaderNodeOutputWorld", {"Surface": background.outputs[0]})
    world.cycles.sampling_method = "AUTOMATIC" if is_aimed_at else "NONE"
    scene.world = world
    return world


def _between_suns(tree, place, direction, photograph):
    """The photograph; black to mirror and glass rays where a sun shows it to them."""
    is_free = maths(tree, "LESS_THAN", number_at(place, tree, direction), -0.5)
    camera = add(tree, "ShaderNodeLightPath").outputs["Is Camera Ray"]
    return vector_maths(tree, "MULTIPLY", photograph, maths(tree, "MAXIMUM", camera, is_free))
