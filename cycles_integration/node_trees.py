"""Node trees written as nested calls, so that a shader reads like its formula."""

from __future__ import annotations

import bpy


def new_group(
    name: str, kind: str, outputs: dict[str, str], inputs: dict[str, str] | None = None
) -> bpy.types.NodeTree:
    """Return an empty node group with the named sockets (name → socket type)."""
    tree = bpy.data.node_groups.new(name, kind)
    for socket, socket_type in (inputs or {}).items():
        tree.interface.new_socket(socket, in_out="INPUT", socket_type=socket_type)
    for socket, socket_type in outputs.items():
        tree.interface.new_socket(socket, in_out="OUTPUT", socket_type=socket_type)
    return tree


def add(tree: bpy.types.NodeTree, kind: str, inputs: dict | None = None, **properties) -> bpy.types.Node:
    """Add a node, set its properties, and feed its inputs (by name or number) with sockets or constants."""
    node = tree.nodes.new(kind)
    for name, value in properties.items():
        setattr(node, name, value)
    for name, value in (inputs or {}).items():
        _feed(tree, node.inputs[name], value)
    return node


def maths(tree, operation: str, *values):
    """A Math node of one to three values; returns its output."""
    return add(tree, "ShaderNodeMath", dict(enumerate(values)), operation=operation).outputs[0]


def vector_maths(tree, operation: str, *values):
    """A Vector Math node; returns its output (the number where the operation gives one)."""
    node = add(tree, "ShaderNodeVectorMath", dict(enumerate(values)), operation=operation)
    return node.outputs["Value" if operation in {"LENGTH", "DOT_PRODUCT", "DISTANCE"} else "Vector"]


def mix_vectors(tree, factor, first, second):
    """``first`` where the factor is 0, ``second`` where it is 1; not clamped, so radiance passes."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type = "VECTOR"
    for socket, value in zip(_enabled(node.inputs), (factor, first, second), strict=True):
        _feed(tree, socket, value)
    return _enabled(node.outputs)[0]


def _feed(tree, socket, value):
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, socket)
    elif socket.type == "RGBA" and len(value) == 3:
        socket.default_value = (*value, 1)
    else:
        socket.default_value = value


def _enabled(sockets):
    return [socket for socket in sockets if socket.enabled]


def output_group(tree, **sockets):
    """Connect the group's outputs (spaces in names written as underscores)."""
    return add(tree, "NodeGroupOutput", {name.replace("_", " "): socket for name, socket in sockets.items()})
