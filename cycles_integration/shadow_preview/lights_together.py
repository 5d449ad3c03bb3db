"""Nodes for what shadows leave of several lights together, as the reference's `remaining_light` has it."""

from __future__ import annotations

from ..node_trees import maths, vector_maths

_LUMINANCE = (0.2126, 0.7152, 0.0722)


def together(tree, visibilities, lights):
    """What is left where each light has its visibility, 0 to 1 → sockets, per channel and of the luminance.

    lights: what each would throw on the surface without shadows, per channel. 1 where they throw nothing.
    """
    kept, whole = vector_maths(tree, "MULTIPLY", visibilities[0], lights[0]), lights[0]
    for visibility, light in zip(visibilities[1:], lights[1:], strict=True):
        kept = vector_maths(tree, "MULTIPLY_ADD", visibility, light, kept)
        whole = vector_maths(tree, "ADD", whole, light)
    grey = [vector_maths(tree, "DOT_PRODUCT", light, _LUMINANCE) for light in (kept, whole)]
    return _share(tree, vector_maths, kept, whole), _share(tree, maths, *grey)


def _share(tree, operation, kept, whole):
    """Nodes take a number over 0 for 0."""
    one = (1, 1, 1) if operation is vector_maths else 1.0
    nothing = operation(tree, "SUBTRACT", one, operation(tree, "SIGN", whole))
    return operation(tree, "ADD", operation(tree, "DIVIDE", kept, whole), nothing)
