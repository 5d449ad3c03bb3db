"""The World: what no rebuilt surface covers is seen, and lights, from infinity."""

from __future__ import annotations

import bpy

from .lookup import environment_texture, in_panorama_frame, is_looked_at
from .node_trees import add, vector_maths
from .place import Place, own_name
from .suns import radiance_of_suns

NAME = "Panorama World"
FINER, MOST_SAMPLED = 2, 4096
"""Cycles aims at the map by a copy so many times as wide, since it blends pixels; a wider one, as Cycles
would choose, costs seconds each time."""


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
    photograph = environment_texture(tree, place.image, direction)
    if whole_map_lights and place.sun_quiet:
        surface = _beside_suns(tree, place, direction, photograph)
    elif whole_map_lights:
        surface = _background(tree, photograph)
    else:
        sky = environment_texture(tree, place.sky, direction) if place.sky else (0, 0, 0)
        surface = _choice(tree, is_looked_at(tree), _background(tree, sky), _background(tree, photograph))
    add(tree, "ShaderNodeOutputWorld", {"Surface": surface})
    is_aimed_at = not place.sun_quiet if whole_map_lights else place.sky
    world.cycles.sampling_method = "MANUAL" if is_aimed_at else "NONE"
    world.cycles.sample_map_resolution = min(FINER * place.image.size[0], MOST_SAMPLED)
    scene.world = world
    return world


def _beside_suns(tree, place, direction, photograph):
    """The photograph to the camera; the quiet map to diffuse light; to reflections what the suns do not show.

    Reflected and refracted rays meet the suns as well. A perfectly sharp one gets the difference, which is
    negative here and there: with the sun it makes the photograph. To a blurred one that would be noise; it
    sees the lamps as the suns' discs.
    """
    rays = add(tree, "ShaderNodeLightPath").outputs
    sharp = vector_maths(tree, "SUBTRACT", photograph, radiance_of_suns(place, tree, direction))
    blurred = environment_texture(tree, place.sun_residual, direction)
    quiet = environment_texture(tree, place.sun_quiet, direction)
    reflected = _choice(tree, rays["Is Singular Ray"], _background(tree, blurred), _background(tree, sharp))
    seen = _choice(tree, rays["Is Camera Ray"], reflected, _background(tree, photograph))
    return _choice(tree, is_looked_at(tree), _background(tree, quiet), seen)


def _background(tree, colour):
    return add(tree, "ShaderNodeBackground", {"Color": colour}).outputs[0]


def _choice(tree, factor, first, second):
    """One of two shaders; Cycles computes only that, which a mix of colours would not spare it."""
    return add(tree, "ShaderNodeMixShader", {0: factor, 1: first, 2: second}).outputs[0]
