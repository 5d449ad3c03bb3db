"""The preview in a scene's compositor: it darkens the picture, from its passes Position and Normal."""

from __future__ import annotations

import bpy

from ..compositor import output_node, scene_tree
from ..node_trees import add
from .receivers import NODE, nodes_in

_LAYER = f"{NODE} Passes"


def put_on_picture(scene: bpy.types.Scene, view_layer, group: bpy.types.NodeTree, darkness: float):
    """Put the group before the output of the scene's compositor, unless an artist has it there already.

    A scene without a compositor gets one that shows the view layer's picture.
    """
    view_layer.use_pass_position = view_layer.use_pass_normal = True
    tree = scene_tree(scene)
    for node in composite_nodes(scene, group) or [_inserted(tree, scene, view_layer, group)]:
        node.inputs["Darkness"].default_value = darkness


def take_off_picture(scene: bpy.types.Scene, group: bpy.types.NodeTree):
    """Take the group out of the scene's compositor again, and the passes that were put there with it."""
    tree = _tree_of(scene)
    for node in composite_nodes(scene, group):
        sources = [link.from_socket for link in node.inputs["Image"].links]
        targets = [link.to_socket for link in node.outputs["Image"].links]
        tree.nodes.remove(node)
        for target in targets if sources else ():
            tree.links.new(sources[0], target)
    passes = tree.nodes.get(_LAYER) if tree else None
    if passes is not None and not any(socket.is_linked for socket in passes.outputs):
        tree.nodes.remove(passes)


def composite_nodes(scene: bpy.types.Scene, group: bpy.types.NodeTree | None) -> list[bpy.types.Node]:
    """The group's nodes in the scene's compositor."""
    return nodes_in(_tree_of(scene), group)


def _inserted(tree, scene, view_layer, group):
    output = output_node(tree)
    socket = output.inputs["Image"]
    passes = add(tree, "CompositorNodeRLayers", scene=scene, layer=view_layer.name, name=_LAYER).outputs
    before = socket.links[0].from_socket if socket.is_linked else passes["Image"]
    inputs = {"Image": before, "Position": passes["Position"], "Normal": passes["Normal"]}
    node = add(tree, "CompositorNodeGroup", inputs, node_tree=group, name=NODE, label=NODE)
    node.location = output.location.x - 200, output.location.y + 150
    passes[0].node.location = node.location.x - 300, node.location.y - 200
    tree.links.new(node.outputs["Image"], socket)
    return node


def _tree_of(scene):
    return scene.compositing_node_group if hasattr(scene, "compositing_node_group") else scene.node_tree
