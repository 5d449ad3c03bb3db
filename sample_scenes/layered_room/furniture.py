"""The front layer: sofas, poufs and the statue, each at its place in the table of sizes."""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Matrix

from . import materials, meshes, sizes, statue

_ARM, _FOOT = 0.17, 0.11
"""Width of a sofa's arm, height of its feet [m]."""
_PILLOWS = ((0.72, 0.42, 0.10), (0.62, 0.56, 0.46))
_LEATHER = materials.Gloss(0.3)


def build_furniture(collection: bpy.types.Collection, finish: str):
    """Build all pieces of the table."""
    builders = {sizes.SOFA: _sofa, sizes.POUF: _pouf, sizes.STATUE: statue.build_statue}
    for piece in sizes.PIECES:
        turn = Matrix.Rotation(math.radians(piece.turn_deg), 4, "Z")
        builders[piece.kind](collection, piece, Matrix.Translation((*piece.centre, 0)) @ turn, finish)


def _sofa(collection, sofa, matrix, finish):
    depth, width, height = sofa.size
    between = width - 2 * _ARM
    count = round(between / 0.7)
    seat = between / count
    middles = [(k + 0.5) * seat - between / 2 for k in range(count)]
    body = [
        meshes.moved(meshes.rounded_box((depth - 0.04, between + 0.04, 0.20), 0.03), (0, 0, _FOOT + 0.10)),
        meshes.moved(
            meshes.rounded_box((0.20, between + 0.04, height - _FOOT - 0.06), 0.06),
            (0.12 - depth / 2, 0, (height + _FOOT - 0.06) / 2),
        ),
    ]
    for side in (-1, 1):
        arm = meshes.rounded_box((depth, _ARM, 0.60 - _FOOT), 0.06, 0.012)
        body.append(meshes.moved(arm, (0, side * (width - _ARM) / 2, (0.60 + _FOOT) / 2)))
    cloth = materials.surface(f"{sofa.name} cloth", materials.woven(sofa.colour))
    meshes.add_object(collection, sofa.name, meshes.join(*body), cloth, matrix, smooth=True)
    lighter = tuple(min(1.25 * c, 0.8) for c in sofa.colour)
    soft = materials.surface(f"{sofa.name} cushions", materials.woven(lighter))
    cushions = []
    for middle in middles:
        bottom = meshes.rounded_box((depth - 0.24, seat - 0.012, 0.17), 0.055, 0.025)
        cushions.append(meshes.moved(bottom, (0.12, middle, _FOOT + 0.275)))
        back = meshes.turned(meshes.rounded_box((0.17, seat - 0.02, 0.42), 0.07, 0.03), "y", -12)
        cushions.append(meshes.moved(back, (0.29 - depth / 2, middle, height - 0.17)))
    meshes.add_object(collection, f"{sofa.name} cushions", meshes.join(*cushions), soft, matrix, smooth=True)
    _pillows(collection, sofa, matrix)
    _feet(collection, sofa, matrix, finish)


def _pillows(collection, sofa, matrix):
    depth, width, _ = sofa.size
    for number, (side, shade) in enumerate(zip((-1, 1), _PILLOWS, strict=True)):
        pillow = meshes.rounded_box((0.09, 0.42, 0.42), 0.045, 0.05)
        pillow = meshes.turned(meshes.turned(pillow, "y", -24), "z", -18 * side)
        pillow = meshes.moved(pillow, (0.46 - depth / 2, side * (width / 2 - _ARM - 0.25), 0.66))
        cloth = materials.surface(f"{sofa.name} pillow {number}", materials.woven(shade))
        meshes.add_object(collection, f"{sofa.name} pillow {number}", pillow, cloth, matrix, smooth=True)


def _feet(collection, sofa, matrix, finish):
    depth, width, _ = sofa.size
    foot = meshes.lathe([(0.018, 0.0), (0.03, _FOOT + 0.01)], 20)
    places = [(x * (depth / 2 - 0.08), y * (width / 2 - 0.08), 0) for x in (-1, 1) for y in (-1, 1)]
    wood = materials.surface(f"{sofa.name} feet", (0.05, 0.03, 0.02), finish, _LEATHER)
    feet = meshes.join(*(meshes.moved(foot, place) for place in places))
    meshes.add_object(collection, f"{sofa.name} feet", feet, wood, matrix, smooth=True)


def _pouf(collection, pouf, matrix, finish):
    """A ribbed cushion of leather with a button on top."""
    width, _, height = pouf.size
    angle = np.linspace(-0.5, 0.5, 25)[1:-1] * np.pi
    radius = width / 2 * np.cos(angle) ** 0.5
    z = height / 2 * (1 + np.sign(angle) * np.abs(np.sin(angle)) ** 0.8)
    body = meshes.lathe(np.column_stack([radius, z]), 144, ribs=16, depth=0.07)
    leather = materials.surface(
        f"{pouf.name} leather", materials.woven(pouf.colour, scale=9, depth=0.15), finish, _LEATHER
    )
    meshes.add_object(collection, pouf.name, body, leather, matrix, smooth=True)
    button = meshes.ellipsoid((0.05, 0.05, 0.014), (0, 0, height))
    meshes.add_object(collection, f"{pouf.name} button", button, leather, matrix, smooth=True)
