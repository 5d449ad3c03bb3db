"""Rebuilt surfaces without a material: they show the photograph as long as a preview darkens it.

Otherwise they are drawn as wires, and the photograph is seen behind them.
"""

from __future__ import annotations

import bpy

from ..materials import PHOTOGRAPH_MATERIAL, photograph_material
from ..pieces import built_pieces
from ..place import Place, own_name


def show_photograph(place: Place, pieces: list[bpy.types.Object]) -> bpy.types.Material:
    """Let bare pieces show it, in views too."""
    material = photograph_material(place)
    for piece in pieces:
        piece.data.materials.clear()
        piece.data.materials.append(material)
        piece.display_type = "TEXTURED"
    return material


def undress(place: Place):
    """Make them bare again."""
    material = bpy.data.materials.get(own_name(place, PHOTOGRAPH_MATERIAL))
    if material is None:
        return
    for piece in built_pieces(place):
        if material in list(piece.data.materials):
            piece.data.materials.clear()
            piece.display_type = "WIRE"
    bpy.data.materials.remove(material)
