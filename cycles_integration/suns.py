"""The lamps of a map at infinity as sun lights, and what is left of the map in the World.

For the method that lights from infinity alone. The suns are plain discs of one radiance; a light's shader
cannot tell what kind of ray meets it, so the World shows reflected rays what the suns do not. The rest of the
map lights diffuse surfaces in low resolution, and Cycles need not aim at it.
"""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Vector

from ..ibl_toolkit.light.discs import Disc, DiscSplit, split_into_discs
from . import blender_images
from .node_trees import maths, vector_maths
from .place import Place, own_name


def split_map(image: np.ndarray, most: int | None = None) -> DiscSplit:
    """Split a map (H, W, 3) into discs for suns and a rest; without discs where there are to be no suns.

    ``most``: so many at most, the strongest; None gives none where Cycles' own sampling of the map does as
    well (`DiscSplit.helps`); 0 for none.
    """
    split = split_into_discs(image) if most is None else split_into_discs(image, most)
    return split_into_discs(image, 0) if most is None and not split.helps else split


def replace_suns(place: Place, split: DiscSplit):
    """Put suns for the discs of a map, and what they leave of it, into the place, in the stead of others."""
    for thing in list(place.suns.objects):
        bpy.data.lights.remove(thing.data)
    residual, quiet = (split.residual, split.quiet) if split.discs else (None, None)
    place.sun_residual = blender_images.replace_image(place.sun_residual, "Panorama Sun Residual", residual)
    place.sun_quiet = blender_images.replace_image(place.sun_quiet, "Panorama Sun Quiet", quiet)
    for number, disc in enumerate(split.discs):
        _sun(place, number, disc)


def radiance_of_suns(place: Place, tree: bpy.types.NodeTree, direction: bpy.types.NodeSocket):
    """The radiance of all suns that lie in a direction of the panorama frame."""
    total = (0, 0, 0)
    for sun in place.suns.objects:
        middle = sun.rotation_quaternion.to_matrix().col[2]
        radius = sun.data.angle / 2
        radiance = np.array(sun.data.color) * sun.data.energy / (np.pi * np.sin(radius) ** 2)
        cosine = vector_maths(tree, "DOT_PRODUCT", direction, tuple(middle))
        is_inside = maths(tree, "GREATER_THAN", cosine, float(np.cos(radius)))
        disc = vector_maths(tree, "MULTIPLY", tuple(radiance.tolist()), is_inside)
        total = vector_maths(tree, "ADD", total, disc)
    return total


def _sun(place, number, disc: Disc):
    data = bpy.data.lights.new(own_name(place, f"Panorama Sun {number}"), "SUN")
    strongest = float(disc.irradiance.max())
    data.energy, data.angle = strongest, 2 * disc.radius
    data.color = (disc.irradiance / strongest).tolist()
    sun = bpy.data.objects.new(data.name, data)
    sun.visible_camera = False
    sun.parent = place.origin
    sun.rotation_mode = "QUATERNION"
    sun.rotation_quaternion = Vector(disc.direction.tolist()).to_track_quat("Z", "Y")  # shines along −z
    place.suns.objects.link(sun)
