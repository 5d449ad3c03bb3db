"""A textured emissive mesh that Cycles aims at by what the texture shows: for references without any split.

Cycles picks a triangle by its area and by the strength of its emission, in which a texture counts as 1. So
the mesh is cut into small faces; where the photograph is bright, the strength is higher and the texture
darker by as much. The light is the same, ray by ray; in the hotel room the noise is 150 times less.
"""

import bmesh
import cv2
import numpy as np

from expanded_panoramas.cycles_integration import blender_images, lookup, roles
from expanded_panoramas.cycles_integration.node_trees import add, vector_maths
from expanded_panoramas.cycles_integration.place import place_of
from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.light_map import luminance

ROUNDS = ((0.3, 41), (0.1, 17), (0.03, 7))
"""Longest edge [m] of a face, and the pixels across of which it is as bright as the brightest; the first for
all faces, the others for bright ones."""
STEP = 4.0
"""Between two strengths."""


def aim_at_bright_faces(scene):
    """Give the environment's objects small faces and strengths."""
    place = place_of(scene)
    bright = luminance(np.maximum(blender_images.array_from_image(place.image), 0))
    bright = bright / bright.mean()
    panorama_from_world = np.array(place.origin.matrix_world.inverted())
    for thing in roles.with_role(scene, roles.ENVIRONMENT):
        panorama_from_mesh = panorama_from_world @ np.array(thing.matrix_world)
        steps = None
        for edge, pixels in ROUNDS:
            _cut(thing, edge, steps)
            steps = _steps(thing.data, panorama_from_mesh, _brightest_around(bright, pixels))
        thing.data.materials.clear()
        for number, step in enumerate(np.unique(steps)):
            thing.data.materials.append(_material(place, STEP**step))
            for index in np.flatnonzero(steps == step):
                thing.data.polygons[index].material_index = number


def _brightest_around(bright, pixels):
    wrapped = np.pad(bright, ((0, 0), (pixels, pixels)), mode="wrap")
    return cv2.dilate(wrapped, np.ones((pixels, pixels)))[:, pixels:-pixels]


def _steps(mesh, panorama_from_mesh, bright):
    """The step of strength (n,) of each face, 0 for those that are not bright."""
    middles = np.array([tuple(face.center) for face in mesh.polygons])
    directions = middles @ panorama_from_mesh[:3, :3].T + panorama_from_mesh[:3, 3]
    level = equirectangular.sample(bright[..., None].astype(np.float32), directions)[:, 0]
    return np.maximum(np.round(np.log(np.maximum(level, 1e-6)) / np.log(STEP)), 0).astype(int)


def _cut(thing, longest, steps):
    """Cut the edges of bright faces until none is longer [m]; of all faces where ``steps`` is None."""
    cut = bmesh.new()
    cut.from_mesh(thing.data)
    cut.transform(thing.matrix_world)  # lengths are the world's
    bright = cut.faces.layers.int.new("bright")
    for number, face in enumerate(cut.faces):
        face[bright] = 1 if steps is None else int(steps[number] > 0)
    bmesh.ops.triangulate(cut, faces=cut.faces)
    while True:
        long = [
            edge
            for edge in cut.edges
            if edge.calc_length() > longest and any(face[bright] for face in edge.link_faces)
        ]
        if not long:
            break
        bmesh.ops.subdivide_edges(cut, edges=long, cuts=1)
        bmesh.ops.triangulate(cut, faces=cut.faces)
    cut.faces.layers.int.remove(bright)
    cut.transform(thing.matrix_world.inverted())
    cut.to_mesh(thing.data)
    cut.free()


def _material(place, strength):
    import bpy

    material = bpy.data.materials.new("Aimed")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    photograph = lookup.lookup(place, tree, lookup.DIFFUSE_LIGHT)
    darker = vector_maths(tree, "MULTIPLY", photograph, (1 / strength,) * 3)
    emission = add(tree, "ShaderNodeEmission", {"Color": darker, "Strength": float(strength)})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": emission.outputs[0]})
    return material
