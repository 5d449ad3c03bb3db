"""The sample room as a Blender scene: its back layer and its front layer are collections."""

from __future__ import annotations

import bpy

from . import furniture, materials, shell

BACK, FRONT = "Panorama Back Layer", "Panorama Front Layer"
"""Collections: the room with all that is on its walls; the objects in it."""
_TAG = "panorama_layer"  # a second room's collections get other names


def new_room(finish: str = materials.MATTE, name: str = "Sample Room") -> bpy.types.Scene:
    """A new scene of the room, metric, lit by its own lamps alone.

    finish: "matte", all diffuse, so that a panorama holds all there is to know of it, with a painting in the
    mirror's frame; or "shiny", with the mirror, a polished floor, and gloss on leather, gilt and bronze.

    Raises: ValueError for another finish.
    """
    if finish not in materials.FINISHES:
        raise ValueError(f"finish is {finish!r}; expected one of {', '.join(materials.FINISHES)}")
    scene = bpy.data.scenes.new(name)
    for layer, build in ((BACK, shell.build_shell), (FRONT, furniture.build_furniture)):
        collection = bpy.data.collections.new(layer)
        collection[_TAG] = layer
        scene.collection.children.link(collection)
        build(collection, finish)
    scene.world = bpy.data.worlds.new("Black")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 0, 0, 1)
    return scene


def layer_collection_of(scene: bpy.types.Scene, layer: str) -> bpy.types.Collection:
    """The collection that is a layer, BACK or FRONT, of a room made by `new_room`.

    Raises: ValueError for a scene without one.
    """
    for collection in scene.collection.children:
        if collection.get(_TAG) == layer:
            return collection
    raise ValueError(f"scene '{scene.name}' has no collection tagged as {layer!r}; make it with new_room")
