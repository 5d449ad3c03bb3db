"""New objects for the hotel room, and the camera that looks at them; all made by script, without assets.

Positions are in the world of `hotel_room.json` [m]: the origin is on the floor below the panorama, the desk
stands at −y, the bed at +y. Desk and bed tops are taken from the rebuilt pieces, so what stands on them stays
on them when the calibration changes.
"""

from __future__ import annotations

import math

import bmesh
import bpy
import numpy as np
from mathutils import Vector

EYE, TARGET = (0.85, 0.60, 1.50), (-0.70, -0.42, 0.45)
"""Where the frame's camera stands, and looks [m]: a metre behind where the panorama was captured, with that
point in the middle of the picture, so that what was not rebuilt is smeared least."""
FOV_DEG = 80.0
"""Across the frame's width."""
MIRROR_BALL, MATTE_BALL = ((0.00, -0.36), 0.15), ((-0.52, -0.16), 0.12)
"""Where the balls lie on the floor and their radius [m]."""
CARAFE, KNOT = (0.20, -1.12), (-0.55, 0.56)
"""Where the carafe stands on the desk, and the knot lies on the bed [m]."""
CARAFE_OUTSIDE = (
    (0.000, 0.000),
    (0.048, 0.000),
    (0.056, 0.004),
    (0.066, 0.030),
    (0.070, 0.065),
    (0.064, 0.105),
    (0.046, 0.145),
    (0.032, 0.175),
    (0.029, 0.200),
    (0.034, 0.232),
    (0.044, 0.252),
)
"""Profile of the carafe from the middle of its foot to its lip: (radius, height) [m]."""
CARAFE_WALL = 0.004
KNOT_RADIUS, KNOT_TUBE = 0.085, 0.036
"""The trefoil knot's middle line and its tube [m]."""


def add_objects(scene: bpy.types.Scene, pieces) -> list[bpy.types.Object]:
    """Add the mirror ball, the matte ball, the glass carafe and the ceramic knot to the scene.

    ``pieces``: the rebuilt room, of which `desk` and `bed` carry something.
    """
    tops = {piece.name: piece.size_m[2] for piece in pieces}
    return [
        _ball(
            scene,
            "Mirror ball",
            *MIRROR_BALL,
            _principled("Mirror", (0.96, 0.96, 0.96), metal=1, roughness=0),
        ),
        _ball(
            scene, "Matte ball", *MATTE_BALL, _principled("Matte", (0.5, 0.5, 0.5), roughness=1, specular=0)
        ),
        _carafe(scene, (*CARAFE, tops["desk"])),
        _knot(scene, (*KNOT, tops["bed"])),
    ]


def add_camera(scene: bpy.types.Scene) -> bpy.types.Object:
    """Add the frame's camera."""
    data = bpy.data.cameras.new("Frame Camera")
    data.sensor_fit, data.lens_unit, data.angle = "HORIZONTAL", "FOV", math.radians(FOV_DEG)
    data.clip_start = 0.02
    camera = bpy.data.objects.new(data.name, data)
    camera.location = EYE
    camera.rotation_euler = (Vector(TARGET) - Vector(EYE)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    return camera


def _ball(scene, name, place, radius, material):
    mesh = bmesh.new()
    bmesh.ops.create_icosphere(mesh, subdivisions=6, radius=radius)
    return _add(scene, name, mesh, (*place, radius), material)


def _carafe(scene, base):
    """A turned profile: up the outside, over a rounded lip, down the inside."""
    outside = _smooth(np.array(CARAFE_OUTSIDE), 48)
    ring = outside[1:]
    tangents = np.gradient(ring, axis=0)
    inwards = np.column_stack([-tangents[:, 1], tangents[:, 0]]) / np.linalg.norm(tangents, axis=1)[:, None]
    inside = ring + inwards * CARAFE_WALL
    inside = inside[(inside[:, 0] > 0) & (inside[:, 1] > 2 * CARAFE_WALL)]
    lip = (ring[-1] + inside[-1]) / 2 + (0, CARAFE_WALL / 2)
    floor = np.array([[0, inside[0, 1]]])
    profile = np.vstack([outside, lip[None], inside[::-1], floor])
    glass = _principled("Glass", (0.97, 1.0, 0.985), roughness=0, transmission=1, ior=1.5)
    return _add(scene, "Carafe", _revolved(profile, 96), base, glass)


def _knot(scene, base):
    """A trefoil knot lying flat, glazed."""
    t = np.linspace(0, 2 * np.pi, 384, endpoint=False)
    line = np.column_stack(
        [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -1.1 * np.sin(3 * t)]
    ) * (KNOT_RADIUS / 2)
    mesh = _tube(line, KNOT_TUBE, 32)
    lowest = min(vertex.co.z for vertex in mesh.verts)
    glaze = _principled("Glaze", (0.02, 0.13, 0.2), roughness=0.35, coat=1)
    return _add(scene, "Knot", mesh, (base[0], base[1], base[2] - lowest), glaze)


def _smooth(points, count):
    """``count`` points along a Catmull-Rom curve through (n, 2) points, the first kept sharp."""
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    at = np.linspace(0, len(points) - 1, count)
    k = np.minimum(at.astype(int), len(points) - 2)
    s = (at - k)[:, None]
    a, b, c, d = (padded[k + i] for i in range(4))
    return 0.5 * (2 * b + (c - a) * s + (2 * a - 5 * b + 4 * c - d) * s**2 + (3 * (b - c) + d - a) * s**3)


def _revolved(profile, segments):
    """A mesh of a (radius, height) profile turned about z; points on the axis become one vertex."""
    mesh = bmesh.new()
    turns = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    rings = []
    for radius, height in profile:
        if radius < 1e-6:
            rings.append([mesh.verts.new((0, 0, height))] * segments)
        else:
            rings.append(
                [mesh.verts.new((radius * math.cos(a), radius * math.sin(a), height)) for a in turns]
            )
    _skin(mesh, rings, closed=False)
    return mesh


def _tube(line, radius, segments):
    """A round tube along a closed line (n, 3), its rings carried along without twist but the closing one."""
    tangents = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    sides = np.cross(tangents, (0, 0, 1))  # the line is nowhere upright
    sides /= np.linalg.norm(sides, axis=1)[:, None]
    ups = np.cross(sides, tangents)
    turns = np.linspace(0, 2 * np.pi, segments, endpoint=False)[:, None]
    mesh = bmesh.new()
    rings = [
        [mesh.verts.new(point) for point in centre + radius * (np.cos(turns) * side + np.sin(turns) * up)]
        for centre, side, up in zip(line, sides, ups, strict=True)
    ]
    _skin(mesh, rings, closed=True)
    return mesh


def _skin(mesh, rings, closed):
    following = rings[1:] + rings[:1] if closed else rings[1:]
    for ring, above in zip(rings, following, strict=False):
        for i in range(len(ring)):
            j = (i + 1) % len(ring)
            corners = list(dict.fromkeys([ring[i], ring[j], above[j], above[i]]))
            if len(corners) > 2:
                mesh.faces.new(corners)
    bmesh.ops.recalc_face_normals(mesh, faces=mesh.faces)


def _add(scene, name, mesh, location, material):
    for face in mesh.faces:
        face.smooth = True
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    scene.collection.objects.link(thing)
    return thing


def _principled(
    name, colour, *, metal=0.0, roughness=0.5, specular=0.5, transmission=0.0, ior=1.45, coat=0.0
):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*colour, 1)
    inputs["Metallic"].default_value = metal
    inputs["Roughness"].default_value = roughness
    inputs["IOR"].default_value = ior
    inputs["Specular IOR Level"].default_value = specular
    inputs["Transmission Weight"].default_value = transmission
    inputs["Coat Weight"].default_value = coat
    inputs["Coat Roughness"].default_value = 0.05
    return material
