"""The composite as a node group of the scene, so that F12 gives the finished picture (Blender 4.5 and
5.x)."""

from __future__ import annotations

import bpy

from . import view_layers
from .node_trees import add, maths, new_group, vector_maths

GROUP = "Panorama Composite"
SOCKETS = {
    "catcher": ("Objects", "Alpha", "Catcher", "Backplate", "At Infinity"),
    "difference": ("With", "Alpha", "Without", "Backplate", "At Infinity"),
}


def connect(
    scene: bpy.types.Scene, formula: str, sources: dict[str, tuple[str, str]], plate: bpy.types.Image | None
):
    """Build the composite group for a formula and feed it with (view layer, pass) pairs.

    ``formula`` is ``catcher`` or ``difference`` (the group's docstrings below); ``plate`` stands for the
    backplate where the picture is the panorama itself, so that untouched pixels are the file's.
    """
    tree = _scene_tree(scene)
    _remove_ours(tree)
    group = add(tree, "CompositorNodeGroup", node_tree=_group(formula), name=GROUP, label=GROUP)
    for socket, (layer, name) in sources.items():
        tree.links.new(_render_layer(tree, scene, layer).outputs[name], group.inputs[socket])
    if plate is not None:
        tree.links.new(
            add(tree, "CompositorNodeImage", image=plate, name=GROUP).outputs["Image"],
            group.inputs["Backplate"],
        )
    _to_output(tree, group.outputs["Image"])


def disconnect(scene: bpy.types.Scene):
    """Take the composite out again: the render is the picture."""
    tree = scene.compositing_node_group if hasattr(scene, "compositing_node_group") else scene.node_tree
    if tree is not None:
        _remove_ours(tree)
        _to_output(tree, _render_layer(tree, scene, view_layers.OBJECTS).outputs["Image"])


def _group(formula):
    """Objects over the photograph × catcher pass; or photograph + with − without, where no object covers
    it."""
    old = bpy.data.node_groups.get(GROUP)
    if old is not None:
        bpy.data.node_groups.remove(old)
    inputs = {name: "NodeSocketFloat" if name == "Alpha" else "NodeSocketColor" for name in SOCKETS[formula]}
    tree = new_group(GROUP, "CompositorNodeTree", {"Image": "NodeSocketColor"}, inputs)
    given = add(tree, "NodeGroupInput").outputs
    behind = vector_maths(tree, "ADD", given["Backplate"], given["At Infinity"])
    uncovered = maths(tree, "SUBTRACT", 1.0, given["Alpha"])
    if formula == "catcher":
        changed, front = vector_maths(tree, "MULTIPLY", behind, given["Catcher"]), given["Objects"]
    else:
        changed, front = vector_maths(tree, "SUBTRACT", behind, given["Without"]), given["With"]
    image = vector_maths(tree, "ADD", front, vector_maths(tree, "MULTIPLY", changed, uncovered))
    add(tree, "NodeGroupOutput", {"Image": image})
    return tree


def _scene_tree(scene):
    if hasattr(scene, "compositing_node_group"):  # Blender 5.0
        if scene.compositing_node_group is None:
            scene.compositing_node_group = new_group(
                "Compositor", "CompositorNodeTree", {"Image": "NodeSocketColor"}
            )
        return scene.compositing_node_group
    if scene.node_tree is None or not scene.use_nodes:
        scene.use_nodes = True
        scene.node_tree.nodes.clear()
    return scene.node_tree


def _remove_ours(tree):
    for node in [n for n in tree.nodes if n.name.startswith(GROUP)]:
        tree.nodes.remove(node)


def _render_layer(tree, scene, layer):
    name = f"{GROUP} {layer}"
    return tree.nodes.get(name) or add(tree, "CompositorNodeRLayers", scene=scene, layer=layer, name=name)


def _to_output(tree, image):
    kinds = ("NodeGroupOutput", "CompositorNodeComposite")
    output = next((n for n in tree.nodes if n.bl_idname in kinds), None)
    if output is None:
        output = add(tree, kinds[0] if tree.interface.items_tree else kinds[1])
    tree.links.new(image, output.inputs[0])
