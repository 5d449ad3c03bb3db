"""A seated figure on a lotus, of balls that are fused: stands for the thesis's statue of the Buddha."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from . import materials, meshes

PLINTH_SHARE = 0.36
"""Of the statue's height."""
FIGURE_HEIGHT, LOTUS_HEIGHT = 0.82, 0.10
"""Of the figure as it is tabled below, and of the lotus that it sits on."""
VOXEL, SMOOTHING = 0.008, 6
"""Size [m] to which the balls are fused, and how often the result is smoothed."""

# Radii and centre of each ball [m]; the figure looks along +x and sits on z = 0.
_BALLS = (
    ((0.17, 0.23, 0.09), (0.00, 0.00, 0.09)),  # lap
    ((0.115, 0.150, 0.13), (0.02, 0.00, 0.22)),  # belly
    ((0.095, 0.145, 0.16), (0.00, 0.00, 0.36)),  # chest
    ((0.070, 0.185, 0.060), (-0.01, 0.00, 0.465)),  # shoulders
    ((0.048, 0.050, 0.070), (0.00, 0.00, 0.545)),  # neck
    ((0.082, 0.074, 0.092), (0.018, 0.00, 0.645)),  # head
    ((0.062, 0.058, 0.050), (0.030, 0.00, 0.590)),  # chin
    ((0.088, 0.080, 0.060), (0.000, 0.00, 0.690)),  # hair
    ((0.046, 0.046, 0.044), (-0.006, 0.00, 0.757)),  # knot of hair
    ((0.016, 0.016, 0.020), (-0.006, 0.00, 0.800)),
    ((0.020, 0.012, 0.026), (0.100, 0.00, 0.632)),  # nose
    ((0.018, 0.013, 0.048), (0.005, 0.082, 0.618)),  # ears
    ((0.018, 0.013, 0.048), (0.005, -0.082, 0.618)),
    ((0.062, 0.085, 0.026), (0.185, 0.00, 0.165)),  # hands, one in the other
)
# Start, end, and radius at each: the left limbs; the right ones mirror them.
_LIMBS = (
    ((-0.01, 0.185, 0.46), (0.01, 0.235, 0.27), 0.056, 0.048),  # upper arm
    ((0.01, 0.235, 0.27), (0.165, 0.070, 0.175), 0.047, 0.033),  # forearm
    ((0.00, 0.13, 0.085), (0.13, 0.335, 0.075), 0.095, 0.078),  # thigh
    ((0.13, 0.335, 0.070), (0.245, 0.02, 0.062), 0.072, 0.050),  # shin
)


def build_statue(collection: bpy.types.Collection, piece, matrix: Matrix, finish: str):
    """Build plinth, lotus and figure of a piece at its matrix."""
    depth, width, height = piece.size
    plinth_height = PLINTH_SHARE * height
    stone = materials.surface(
        f"{piece.name} plinth", materials.woven((0.17, 0.16, 0.155), scale=14, depth=0.35), finish
    )
    plinth = meshes.rounded_box((depth, width, plinth_height), 0.012)
    meshes.add_object(
        collection,
        f"{piece.name} plinth",
        meshes.moved(plinth, (0, 0, plinth_height / 2)),
        stone,
        matrix,
        smooth=True,
    )
    scale = (height - plinth_height) / (FIGURE_HEIGHT + LOTUS_HEIGHT)
    bronze = materials.surface(
        f"{piece.name} bronze",
        materials.woven(piece.colour, scale=7, depth=0.18),
        finish,
        materials.Gloss(0.28, metal=True),
    )
    seat = matrix @ Matrix.Translation((0, 0, plinth_height)) @ Matrix.Scale(scale, 4)
    lotus = meshes.add_object(collection, f"{piece.name} lotus", _lotus(), bronze, seat, smooth=True)
    lotus.scale.y *= 1.16
    figure = meshes.add_object(
        collection, piece.name, figure_shape(), bronze, seat @ Matrix.Translation((-0.05, 0, LOTUS_HEIGHT))
    )
    fuse = figure.modifiers.new("Fuse", "REMESH")
    fuse.mode, fuse.voxel_size, fuse.use_smooth_shade = "VOXEL", VOXEL, True
    smooth = figure.modifiers.new("Smooth", "SMOOTH")
    smooth.iterations = SMOOTHING


def figure_shape():
    """The seated figure's balls, not yet fused."""
    shapes = [meshes.ellipsoid(radii, centre) for radii, centre in _BALLS]
    for start, end, first, last in _LIMBS:
        for side in (1, -1):
            mirrored = np.array([1, side, 1])
            shapes.append(meshes.limb(start * mirrored, end * mirrored, first, last))
    return meshes.join(*shapes)


def _lotus():
    """Two rows of petals."""
    lower = meshes.lathe([(0.24, 0.0), (0.31, 0.02), (0.325, 0.045), (0.29, 0.06)], 160, ribs=20, depth=0.10)
    upper = meshes.lathe(
        [(0.27, 0.045), (0.32, 0.07), (0.315, 0.095), (0.27, 0.10)], 160, ribs=20, depth=0.10
    )
    return meshes.join(lower, upper)
