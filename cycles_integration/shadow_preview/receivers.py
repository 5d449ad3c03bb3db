"""The group in materials: before the output, so that it darkens whatever their surface shows."""

from __future__ import annotations

import bpy

from ..node_trees import add

NODE = "Shadow Map Preview"


def put_on(material: bpy.types.Material, group: bpy.types.NodeTree, darkness: float):
    """Put the group between a material's surface and its outputs, unless an artist has it somewhere already.

    A material without nodes gets some; one without a surface stays as it is, see `has_surface`.
    """
    if not _has_nodes(material):
        material.use_nodes = True
    there = nodes_of(material, group)
    if not there:
        there = [_inserted(material.node_tree, link, group) for link in _surfaces(material)]
    for node in there:
        node.inputs["Darkness"].default_value = darkness


def take_off(material: bpy.types.Material, group: bpy.types.NodeTree):
    """Take the group out again, and link what it darkened as before."""
    tree = material.node_tree
    for node in nodes_of(material, group):
        sources = [link.from_socket for link in node.inputs["Surface"].links]
        targets = [link.to_socket for link in node.outputs["Surface"].links]
        tree.nodes.remove(node)
        for target in targets if sources else ():
            tree.links.new(sources[0], target)


def nodes_of(material: bpy.types.Material, group: bpy.types.NodeTree | None) -> list[bpy.types.Node]:
    """The group's nodes in a material, wherever an artist has them; of no group none."""
    return nodes_in(material.node_tree, group)


def nodes_in(tree: bpy.types.NodeTree | None, group: bpy.types.NodeTree | None) -> list[bpy.types.Node]:
    """The group's nodes in a tree, if there are both."""
    if tree is None or group is None:
        return []
    return [node for node in tree.nodes if node.type == "GROUP" and node.node_tree == group]


def has_surface(material: bpy.types.Material) -> bool:
    """Whether there is something that a shadow could darken."""
    return not _has_nodes(material) or bool(_surfaces(material))


def _has_nodes(material):
    return material.node_tree is not None and (bpy.app.version >= (5,) or material.use_nodes)


def _surfaces(material):
    outputs = [n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL"]
    return [link for node in outputs for link in node.inputs["Surface"].links]


def _inserted(tree, link, group):
    source, target = link.from_socket, link.to_socket
    node = add(tree, "ShaderNodeGroup", {"Surface": source}, node_tree=group, name=NODE, label=NODE)
    node.location = target.node.location.x - 200, target.node.location.y + 150
    tree.links.new(node.outputs["Surface"], target)
    return node
