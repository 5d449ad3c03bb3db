"""The composite as a node group of the scene, so that F12 gives the finished picture (Blender 4.5 and 5.x).

What an artist adds behind the group's node stays: only the inside of the group and its inputs are made anew.
"""

from __future__ import annotations

import bpy

from .node_trees import add, maths, new_group, vector_maths

GROUP = "Panorama Composite"
INPUTS = {
    "Objects": "NodeSocketColor",
    "Alpha": "NodeSocketFloat",
    "Catcher": "NodeSocketColor",
    "Without": "NodeSocketColor",
    "Backplate": "NodeSocketColor",
    "At Infinity": "NodeSocketColor",
}
CATCHER, DIFFERENCE, PLAIN = "catcher", "difference", "plain"
NAMES_BEFORE_5 = {"Environment": "Env"}
"""Passes whose socket changed its name in Blender 5.0."""


def connect(
    scene: bpy.types.Scene,
    formula: str,
    sources: dict[str, tuple[str, str]],
    plate: bpy.types.Image | None = None,
):
    """Build the composite group for a formula and feed its inputs with (view layer, pass) pairs.

    With B the photograph behind (backplate and what lies at infinity) and α the objects' coverage,
    ``catcher`` is objects + (1 − α)·B·catcher, ``difference`` is with + (1 − α)·(B − without), and ``plain``
    the objects' render alone. ``plate`` stands for the backplate where the picture is the panorama itself, so
    that untouched pixels are the file's.
    """
    tree = scene_tree(scene)
    for node in [n for n in tree.nodes if n.name.startswith(f"{GROUP} ")]:
        tree.nodes.remove(node)
    group = tree.nodes.get(GROUP)
    if group is None:
        group = add(tree, "CompositorNodeGroup", node_tree=_empty_group(), name=GROUP, label=GROUP)
        tree.links.new(group.outputs["Image"], output_node(tree).inputs[0])
    _fill(group.node_tree, formula)
    for socket, (layer, name) in sources.items():
        tree.links.new(_pass(tree, scene, layer, name), group.inputs[socket])
    if plate is not None:
        image = add(tree, "CompositorNodeImage", image=plate, name=f"{GROUP} Plate").outputs["Image"]
        tree.links.new(image, group.inputs["Backplate"])


def _fill(tree, formula):
    tree.nodes.clear()
    given = add(tree, "NodeGroupInput").outputs
    image = given["Objects"]
    if formula != PLAIN:
        behind = vector_maths(tree, "ADD", given["Backplate"], given["At Infinity"])
        if formula == CATCHER:
            behind = vector_maths(tree, "MULTIPLY", behind, given["Catcher"])
        else:
            behind = vector_maths(tree, "SUBTRACT", behind, given["Without"])
        uncovered = maths(tree, "SUBTRACT", 1.0, given["Alpha"])
        image = vector_maths(tree, "ADD", image, vector_maths(tree, "MULTIPLY", behind, uncovered))
    add(tree, "NodeGroupOutput", {"Image": image})


def _empty_group():
    return new_group(GROUP, "CompositorNodeTree", {"Image": "NodeSocketColor"}, INPUTS)


def scene_tree(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    """The scene's compositor, made where there is none."""
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


def _pass(tree, scene, layer, name):
    node_name = f"{GROUP} {layer}"
    node = tree.nodes.get(node_name)
    if node is None:
        node = add(tree, "CompositorNodeRLayers", scene=scene, layer=layer, name=node_name)
    return node.outputs.get(name) or node.outputs[NAMES_BEFORE_5[name]]


def output_node(tree: bpy.types.NodeTree) -> bpy.types.Node:
    """The node that holds the tree's picture."""
    kinds = ("NodeGroupOutput", "CompositorNodeComposite")
    output = next((n for n in tree.nodes if n.bl_idname in kinds), None)
    return output or add(tree, kinds[0] if tree.interface.items_tree else kinds[1])
