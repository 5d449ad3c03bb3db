"""The lamps of a map at infinity as sun lights, and what is left of the map in the World.

For the method that lights from infinity alone. Each sun is of one radiance to diffuse light and where Cycles
aims at it; a mirror or glass ray that meets it sees the photograph there, and the photograph around it in the
World. The rest of the map lights diffuse surfaces in low resolution, and Cycles need not aim at it.
"""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Vector

from ..ibl_toolkit.light.discs import Disc, DiscSplit, disc_numbers, split_into_discs
from . import blender_images, lookup
from .node_trees import add, maths, vector_maths
from .place import Place, own_name


def replace_suns(place: Place, image: np.ndarray, most: int | None = None) -> DiscSplit:
    """Put suns for the lamps of a map (H, W, 3) into the place, in the stead of those before.

    ``most``: so many at most, the strongest; None puts none where Cycles' own sampling of the map does as
    well (`DiscSplit.helps`); 0 for none. Returns the split, without discs where there are no suns.
    """
    for thing in list(place.suns.objects):
        bpy.data.lights.remove(thing.data)
    split = split_into_discs(image) if most is None else split_into_discs(image, most)
    if most is None and not split.helps:
        split = split_into_discs(image, 0)
    numbers = quiet = None
    if split.discs:
        found = disc_numbers(split.discs, *image.shape[1::-1]).astype(np.float32)
        numbers, quiet = np.repeat(found[..., None], 3, axis=2), split.quiet
    place.sun_numbers = blender_images.replace_image(place.sun_numbers, "Panorama Sun Numbers", numbers)
    place.sun_quiet = blender_images.replace_image(place.sun_quiet, "Panorama Sun Residual", quiet)
    for number, disc in enumerate(split.discs):
        _sun(place, number, disc)
    return split


def number_at(place: Place, tree: bpy.types.NodeTree, direction: bpy.types.NodeSocket):
    """Which sun shows the picture in a direction of the panorama frame; −1 for none."""
    node = add(
        tree,
        "ShaderNodeTexEnvironment",
        {"Vector": direction},
        image=place.sun_numbers,
        interpolation="Closest",
    )
    return node.outputs["Color"]


def _sun(place, number, disc: Disc):
    name = own_name(place, f"Panorama Sun {number}")
    data = bpy.data.lights.new(name, "SUN")
    strongest = float(disc.irradiance.max())
    data.energy, data.angle = strongest, 2 * disc.radius
    data.color = (disc.irradiance / strongest).tolist()
    _shader(place, data, number, disc)
    sun = bpy.data.objects.new(name, data)
    sun.visible_camera = False
    sun.parent = place.origin
    sun.rotation_mode = "QUATERNION"
    sun.rotation_quaternion = Vector(disc.direction.tolist()).to_track_quat("Z", "Y")  # shines along −z
    place.suns.objects.link(sun)


def _shader(place, data, number, disc):
    """Strength 1 stands for the sun's own colour and energy, whose radiance is E/(π sin²r)."""
    data.use_nodes = True
    tree = data.node_tree
    tree.nodes.clear()
    incoming = add(tree, "ShaderNodeNewGeometry").outputs["Incoming"]
    towards = vector_maths(tree, "MULTIPLY", incoming, (-1, -1, -1))
    direction = lookup.in_panorama_frame(tree, place.origin, towards)
    photograph = lookup.environment_texture(tree, place.image, direction)
    is_mine = maths(tree, "COMPARE", number_at(place, tree, direction), float(number), 0.5)
    per_radiance = np.pi * np.sin(disc.radius) ** 2 / np.maximum(disc.irradiance, 1e-12)
    seen = vector_maths(tree, "MULTIPLY", photograph, tuple(per_radiance.tolist()))
    seen = vector_maths(tree, "MULTIPLY", seen, is_mine)
    light = add(tree, "ShaderNodeEmission", {"Color": (1, 1, 1), "Strength": 1.0}).outputs[0]
    seen = add(tree, "ShaderNodeEmission", {"Color": seen, "Strength": 1.0}).outputs[0]
    surface = add(tree, "ShaderNodeMixShader", {0: lookup.is_looked_at(tree), 1: light, 2: seen}).outputs[0]
    add(tree, "ShaderNodeOutputLight", {"Surface": surface})
