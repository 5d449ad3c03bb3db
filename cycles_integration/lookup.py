"""The node group that looks the panorama up at a shaded point (eq. 5.8, sections 5.5.4 and 5.7.2).

The direction is the shaded point as seen from the panorama's origin, in the panorama's frame: reflections
find the wall where they hit it, not where they point. A mesh may carry the attribute `panorama_position`, its
points in the panorama frame as they were when stored: then it keeps that part of the picture however it is
moved or bent.
"""

from __future__ import annotations

import bpy

from .node_trees import add, maths, mix_vectors, new_group, output_group, vector_maths
from .place import Place, own_name

NAME = "Panorama Lookup"
STORED_POSITION = "panorama_position"
PHOTOGRAPH, DIFFUSE_LIGHT, IRRADIANCE, GLOSS = "Photograph", "Diffuse Light", "Irradiance", "Gloss"


def build_lookup(place: Place) -> bpy.types.NodeTree:
    """Build (or rebuild in place) the look-up of the place's maps.

    Outputs: ``Photograph``, the captured radiance; ``Diffuse Light``, the same without what the extracted
    lights give, for paths that have had a diffuse bounce; ``Irradiance``, E/π; ``Gloss``, the support's own
    reflection as the panorama saw it.
    """
    tree = _empty_group(own_name(place, NAME))
    direction = _direction(tree, place.origin)

    def texture(image):
        return environment_texture(tree, image, direction) if image else (0, 0, 0)

    photograph = texture(place.image)
    residual = texture(place.residual) if place.residual else photograph
    output_group(
        tree,
        Photograph=photograph,
        Diffuse_Light=mix_vectors(tree, after_diffuse_bounce(tree), photograph, residual),
        Irradiance=texture(place.irradiance),
        Gloss=texture(place.gloss),
    )
    return tree


def lookup(place: Place, tree: bpy.types.NodeTree, output: str) -> bpy.types.NodeSocket:
    """Use the look-up group in a material; returns the wanted output."""
    group = bpy.data.node_groups.get(own_name(place, NAME)) or build_lookup(place)
    return add(tree, "ShaderNodeGroup", node_tree=group).outputs[output]


def environment_texture(tree, image, direction) -> bpy.types.NodeSocket:
    """The equirectangular image in a direction of the panorama frame."""
    return add(tree, "ShaderNodeTexEnvironment", {"Vector": direction}, image=image).outputs["Color"]


def in_panorama_frame(tree, origin: bpy.types.Object, direction) -> bpy.types.NodeSocket:
    """A direction of the world in the panorama frame.

    Texture Coordinate → Object would carry the origin's translation too, so a Mapping follows the rotation by
    drivers; of type TEXTURE it applies the inverse.
    """
    mapping = add(tree, "ShaderNodeMapping", {"Vector": direction}, vector_type="TEXTURE")
    for axis in range(3):
        driver = mapping.inputs["Rotation"].driver_add("default_value", axis).driver
        driver.type = "SUM"
        variable = driver.variables.new()
        variable.type = "TRANSFORMS"
        variable.targets[0].id = origin
        variable.targets[0].transform_type = f"ROT_{'XYZ'[axis]}"
        variable.targets[0].transform_space = "WORLD_SPACE"
    return mapping.outputs[0]


def is_looked_at(tree) -> bpy.types.NodeSocket:
    """1 for camera, glossy and transmission rays, which see the picture.

    Where Cycles aims at a light or samples the World, none of these is set.
    """
    rays = add(tree, "ShaderNodeLightPath").outputs
    either = maths(tree, "MAXIMUM", rays["Is Camera Ray"], rays["Is Glossy Ray"])
    return maths(tree, "MAXIMUM", either, rays["Is Transmission Ray"])


def after_diffuse_bounce(tree) -> bpy.types.NodeSocket:
    """1 on paths that have had a diffuse bounce: to these the extracted lights give the bright part."""
    depth = add(tree, "ShaderNodeLightPath").outputs["Diffuse Depth"]
    return maths(tree, "GREATER_THAN", depth, 0.5)


def _empty_group(name):
    outputs = dict.fromkeys((PHOTOGRAPH, DIFFUSE_LIGHT, IRRADIANCE, GLOSS), "NodeSocketColor")
    tree = bpy.data.node_groups.get(name) or new_group(name, "ShaderNodeTree", outputs)
    tree.nodes.clear()
    return tree


def _direction(tree, origin):
    """The stored position where the mesh has one, else the shaded point in the origin's frame."""
    seen = add(tree, "ShaderNodeTexCoord", object=origin).outputs["Object"]
    stored = add(tree, "ShaderNodeAttribute", attribute_name=STORED_POSITION).outputs["Vector"]
    has_stored = maths(tree, "GREATER_THAN", vector_maths(tree, "LENGTH", stored), 1e-6)
    return mix_vectors(tree, has_stored, seen, stored)
