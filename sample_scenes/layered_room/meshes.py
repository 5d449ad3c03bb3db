"""Shapes as (vertices, faces), faces counter-clockwise from outside [m]: what the room is built from."""

from __future__ import annotations

import math

import bmesh
import bpy
import numpy as np
from mathutils import Matrix


def rounded_box(size, radius, puff=0.0, cuts=14):
    """A box about (0, 0, 0) with round edges whose faces swell by ``puff`` at their middle [m]."""
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=2)
    bmesh.ops.subdivide_edges(mesh, edges=mesh.edges, cuts=cuts, use_grid_fill=True)
    unit = np.array([v.co for v in mesh.verts])
    mesh.verts.index_update()
    faces = [tuple(v.index for v in face.verts) for face in mesh.faces]
    mesh.free()
    half = np.asarray(size, dtype=float) / 2
    core = half - min(radius, *half)
    # Crowd the vertices towards the edges: that is where the surface turns.
    near = np.sign(unit) * (1 - (1 - np.abs(unit)) ** 1.7) * half
    inner = np.clip(near, -core, core)
    outward = near - inner
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    swell = np.stack(
        [(1 - unit[:, (k + 1) % 3] ** 2) * (1 - unit[:, (k + 2) % 3] ** 2) for k in range(3)], axis=1
    )
    on_face = np.abs(unit) > 1 - 1e-6
    bulge = puff * np.where(on_face, np.sign(unit) * swell, 0)
    return inner + min(radius, *half) * outward + bulge, faces


def lathe(profile, segments=48, ribs=0, depth=0.0):
    """Turn (radius, z) points, bottom to top, round z; ``ribs`` creases of ``depth`` times the radius."""
    profile = np.asarray(profile, dtype=float)
    phi = 2 * np.pi * np.arange(segments) / segments
    lobes = 1 - depth * (1 - np.abs(np.sin(ribs * phi / 2)) ** 0.7) if ribs else np.ones(segments)
    ring = np.stack([np.cos(phi) * lobes, np.sin(phi) * lobes], axis=1)
    vertices = np.concatenate([np.column_stack([r * ring, np.full(segments, z)]) for r, z in profile])
    faces = [
        (row + k, row + (k + 1) % segments, row + segments + (k + 1) % segments, row + segments + k)
        for row in range(0, segments * (len(profile) - 1), segments)
        for k in range(segments)
    ]
    top = segments * (len(profile) - 1)
    caps = [tuple(reversed(range(segments))), tuple(range(top, top + segments))]
    return vertices, faces + caps


def ellipsoid(radii, centre, segments=24):
    """An ellipsoid with its axes along x, y, z."""
    theta = np.linspace(-np.pi / 2, np.pi / 2, segments // 2 + 1)[1:-1]
    vertices, faces = lathe(np.column_stack([np.cos(theta), np.sin(theta)]), segments)
    return vertices * radii + centre, faces


def limb(start, end, first_radius, last_radius, count=9):
    """Balls in a row from ``start`` to ``end``, to be fused: an arm or a leg."""
    share = np.linspace(0, 1, count)[:, None]
    centres = (1 - share) * np.asarray(start, float) + share * np.asarray(end, float)
    radii = (1 - share[:, 0]) * first_radius + share[:, 0] * last_radius
    return join(*(ellipsoid((r, r, r), centre, 16) for r, centre in zip(radii, centres, strict=True)))


def stepped_rings(rings):
    """Rectangles about (0, 0), each (half width, half height, z), joined in turn: frames and low blocks."""
    vertices = [(sx * w, sy * h, z) for w, h, z in rings for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    faces = [
        (4 * ring + k, 4 * ring + (k + 1) % 4, 4 * ring + 4 + (k + 1) % 4, 4 * ring + 4 + k)
        for ring in range(len(rings) - 1)
        for k in range(4)
    ]
    return np.array(vertices, dtype=float), faces


def rectangle(width, height, z=0.0):
    """A rectangle about (0, 0, z) that faces +z."""
    vertices, _ = stepped_rings([(width / 2, height / 2, z)])
    return vertices, [(0, 1, 2, 3)]


def disc(radius, z=0.0, segments=32):
    """A disc about (0, 0, z) that faces +z."""
    phi = 2 * np.pi * np.arange(segments) / segments
    vertices = np.column_stack([radius * np.cos(phi), radius * np.sin(phi), np.full(segments, z)])
    return vertices, [tuple(range(segments))]


def turned(shape, axis, angle_deg):
    """The shape, turned round an axis through (0, 0, 0)."""
    return shape[0] @ np.array(Matrix.Rotation(math.radians(angle_deg), 3, axis.upper())).T, shape[1]


def moved(shape, by):
    """The shape, moved."""
    return shape[0] + np.asarray(by, dtype=float), shape[1]


def join(*shapes):
    """Several shapes as one, not fused."""
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in shapes[:-1]])
    faces = [
        tuple(int(k + offset) for k in face)
        for (_, faces), offset in zip(shapes, offsets, strict=True)
        for face in faces
    ]
    return np.concatenate([vertices for vertices, _ in shapes]), faces


def add_object(collection, name, shape, material, matrix=None, *, smooth=False) -> bpy.types.Object:
    """Make an object of a shape; a mesh of one rectangle has UVs from its lower left to its upper right."""
    vertices, faces = shape
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices.tolist()], [], faces)
    if len(faces) == 1 and len(vertices) == 4:
        layer = mesh.uv_layers.new(name="UVMap")
        for corner, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
            corner.uv = uv
    if smooth:
        mesh.shade_smooth()
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    if matrix is not None:
        thing.matrix_world = matrix
    collection.objects.link(thing)
    return thing
