"""A scene of a box room, empty or with a box in it, round a known origin: how far rays go in it."""

import bpy
import numpy as np
from mathutils import Matrix

from expanded_panoramas.cycles_integration.layer_capture import capture_surfaces
from expanded_panoramas.cycles_integration.layer_render import LayerCapture
from expanded_panoramas.ibl_toolkit import equirectangular

EMISSION = "ShaderNodeEmission"
WIDTH = 64
TINY = LayerCapture(WIDTH, samples=1)
ROOM = np.array([[-3.0, -2.5, -1.2], [3.0, 2.5, 1.6]])
BOX = np.array([[1.0, -0.5, -0.7], [1.6, 0.7, 0.3]])
"""Hangs in the air."""
ORIGIN = (0.3, -0.2, 1.2)
RADIUS = 0.4
LEVEL = Matrix.Translation(ORIGIN)
WALL, SIDE = (0.2, 0.5, 0.8), (0.9, 0.3, 0.1)
METRES = 2e-3
DIRECTIONS = equirectangular.pixel_directions(WIDTH, WIDTH // 2).astype(np.float64)


def surfaces(*arguments):
    """The layers of `capture_surfaces` but for the backs of solids."""
    return [layer for layer in capture_surfaces(*arguments).layers if "back" not in layer.name]


def add_box(scene, corners, material, *, inward=False):
    """A closed box of two corners (2, 3) as seen from ORIGIN."""
    low, high = corners + ORIGIN
    places = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new("box")
    mesh.from_pydata(places, [], [face[::-1] for face in faces] if inward else faces)
    mesh.materials.append(material)
    thing = bpy.data.objects.new("box", mesh)
    scene.collection.objects.link(thing)
    return thing


def crossings(corners, eye, directions):
    """Distances at which rays go in and out of a box; in > out where they miss it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = ((corner - eye) / directions for corner in corners)
    return np.minimum(first, last).max(axis=-1), np.maximum(first, last).min(axis=-1)


def box_depth(directions, eye=(0, 0, 0)):
    near, far = crossings(BOX, eye, directions)
    return np.where((near < far) & (far > 0), near, np.inf)


def room_depth(directions, eye=(0, 0, 0)):
    return crossings(ROOM, eye, directions)[1]
