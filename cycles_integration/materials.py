"""Materials of the real surfaces: environment, support, and those that only one render pass uses."""

from __future__ import annotations

import contextlib

import bpy

from . import lookup, roles
from .lookup import DIFFUSE_LIGHT, GLOSS, IRRADIANCE, PHOTOGRAPH
from .node_trees import add, maths, vector_maths
from .place import Place, own_name

MOST_ALBEDO = 0.9
"""A real surface reflects no more; what the photograph shows beyond that is taken as its own light."""
MOST_GLOSS = 0.5
"""At most this share of any colour of the photograph is taken for a reflection: were it all, an object that
blocks a window's blue reflection would leave the other colours alone, as a red spot."""
PHOTOGRAPH_MATERIAL = "Panorama Photograph"
LEAST_IRRADIANCE, LEAST_GLOSS = 1e-4, 1e-6


def environment_material(place: Place) -> bpy.types.Material:
    """Emit the photograph (eq. 5.8); after a diffuse bounce, what the extracted lights leave of it."""
    material = _emptied(place, "Panorama Environment")
    _surface(material, _emission(material.node_tree, lookup.lookup(place, material.node_tree, DIFFUSE_LIGHT)))
    return material


def support_material(place: Place) -> bpy.types.Material:
    """Reflect light with the effective albedo, so that undisturbed it shows exactly the photograph.

    With E the irradiance that the place throws on the point and S the reflection that the panorama saw there,
    A = (M − S)·π/E is the albedo that makes the lit surface show M; darker where light is blocked, brighter
    where it bounces. It replaces the factor ES of eq. 5.11, whose light has neither distance nor emitter
    cosine. Where the reflectivity asked for would mirror more than MOST_GLOSS of what the photograph
    shows, it is lowered, for all colours alike.
    """
    material = _emptied(place, "Panorama Support")
    tree = material.node_tree
    photograph, irradiance = lookup.lookup(place, tree, PHOTOGRAPH), lookup.lookup(place, tree, IRRADIANCE)
    gloss = lookup.lookup(place, tree, GLOSS)
    possible = _possible_share(tree, gloss, photograph)
    diffuse_part = vector_maths(tree, "SUBTRACT", photograph, vector_maths(tree, "MULTIPLY", gloss, possible))
    floor = vector_maths(tree, "MAXIMUM", irradiance, (LEAST_IRRADIANCE,) * 3)
    albedo = vector_maths(tree, "DIVIDE", diffuse_part, floor)
    albedo = vector_maths(
        tree, "MINIMUM", vector_maths(tree, "MAXIMUM", albedo, (0, 0, 0)), (MOST_ALBEDO,) * 3
    )
    own_light = vector_maths(
        tree, "SUBTRACT", diffuse_part, vector_maths(tree, "MULTIPLY", albedo, irradiance)
    )
    own_light = vector_maths(tree, "MAXIMUM", own_light, (0, 0, 0))
    diffuse = add(tree, "ShaderNodeBsdfDiffuse", {"Color": albedo}).outputs[0]
    lit = _sum(tree, diffuse, _emission(tree, own_light))
    _surface(material, _sum(tree, lit, _reflection(tree, possible)))
    return material


def backplate_material(place: Place) -> bpy.types.Material:
    """Show the photograph, projected on the rebuilt surfaces, to the camera."""
    material = _emptied(place, "Panorama Backplate")
    _surface(material, _emission(material.node_tree, lookup.lookup(place, material.node_tree, PHOTOGRAPH)))
    return material


def photograph_material(place: Place) -> bpy.types.Material:
    """Show the photograph alike, where no backplate is rendered: what a preview of a device darkens."""
    material = _emptied(place, PHOTOGRAPH_MATERIAL)
    _surface(material, _emission(material.node_tree, lookup.lookup(place, material.node_tree, PHOTOGRAPH)))
    return material


def black_material(place: Place) -> bpy.types.Material:
    """Neither emit nor reflect: for passes of geometry."""
    material = _emptied(place, "Panorama Geometry")
    _surface(material, _emission(material.node_tree, (0, 0, 0)))
    return material


def irradiance_material(place: Place) -> bpy.types.Material:
    """White and diffuse where the camera looks, the place's light elsewhere: the camera sees E/π."""
    return _probe(
        place,
        "Panorama Irradiance",
        lambda tree: add(tree, "ShaderNodeBsdfDiffuse", {"Color": (1, 1, 1, 1)}).outputs[0],
    )


def gloss_material(place: Place) -> bpy.types.Material:
    """A support's reflection alone where the camera looks, the place's light everywhere else."""
    return _probe(place, "Panorama Gloss", _reflection)


@contextlib.contextmanager
def worn_by(objects: list[bpy.types.Object], material: bpy.types.Material):
    """Let objects wear a material for a while; the lamps keep theirs, as in no override of the layer."""
    own = {thing.data: list(thing.data.materials) for thing in objects}
    for mesh in own:
        _dress(mesh, [material])
    try:
        yield
    finally:
        for mesh, before in own.items():
            _dress(mesh, before)


def assign(scene: bpy.types.Scene, place: Place):
    """Give every real object the material of its role.

    Where lights were extracted, Cycles aims at these and not at the surfaces, whose light is dim and
    everywhere.
    """
    by_role = {roles.SUPPORT: support_material(place), roles.ENVIRONMENT: environment_material(place)}
    for material in by_role.values():
        material.cycles.emission_sampling = "NONE" if place.lights.objects else "AUTO"
    for thing in roles.real_objects(scene):
        _dress(thing.data, [by_role[thing.panorama_role]])


def _dress(mesh, materials):
    mesh.materials.clear()
    for material in materials:
        mesh.materials.append(material)


def _probe(place, name, seen_by_camera):
    material = _emptied(place, name)
    tree = material.node_tree
    camera = add(tree, "ShaderNodeLightPath").outputs["Is Camera Ray"]
    light = _emission(tree, lookup.lookup(place, tree, DIFFUSE_LIGHT))
    _surface(
        material, add(tree, "ShaderNodeMixShader", {0: camera, 1: light, 2: seen_by_camera(tree)}).outputs[0]
    )
    return material


def _possible_share(tree, gloss, photograph):
    """The largest share, at most 1, of the gloss that takes no more than MOST_GLOSS of any colour."""
    ratios = vector_maths(
        tree, "DIVIDE", photograph, vector_maths(tree, "MAXIMUM", gloss, (LEAST_GLOSS,) * 3)
    )
    red, green, blue = add(tree, "ShaderNodeSeparateXYZ", {"Vector": ratios}).outputs
    least = maths(tree, "MINIMUM", maths(tree, "MINIMUM", red, green), blue)
    least = maths(tree, "MULTIPLY", least, MOST_GLOSS)
    return maths(tree, "MAXIMUM", maths(tree, "MINIMUM", least, 1.0), 0.0)


def _reflection(tree, share=1.0):
    """The support's gloss, from the object's own properties."""
    reflectivity = maths(tree, "MULTIPLY", _object_property(tree, "panorama_reflectivity"), share)
    return add(
        tree,
        "ShaderNodeBsdfAnisotropic",
        {"Color": reflectivity, "Roughness": _object_property(tree, "panorama_roughness")},
    ).outputs[0]


def _object_property(tree, name):
    return add(tree, "ShaderNodeAttribute", attribute_type="OBJECT", attribute_name=name).outputs["Fac"]


def _emission(tree, colour):
    return add(tree, "ShaderNodeEmission", {"Color": colour}).outputs[0]


def _sum(tree, first, second):
    return add(tree, "ShaderNodeAddShader", {0: first, 1: second}).outputs[0]


def _surface(material, shader):
    add(material.node_tree, "ShaderNodeOutputMaterial", {"Surface": shader})


def _emptied(place, name):
    name = own_name(place, name)
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material
