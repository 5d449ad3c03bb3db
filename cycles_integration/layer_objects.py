"""A layered panorama as objects: meshes of each layer that show its own picture.

All hang on one Empty where the panorama stands; each material looks its layer up by the direction from there,
as those of a place do (section 5.5.4). So from the origin the picture is the panorama's, whatever the meshes
are like, and turning or moving the Empty moves all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..ibl_toolkit import cube_map
from ..ibl_toolkit.layers.export.pieces import MESHES, checked_far, leaves_domain, mesh_parts, shape_radius
from ..ibl_toolkit.layers.export.texture import spread
from ..ibl_toolkit.layers.panorama import CUBE_MAP, Layer, LayeredPanorama
from . import blender_images
from .lookup import environment_texture
from .node_trees import add, maths

COLLECTION, ORIGIN = "Layers", "Layers Origin"
RADIUS = "panorama_radius"
"""Custom property of the Empty: from how far the layers are made to be looked at [m]."""


@dataclass(frozen=True)
class LayerObjects:
    """What was made; objects in the order of the layers, of each its `mesh_parts`."""

    collection: bpy.types.Collection
    origin: bpy.types.Object
    objects: tuple[bpy.types.Object, ...]


def add_layers(
    scene: bpy.types.Scene,
    panorama: LayeredPanorama,
    mesh_of: Callable = MESHES["quadtree"],
    far: float | None = None,
) -> LayerObjects:
    """Add a panorama's layers to the scene, in a collection of their own.

    mesh_of, far [m]: as in `export.pieces.pieces_of`. The materials emit the layers' radiance, linear and
    unclipped, and are not sampled as lights.

    Raises: ValueError, and adds nothing, for a layer without radiance and a `far` nearer than a surface.
    """
    far = checked_far(panorama, far)
    for layer in panorama.layers:
        if layer.radiance is None:
            raise ValueError(f"{layer} has no radiance, so there is nothing to show on its surface")
    parts = [
        (layer, part, mesh_of(part, shape_radius(panorama)))
        for layer in panorama.layers
        for part in mesh_parts(panorama, layer, far)
    ]
    collection = bpy.data.collections.new(COLLECTION)
    scene.collection.children.link(collection)
    origin = _origin(panorama)
    collection.objects.link(origin)
    images, objects = {}, []
    for layer, part, mesh in parts:
        if layer.name not in images:
            images[layer.name] = _picture(layer)
        data = _mesh(part.name, mesh.points, mesh.triangles)
        mask = _mask(part) if leaves_domain(part, mesh.points[mesh.triangles]) else None
        data.materials.append(_material(part.name, origin, images[layer.name], mask))
        thing = bpy.data.objects.new(part.name, data)
        thing.parent = origin
        collection.objects.link(thing)
        objects.append(thing)
    return LayerObjects(collection, origin, tuple(objects))


def _origin(panorama):
    origin = bpy.data.objects.new(ORIGIN, None)
    origin.empty_display_type, origin.empty_display_size = "SPHERE", max(panorama.radius, 0.05)
    rotation = Matrix(np.asarray(panorama.world_from_panorama).tolist()).to_4x4()
    origin.matrix_world = Matrix.Translation(np.asarray(panorama.origin).tolist()) @ rotation
    origin[RADIUS] = float(panorama.radius)
    return origin


def _mesh(name, points, triangles):
    """A triangle mesh; as arrays, for it may have a million of them."""
    mesh, count = bpy.data.meshes.new(name), len(triangles)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(points, np.float32).ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(triangles, np.int32).ravel())
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    return mesh


def _picture(layer: Layer):
    """The layer's radiance, gone on with beyond its domain; equirectangular, since the texture node knows no
    cube map."""
    image = _equirectangular(spread(layer.radiance, layer.mask, layer.mapping), layer.mapping)
    return blender_images.image_from_array(layer.name, image)


def _mask(part: Layer):
    """Its domain as an image."""
    values = np.repeat(part.mask[..., None].astype(np.float32), 3, axis=2)
    return blender_images.image_from_array(f"{part.name} mask", _equirectangular(values, part.mapping))


def _equirectangular(image, mapping):
    if mapping != CUBE_MAP:
        return image
    width = 4 * (image.shape[1] // 3)
    return cube_map.to_equirectangular(image, width, width // 2)


def _material(name, origin, image, mask):
    """Emit the picture as it is seen from the origin; where there is a mask, be nothing outside of it."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    direction = add(tree, "ShaderNodeTexCoord", object=origin).outputs["Object"]
    colour = environment_texture(tree, image, direction)
    shader = add(tree, "ShaderNodeEmission", {"Color": colour}).outputs[0]
    if mask is not None:
        inside = maths(tree, "GREATER_THAN", environment_texture(tree, mask, direction), 0.5)
        nothing = add(tree, "ShaderNodeBsdfTransparent").outputs[0]
        shader = add(tree, "ShaderNodeMixShader", {0: inside, 1: nothing, 2: shader}).outputs[0]
    add(tree, "ShaderNodeOutputMaterial", {"Surface": shader})
    material.cycles.emission_sampling = "NONE"
    return material
