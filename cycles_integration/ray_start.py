"""Camera rays that begin farther out: what a panorama's camera sees beyond a distance of each direction.

A small box round the camera lets its rays in at one place and out at another (Cycles' Ray Portal), so that
nothing of the scene has to be changed: neither materials nor objects, be they linked or instanced. No other
rays meet the box, so that light, shadows and mirrors are those of the whole scene.
"""

from __future__ import annotations

import contextlib

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .node_trees import add, maths, vector_maths

BOX = 0.005
"""Half the box's side [m]."""
BOX_INDEX = 32001
"""The box's object index."""
LEAST_START = 0.01
"""No ray can begin nearer [m]: it would be in the box."""
_CORNERS = [(x, y, z) for x in (-BOX, BOX) for y in (-BOX, BOX) for z in (-BOX, BOX)]
_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_OTHER_RAYS = ("diffuse", "glossy", "transmission", "volume_scatter", "shadow")


class RayStart:
    """The distances at which the rays of one camera begin."""

    def __init__(self, image: bpy.types.Image, origin: Vector):
        self._image, self.origin = image, origin

    def set(self, distances: np.ndarray, *, inward: bool = False):
        """distances: (H, W) [m], of the directions of pixel centres; NaN: that ray is black.

        inward: rays go back towards the camera, so that they show the far sides of things.
        """
        height, width = distances.shape
        pixels = np.zeros((height, width, 4), np.float32)
        pixels[..., 0] = np.where(np.isnan(distances), -1, np.maximum(distances, LEAST_START))[::-1]
        pixels[..., 1] = -1 if inward else 1
        pixels[..., 3] = 1
        self._image.pixels.foreach_set(pixels.ravel())
        self._image.update()

    def shader(self, tree: bpy.types.NodeTree):
        """What the box wears: rays go on from the distance in their direction. Gives the shader's socket."""
        backward = add(tree, "ShaderNodeNewGeometry").outputs["Incoming"]
        direction = vector_maths(tree, "MULTIPLY", backward, (-1, -1, -1))
        in_panorama = add(
            tree,
            "ShaderNodeVectorTransform",
            {"Vector": direction},
            vector_type="VECTOR",
            convert_from="WORLD",
            convert_to="OBJECT",
        ).outputs[0]
        texture = add(
            tree,
            "ShaderNodeTexEnvironment",
            {"Vector": in_panorama},
            image=self._image,
            interpolation="Closest",
        )
        distance, sense, _ = add(tree, "ShaderNodeSeparateXYZ", {"Vector": texture.outputs["Color"]}).outputs
        way = vector_maths(tree, "MULTIPLY", direction, _grey(tree, distance))
        position = vector_maths(tree, "ADD", way, tuple(self.origin))
        sent = vector_maths(tree, "MULTIPLY", direction, _grey(tree, sense))
        onward = add(tree, "ShaderNodeBsdfRayPortal", {"Position": position, "Direction": sent})
        black = add(tree, "ShaderNodeEmission", {"Color": (0, 0, 0)})
        is_ended = maths(tree, "LESS_THAN", distance, 0.0)
        mixed = add(tree, "ShaderNodeMixShader", {0: is_ended, 1: onward.outputs[0], 2: black.outputs[0]})
        return mixed.outputs[0]


@contextlib.contextmanager
def ray_start(scene: bpy.types.Scene, world_from_panorama: Matrix, width: int):
    """While the block runs, the scene's panoramic camera at a frame (4, 4) sees through a RayStart.

    width: of its map of distances, width × width/2 [px]. Rays begin at LEAST_START at first.
    """
    image = bpy.data.images.new("Panorama Ray Start", width, width // 2, float_buffer=True, is_data=True)
    image.use_half_precision = False
    image.alpha_mode = "NONE"
    start = RayStart(image, world_from_panorama.translation)
    material = new_material(image.name, start.shader)
    mesh = bpy.data.meshes.new(image.name)
    mesh.from_pydata(_CORNERS, [], _FACES)
    mesh.materials.append(material)
    box = bpy.data.objects.new(mesh.name, mesh)
    box.matrix_world = world_from_panorama
    box.pass_index = BOX_INDEX
    for kind in _OTHER_RAYS:
        setattr(box, f"visible_{kind}", False)
    scene.collection.objects.link(box)
    start.set(np.zeros((width // 2, width), np.float32))
    try:
        yield start
    finally:
        bpy.data.meshes.remove(mesh)  # with the box
        bpy.data.materials.remove(material)
        bpy.data.images.remove(image)


def _grey(tree, number):
    """The vector with this number three times."""
    return add(tree, "ShaderNodeCombineXYZ", dict.fromkeys(range(3), number)).outputs[0]


def new_material(name: str, shader) -> bpy.types.Material:
    """A material whose surface is the socket that `shader` makes in its node tree."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    add(tree, "ShaderNodeOutputMaterial", {"Surface": shader(tree)})
    return material
