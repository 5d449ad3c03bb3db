"""A closed synthetic room whose every truth is known: the measuring rod of the whole pipeline.

The room is 5 m × 4 m × 2.7 m, lit by a window and by ceiling lamps, in two variants: ``LARGE_LAMPS`` (two
panels of 0.9 m × 0.6 m) and ``SMALL_LAMPS`` (five squares of 10 cm that give about the same light). All its
materials are diffuse, so a panorama of it holds all there is to know about its surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy

SIZE = (5.0, 4.0, 2.7)
CENTRE = (0.4, -0.3)
"""The room's middle on the floor [m]; the panorama is captured at x = y = 0, off the middle."""
CAMERA_HEIGHT = 1.5
LARGE_LAMPS, SMALL_LAMPS = "large", "small"


@dataclass(frozen=True)
class Box:
    """An upright box on the floor: middle of its base, size and turn about z."""

    name: str
    centre: tuple[float, float]
    size: tuple[float, float, float]
    turn: float
    """[rad]"""
    colours: tuple[tuple[float, float, float], tuple[float, float, float]]


TABLE = Box("table", (1.55, 0.45), (0.9, 0.7, 0.55), 0.25, ((0.36, 0.2, 0.1), (0.26, 0.14, 0.07)))
CABINET = Box("cabinet", (-1.65, -1.55), (0.9, 0.55, 1.2), 0.0, ((0.12, 0.25, 0.42), (0.1, 0.2, 0.34)))
COLUMN_CENTRE, COLUMN_RADIUS, COLUMN_HEIGHT = (0.9, -1.75), 0.22, 2.0
RUG_CENTRE, RUG_SIZE = (1.15, -0.65), (1.5, 1.2)


def build_room(scene: bpy.types.Scene, lamps: str) -> bpy.types.Collection:
    """Build the real room, with its true materials and lights, in a collection of its own."""
    if lamps not in (LARGE_LAMPS, SMALL_LAMPS):
        raise ValueError(f"lamps is {lamps!r}; expected {LARGE_LAMPS!r} or {SMALL_LAMPS!r}")
    room = bpy.data.collections.new("Real room")
    scene.collection.children.link(room)
    _shell(room)
    _window(room)
    _ceiling_lamps(room, lamps)
    for box in (TABLE, CABINET):
        _add(
            room,
            box.name,
            *_box_mesh(box.size),
            _checker(box.name, *box.colours, scale=0.18),
            location=(*box.centre, box.size[2] / 2),
            turn=box.turn,
        )
    _column(room)
    _add(
        room,
        "rug",
        *_rectangle_mesh(RUG_SIZE),
        _checker("rug", (0.5, 0.1, 0.08), (0.62, 0.5, 0.32), scale=0.3),
        location=(*RUG_CENTRE, 0.002),
    )
    scene.world = bpy.data.worlds.new("Black")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 0, 0, 1)
    return room


def floor_corners() -> tuple[tuple[float, float], ...]:
    """The four corners of the floor [m], counter-clockwise."""
    (cx, cy), (sx, sy) = CENTRE, SIZE[:2]
    return (
        (cx - sx / 2, cy - sy / 2),
        (cx + sx / 2, cy - sy / 2),
        (cx + sx / 2, cy + sy / 2),
        (cx - sx / 2, cy + sy / 2),
    )


def _shell(room):
    (x0, y0), _, (x1, y1), _ = floor_corners()
    z = SIZE[2]
    sides = {
        "floor": (
            [(x0, y0, 0), (x1, y0, 0), (x1, y1, 0), (x0, y1, 0)],
            (0.42, 0.33, 0.24),
            (0.3, 0.22, 0.15),
            0.5,
        ),
        "ceiling": (
            [(x0, y0, z), (x0, y1, z), (x1, y1, z), (x1, y0, z)],
            (0.78, 0.78, 0.76),
            (0.74, 0.74, 0.72),
            1.2,
        ),
        "wall south": (
            [(x0, y0, 0), (x0, y0, z), (x1, y0, z), (x1, y0, 0)],
            (0.66, 0.58, 0.45),
            (0.6, 0.5, 0.38),
            0.6,
        ),
        "wall east": (
            [(x1, y0, 0), (x1, y0, z), (x1, y1, z), (x1, y1, 0)],
            (0.45, 0.6, 0.5),
            (0.36, 0.52, 0.42),
            0.5,
        ),
        "wall north": (
            [(x1, y1, 0), (x1, y1, z), (x0, y1, z), (x0, y1, 0)],
            (0.7, 0.68, 0.64),
            (0.62, 0.56, 0.5),
            0.7,
        ),
        "wall west": (
            [(x0, y1, 0), (x0, y1, z), (x0, y0, z), (x0, y0, 0)],
            (0.62, 0.36, 0.3),
            (0.5, 0.3, 0.26),
            0.6,
        ),
    }
    for name, (corners, first, second, scale) in sides.items():
        _add(room, name, corners, [(0, 1, 2, 3)], _checker(name, first, second, scale))


def _window(room):
    _, (x1, y0), _, _ = floor_corners()
    x = x1 - 0.002
    corners = [(x, y0 + 1.2, 0.9), (x, y0 + 1.2, 2.1), (x, y0 + 2.6, 2.1), (x, y0 + 2.6, 0.9)]
    _add(room, "window", corners, [(0, 1, 2, 3)], _emission("window", (2.6, 3.0, 3.6)))


def _ceiling_lamps(room, lamps):
    z = SIZE[2] - 0.002
    if lamps == LARGE_LAMPS:
        size, centres, radiance = (0.9, 0.6), [(-0.9, -0.9), (1.5, 0.4)], (9.0, 8.0, 6.2)
    else:
        size, radiance = (0.1, 0.1), (190.0, 168.0, 130.0)
        centres = [(-1.2, -1.2), (-1.0, 0.6), (0.4, 0.9), (2.0, -1.3), (1.7, 0.6)]
    for number, (x, y) in enumerate(centres):
        _add(
            room,
            f"lamp {number}",
            *_rectangle_mesh(size, down=True),
            _emission(f"lamp {number}", radiance),
            location=(x, y, z),
        )


def _column(room):
    import math

    n = 48
    ring = [
        (COLUMN_RADIUS * math.cos(2 * math.pi * k / n), COLUMN_RADIUS * math.sin(2 * math.pi * k / n))
        for k in range(n)
    ]
    vertices = [(x, y, 0) for x, y in ring] + [(x, y, COLUMN_HEIGHT) for x, y in ring]
    faces = [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)] + [tuple(range(n, 2 * n))]
    _add(
        room,
        "column",
        vertices,
        faces,
        _checker("column", (0.6, 0.56, 0.3), (0.48, 0.44, 0.26), 0.25),
        location=(*COLUMN_CENTRE, 0),
    )


def _box_mesh(size):
    x, y, z = (length / 2 for length in size)
    vertices = [
        (-x, -y, -z),
        (x, -y, -z),
        (x, y, -z),
        (-x, y, -z),
        (-x, -y, z),
        (x, -y, z),
        (x, y, z),
        (-x, y, z),
    ]
    return vertices, [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]


def _rectangle_mesh(size, down=False):
    x, y = size[0] / 2, size[1] / 2
    corners = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]
    return corners, [(3, 2, 1, 0) if down else (0, 1, 2, 3)]


def _add(room, name, vertices, faces, material, location=(0, 0, 0), turn=0.0):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    thing.location, thing.rotation_euler = location, (0, 0, turn)
    room.objects.link(thing)
    return thing


def _material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree.nodes, material.node_tree.links


def _checker(name, first, second, scale):
    """Two shades in squares of ``scale`` [m], faded into each other so that no pixel aliases."""
    material, nodes, links = _material(name)
    position = nodes.new("ShaderNodeTexCoord")
    waves = nodes.new("ShaderNodeTexChecker")
    waves.inputs["Color1"].default_value, waves.inputs["Color2"].default_value = (*first, 1), (*second, 1)
    waves.inputs["Scale"].default_value = 1 / scale
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    shift = nodes.new("ShaderNodeVectorMath")
    shift.inputs[1].default_value = (0.0371, 0.0193, 0.0127)
    links.new(position.outputs["Object"], shift.inputs[0])
    links.new(shift.outputs[0], waves.inputs["Vector"])
    links.new(waves.outputs["Color"], diffuse.inputs["Color"])
    links.new(diffuse.outputs[0], output.inputs["Surface"])
    return material


def _emission(name, radiance):
    material, nodes, links = _material(name)
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*radiance, 1)
    links.new(emission.outputs[0], output.inputs["Surface"])
    return material
