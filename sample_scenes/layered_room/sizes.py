"""The table of the sample room: where everything is and how large, in metres and degrees.

Places and sizes are ours: the thesis shows its room in pictures only. What Table 8.1's cameras look at there
is where they look here: a sofa before S1, S5 and S6, the statue before S2 and S9, the mirror before S3 and
S13, pictures and a sofa before S4 and S7, poufs before S11 and S12, lamps in the floor of S10.
"""

from __future__ import annotations

from typing import NamedTuple


class Room(NamedTuple):
    """The empty room: x to the east, y to the north, z up [m]."""

    west: float
    east: float
    south: float
    north: float
    height: float


class Piece(NamedTuple):
    """A piece of furniture on the floor; its front looks along +x before it is turned."""

    kind: str
    name: str
    centre: tuple[float, float]
    size: tuple[float, float, float]
    """Depth, width, height [m]."""
    turn_deg: float
    colour: tuple[float, float, float]


class Hung(NamedTuple):
    """A framed thing on a wall."""

    kind: str
    name: str
    wall: str
    middle: float
    """Of its width, along x or y in the world [m]."""
    sill: float
    """Height of its lower edge [m]."""
    size: tuple[float, float]
    """Width and height without the frame [m]."""


ORIGIN = (0.0, 0.0, 1.15)
"""Of the panorama (thesis, 6.2.1)."""
RADIUS = 1.0
"""All cameras of Table 8.1 stand within it [m]."""
ROOM = Room(west=-4.2, east=4.4, south=-3.6, north=3.6, height=2.9)
WALLS = ("west", "east", "south", "north")

SOFA, POUF, STATUE = "sofa", "pouf", "statue"
PIECES = (
    Piece(SOFA, "sofa north", (-0.95, 2.95), (0.92, 2.15, 0.78), -90, (0.10, 0.26, 0.30)),
    Piece(SOFA, "sofa east", (3.75, 1.45), (0.92, 1.75, 0.78), 180, (0.55, 0.16, 0.07)),
    Piece(POUF, "pouf west", (-2.35, -0.55), (0.66, 0.66, 0.42), 0, (0.62, 0.36, 0.06)),
    Piece(POUF, "pouf east", (2.25, 0.55), (0.58, 0.58, 0.40), 0, (0.62, 0.55, 0.44)),
    Piece(POUF, "pouf north", (0.75, 2.35), (0.52, 0.52, 0.38), 0, (0.42, 0.10, 0.12)),
    Piece(STATUE, "statue", (1.2, -3.0), (0.62, 0.80, 1.30), 112, (0.42, 0.29, 0.13)),
)

PICTURE, MIRROR, DOOR, SCREEN = "picture", "mirror", "door", "screen"
HUNG = (
    Hung(PICTURE, "hills left", "east", 2.27, 1.25, (0.62, 0.92)),
    Hung(PICTURE, "hills middle", "east", 1.45, 1.25, (0.62, 0.92)),
    Hung(PICTURE, "hills right", "east", 0.63, 1.25, (0.62, 0.92)),
    Hung(SCREEN, "screen", "east", -1.9, 0.35, (2.4, 1.95)),
    Hung(PICTURE, "circle", "north", -0.95, 1.25, (1.05, 1.05)),
    Hung(DOOR, "door", "north", 2.1, 0.0, (0.92, 2.08)),
    Hung(MIRROR, "mirror", "west", -1.55, 0.80, (1.45, 1.25)),
    Hung(PICTURE, "fields", "west", 1.55, 1.05, (1.30, 0.90)),
    Hung(PICTURE, "waves", "south", -2.0, 1.10, (1.50, 0.95)),
)
FRAME_WIDTH, FRAME_DEPTH = 0.055, 0.016
"""So flat that the origin sees every side of a frame: the room's depth has no jumps."""

RUG_CENTRE, RUG_SIZE, RUG_HEIGHT = (2.15, 1.0), (2.7, 2.1), 0.012
SKIRTING_HEIGHT, SKIRTING_DEPTH = 0.10, 0.014
DISC_CENTRE, DISC_RADIUS = (1.45, 1.45), 0.95
"""The gilded disc on the south wall behind the statue: x and z of its middle [m]."""
LAMPS = tuple((x, y) for x in (-3.1, -1.0, 1.2, 3.3) for y in (-1.8, 1.8))
LAMP_RADIUS, LAMP_RADIANCE, SCREEN_RADIANCE = 0.15, (30.0, 26.0, 20.0), (1.5, 1.55, 1.5)
"""Round lamps in the ceiling [m], and what they and the screen's paper emit."""
