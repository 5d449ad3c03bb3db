"""The lamps of an RGB-D map as small emissive meshes on the surfaces of the place, which Cycles aims at."""

from __future__ import annotations

import bpy
import numpy as np

from ..ibl_toolkit.light.lamps import Lamp
from . import lookup, roles
from .node_trees import add, vector_maths
from .place import Place, own_name


def replace_lamps(place: Place, found: tuple[Lamp, ...]) -> list[bpy.types.Object]:
    """Put one mesh for each lamp into the place, in the stead of those before.

    Camera, mirror and glass rays see the photograph on it. To diffuse light, and where Cycles aims at it, it
    is of one radiance: that of its pixels. Its surface is opaque, so what it covers is not counted twice.
    """
    for thing in list(place.lights.objects):
        for material in thing.data.materials:
            bpy.data.materials.remove(material)
        bpy.data.meshes.remove(thing.data)
    return [_lamp(place, number, lamp) for number, lamp in enumerate(found)]


def _lamp(place, number, lamp):
    name = own_name(place, f"Panorama Lamp {number}")
    mesh = bpy.data.meshes.new(name)
    counts = [len(outline) for outline in lamp.outlines]
    corners = iter(range(sum(counts)))
    faces = [[next(corners) for _ in range(count)] for count in counts]
    mesh.from_pydata(np.concatenate(lamp.outlines).tolist(), [], faces)
    mesh.materials.append(_material(place, name, lamp.radiance))
    thing = bpy.data.objects.new(name, mesh)
    thing[roles.LAMP] = True
    thing.panorama_role = roles.ENVIRONMENT
    thing.parent = place.origin  # the outlines are in the panorama frame
    thing.display_type = "WIRE"
    place.lights.objects.link(thing)
    return thing


def _material(place, name, radiance):
    """The strength is a plain number, since Cycles judges by it how much light the lamp gives."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    strongest = max(float(radiance.max()), 1e-9)
    light = _emission(tree, tuple((radiance / strongest).tolist()), strongest)
    photograph = lookup.lookup(place, tree, lookup.PHOTOGRAPH)
    seen = _emission(tree, vector_maths(tree, "MULTIPLY", photograph, (1 / strongest,) * 3), strongest)
    surface = add(tree, "ShaderNodeMixShader", {0: lookup.is_looked_at(tree), 1: light, 2: seen}).outputs[0]
    add(tree, "ShaderNodeOutputMaterial", {"Surface": surface})
    material.cycles.emission_sampling = "FRONT"
    return material


def _emission(tree, colour, strength):
    return add(tree, "ShaderNodeEmission", {"Color": colour, "Strength": strength}).outputs[0]
