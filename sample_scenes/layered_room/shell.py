"""The back layer: walls, floor and ceiling, what hangs on them, and the lamps.

Nothing stands out so far or so steeply that it hides anything from the origin: one layer holds it all.
"""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from . import art, materials, meshes, sizes
from .sizes import ROOM

_AXES = {
    "west": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "east": ((0, -1, 0), (0, 0, 1), (-1, 0, 0)),
    "south": ((-1, 0, 0), (0, 0, 1), (0, 1, 0)),
    "north": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "ceiling": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "floor": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}
"""A side's right and up, as seen from inside, and its normal."""
_OAK, _DARK_OAK, _BLACK_WOOD = (0.30, 0.165, 0.075), (0.20, 0.105, 0.045), (0.035, 0.022, 0.016)
_PLASTER, _WHITE, _GOLD = (0.62, 0.57, 0.49), (0.74, 0.73, 0.70), (0.56, 0.37, 0.11)
_SATIN, _POLISH = materials.Gloss(0.25), materials.Gloss(0.06)


def build_shell(collection: bpy.types.Collection, finish: str):
    """Build the empty room, and all that is on its walls, floor and ceiling."""
    _sides(collection, finish)
    _rug(collection)
    for side in sizes.WALLS:
        _skirting(collection, side, materials.surface(f"skirting {side}", _WHITE, finish, _SATIN))
    for thing in sizes.HUNG:
        _hang(collection, thing, finish)
    _disc(collection, finish)
    _lamps(collection)


def side_matrix(side: str, right: float = 0.0, up: float = 0.0) -> Matrix:
    """The frame of a point on a wall, the floor or the ceiling: +x right, +y up, +z into the room.

    right, up: world coordinates of the point [m]: along the wall and z; of floor and ceiling x and y.
    """
    rotation = Matrix(_AXES[side]).transposed().to_4x4()
    points = {
        "west": (ROOM.west, right, up),
        "east": (ROOM.east, right, up),
        "south": (right, ROOM.south, up),
        "north": (right, ROOM.north, up),
        "ceiling": (right, up, ROOM.height),
        "floor": (right, up, 0),
    }
    return Matrix.Translation(points[side]) @ rotation


def side_span(side: str) -> tuple[float, float]:
    """First and last coordinate of a wall, along x or y [m]."""
    return (ROOM.south, ROOM.north) if side in ("west", "east") else (ROOM.west, ROOM.east)


def _sides(collection, finish):
    south = art.circles((ROOM.east - ROOM.west, ROOM.height))
    colours = {
        "floor": (materials.planks(_OAK, _DARK_OAK), _POLISH),
        "ceiling": (materials.woven(_WHITE, scale=3, depth=0.03), None),
        "south": (materials.painted(south, "circles"), None),
        "west": (materials.woven(_PLASTER, scale=2.5, depth=0.10), None),
        "east": (materials.woven((0.50, 0.53, 0.46), scale=2.5, depth=0.10), None),
        "north": (materials.woven(_PLASTER, scale=2.5, depth=0.10), None),
    }
    for side, (colour, gloss) in colours.items():
        if side in sizes.WALLS:
            (first, last), height = side_span(side), ROOM.height
            matrix = side_matrix(side, (first + last) / 2, height / 2)
        else:
            (first, last), height = side_span("north"), ROOM.north - ROOM.south
            matrix = side_matrix(side, (first + last) / 2, (ROOM.north + ROOM.south) / 2)
        material = materials.surface(side, colour, finish, gloss)
        meshes.add_object(collection, side, meshes.rectangle(last - first, height), material, matrix)


def _rug(collection):
    (width, depth), high, slope = sizes.RUG_SIZE, sizes.RUG_HEIGHT, 0.03
    matrix = side_matrix("floor", *sizes.RUG_CENTRE)
    inner = width - 2 * slope, depth - 2 * slope
    rings = [(width / 2, depth / 2, 0), (inner[0] / 2, inner[1] / 2, high)]
    hem = materials.surface("rug hem", (0.055, 0.105, 0.14))
    meshes.add_object(collection, "rug hem", meshes.stepped_rings(rings), hem, matrix)
    pattern = materials.surface("rug", materials.painted(art.rug(inner), "rug"))
    meshes.add_object(collection, "rug", meshes.rectangle(*inner, high), pattern, matrix)


def _skirting(collection, side, material):
    """Along a wall, but for what reaches down to the floor."""
    gaps = sorted(
        (
            thing.middle - thing.size[0] / 2 - sizes.FRAME_WIDTH,
            thing.middle + thing.size[0] / 2 + sizes.FRAME_WIDTH,
        )
        for thing in sizes.HUNG
        if thing.wall == side and thing.sill < sizes.SKIRTING_HEIGHT
    )
    first, last = side_span(side)
    ends = [first, *(end for gap in gaps for end in gap), last]
    high, deep = sizes.SKIRTING_HEIGHT, sizes.SKIRTING_DEPTH
    for start, end in zip(ends[::2], ends[1::2], strict=True):
        half = (end - start) / 2
        vertices = [(s * half, y, z) for y, z in ((0, deep), (0.75 * high, deep), (high, 0)) for s in (-1, 1)]
        shape = np.array(vertices), [(0, 1, 3, 2), (2, 3, 5, 4)]
        meshes.add_object(collection, f"skirting {side}", shape, material, side_matrix(side, start + half))


def _hang(collection, thing, finish):
    (width, height), frame = thing.size, sizes.FRAME_WIDTH
    matrix = side_matrix(thing.wall, thing.middle, thing.sill + height / 2)
    moulding = _moulding(width, height, frame, sizes.FRAME_DEPTH)
    wood = _GOLD if thing.kind == sizes.MIRROR else _WHITE if thing.kind == sizes.DOOR else _BLACK_WOOD
    framed = materials.surface(f"{thing.name} frame", wood, finish, _SATIN)
    meshes.add_object(collection, f"{thing.name} frame", moulding, framed, matrix)
    pane = meshes.rectangle(width, height, 0.003)
    meshes.add_object(collection, thing.name, pane, _pane_material(thing, finish), matrix)
    if thing.kind == sizes.DOOR:
        _panels(collection, thing, framed, matrix)


def _moulding(width, height, frame, depth, z=0.003):
    """A frame round an opening: up from the wall, over a ridge, and down to the pane."""
    rings = ((frame, 0.0), (0.45 * frame, depth), (0.3 * frame, depth), (0.0, z))
    return meshes.stepped_rings([(width / 2 + out, height / 2 + out, high) for out, high in rings])


def _pane_material(thing, finish):
    size = thing.size
    if thing.kind == sizes.MIRROR and finish == materials.SHINY:
        return materials.looking_glass(thing.name)
    if thing.kind == sizes.SCREEN:
        return materials.lit_paper(thing.name, sizes.SCREEN_RADIANCE, art.lattice(size), _BLACK_WOOD)
    if thing.kind == sizes.DOOR:
        return materials.surface(thing.name, (0.66, 0.64, 0.58), finish, _SATIN)
    paint = {
        "hills left": lambda: art.hills(size, 0.0),
        "hills middle": lambda: art.hills(size, 0.72),
        "hills right": lambda: art.hills(size, 1.44),
        "circle": lambda: art.circle(size),
        "fields": lambda: art.fields(size),
        "waves": lambda: art.waves(size),
        "mirror": lambda: art.still_life(size),
    }[thing.name]
    return materials.surface(thing.name, materials.painted(paint(), thing.name))


def _panels(collection, door, material, matrix):
    """Mouldings of the door's four panels, and its knob."""
    width, height = door.size
    across = 0.30 * width
    for up, high in ((-0.26 * height, 0.32 * height), (0.20 * height, 0.44 * height)):
        for side in (-0.22 * width, 0.22 * width):
            panel = meshes.moved(_moulding(across, high, 0.035, 0.010), (side, up, 0.0))
            meshes.add_object(collection, "door panel", panel, material, matrix)
    knob = meshes.ellipsoid((0.028, 0.028, 0.016), (-0.43 * width, -0.03 * height, 0.008))
    brass = materials.surface("door knob", _GOLD)
    meshes.add_object(collection, "door knob", knob, brass, matrix, smooth=True)


def _disc(collection, finish):
    radius = sizes.DISC_RADIUS
    shape = meshes.lathe([(radius, 0.0), (radius - 0.04, 0.02), (radius - 0.08, 0.012)], 96)
    gilt = materials.surface(
        "disc", materials.woven(_GOLD, scale=5, depth=0.22), finish, materials.Gloss(0.35, metal=True)
    )
    meshes.add_object(collection, "disc", shape, gilt, side_matrix("south", *sizes.DISC_CENTRE))


def _lamps(collection):
    radius = sizes.LAMP_RADIUS
    rings, glow = materials.surface("lamp ring", _WHITE), materials.light("lamp", sizes.LAMP_RADIANCE)
    vertices, faces = meshes.lathe([(radius + 0.04, 0.0), (radius + 0.02, 0.008), (radius, 0.003)], 40)
    open_ring = vertices, faces[:-2]
    for number, place in enumerate(sizes.LAMPS):
        matrix = side_matrix("ceiling", *place)
        meshes.add_object(collection, f"lamp ring {number}", open_ring, rings, matrix)
        meshes.add_object(collection, f"lamp {number}", meshes.disc(radius, 0.003), glow, matrix)
