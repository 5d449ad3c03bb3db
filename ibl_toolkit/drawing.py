"""A shape while it is drawn on the floor: where its next point goes, its sides' lengths, its wireframe.

Points are (2,) on the floor of the world [m]; what they mean is what the set's shapes mean (floor_shapes).
Source: thesis, section 5.5.1.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from . import floor_shapes
from .outlines import cross

FLAT = ("polygon", "rectangle", "square", "circle")
BASES = {"room": "polygon", "box": "rectangle", "cylinder": "circle"}
"""Flat shapes over which the raised ones stand."""
FEWEST = {"polygon": 3, "rectangle": 3, "square": 2, "circle": 3}
OPEN_ENDED = ("polygon", "circle")
"""Those that take more points than they need; the others are whole with the last they need."""
CLOSING = 0.1
"""Share of a side's length by which it is lengthened or cut so that the side back to the start is square."""
MOST_UPRIGHTS = 8


def base_kind(kind) -> str:
    """The flat shape that is drawn first."""
    return BASES.get(kind, kind)


def floor_shape(kind, points, camera_height):
    """The FloorShape of a flat kind through points. Raises ValueError where they make none."""
    if kind == "circle":
        return floor_shapes.circle(points, camera_height)
    return {
        "polygon": floor_shapes.polygon,
        "rectangle": floor_shapes.rectangle,
        "square": floor_shapes.square,
    }[kind](points)


def is_whole(kind, points) -> bool:
    """Whether a flat kind has all points that it takes."""
    return kind not in OPEN_ENDED and len(points) >= FEWEST[kind]


def with_next(kind, points, cursor, size=None, *, squares=False):
    """The points once one is set at the cursor (2,) -> list of (2,).

    size [m]: length of the side, depth of the rectangle, side of the square or radius of the circle, whose
    direction is the cursor's; a circle is whole with its radius. squares: see `squared`.

    >>> with_next("polygon", [np.zeros(2)], np.array([3.0, 4.0]), 10.0)[-1].tolist()
    [6.0, 8.0]
    """
    points = list(points)
    if points and squares:
        cursor = squared(kind, points, cursor)
    if not points or size is None:
        return [*points, cursor]
    if kind == "circle":
        return _circle_points(points, cursor, size)
    if kind == "rectangle" and len(points) == 2:
        along = _unit(points[1] - points[0])
        normal = np.array([-along[1], along[0]])
        side = 1.0 if cross(along, cursor - points[0]) >= 0 else -1.0
        return [*points, points[1] + side * size * normal]
    length = size * np.sqrt(2) if kind == "square" else size
    return [*points, points[-1] + length * _unit(cursor - points[-1])]


def squared(kind, points, cursor):
    """The cursor (2,) moved so that the side from the last point runs along the world's axes, or along or
    square to a side before, whichever is nearest; sides of a square run along the world's axes.

    A polygon's side that ends almost where the side back to the first point would be square, ends there.
    """
    offset = cursor - points[-1]
    if kind == "circle" or not offset.any() or (kind == "rectangle" and len(points) > 1):
        return cursor
    azimuth = np.arctan2(offset[1], offset[0])
    allowed = np.array([np.pi / 4 if kind == "square" else 0.0])
    sides = np.diff(np.array(points), axis=0)
    allowed = np.append(allowed, np.arctan2(sides[:, 1], sides[:, 0]))
    turns = (azimuth - allowed + np.pi / 4) % (np.pi / 2) - np.pi / 4
    azimuth -= turns[np.argmin(np.abs(turns))]
    along = np.array([np.cos(azimuth), np.sin(azimuth)])
    length = offset @ along
    closing = (points[0] - points[-1]) @ along
    if len(points) > 2 and abs(closing - length) < CLOSING * abs(length):
        length = closing
    return points[-1] + length * along


def sizes(kind, points, shape=None):
    """What can be read and typed: (middle (2,), length [m]) of the sides, or of the circle's radius.

    shape: the FloorShape of the points, where they make one.
    """
    if kind == "circle":
        return [] if shape is None else [(shape.circle[0], shape.circle[1])]
    if kind == "square":
        return [] if shape is None else [(shape.outline[:2].mean(axis=0), float(shape.size_m[0]))]
    if kind == "rectangle" and shape is not None:
        points = shape.outline[:3]
    elif len(points) > 2:
        points = [*points, points[0]]
    return [((a + b) / 2, float(np.linalg.norm(b - a))) for a, b in pairwise(points)]


def wireframe(outline, height=None):
    """Lines (n, 3) [m] of an outline (n, 2) on the floor, and with a height [m] of what stands over it.

    >>> [len(line) for line in wireframe(np.array([[0, 0], [1, 0], [1, 1]]), 2.0)]
    [4, 4, 2, 2, 2]
    """
    ring = np.column_stack([outline, np.zeros(len(outline))])
    ring = np.vstack([ring, ring[:1]])
    if height is None:
        return [ring]
    top = np.add(ring, (0, 0, height))
    every = max(len(outline) // MOST_UPRIGHTS, 1) if len(outline) > 3 * MOST_UPRIGHTS else 1
    return [ring, top, *np.stack([ring, top], axis=1)[:-1:every]]


def _circle_points(points, cursor, radius):
    """Points on the circle of a radius: round the first in the cursor's direction, or through two on the
    cursor's side; more keep their circle's centre and their directions from it."""
    if len(points) == 1:
        centre = points[0] + radius * _unit(cursor - points[0])
        start = np.arctan2(*(points[0] - centre)[::-1])
        turns = start + np.arange(3) * (2 * np.pi / 3)
        return [centre + radius * np.array([np.cos(turn), np.sin(turn)]) for turn in turns]
    if len(points) > 2:
        centre = floor_shapes.fit_circle(points).centre
        return [centre + radius * _unit(point - centre) for point in points]
    half = (points[1] - points[0]) / 2
    short = np.linalg.norm(half)
    if short > radius:
        raise ValueError(
            f"a circle through two points {2 * short:.3g} m apart has a radius of {short:.3g} m at least"
        )
    along = _unit(half)
    normal = np.array([-along[1], along[0]]) * (1.0 if cross(along, cursor - points[0]) >= 0 else -1.0)
    rise = np.sqrt(radius**2 - short**2)
    centre = (
        points[0] + half + (rise if np.linalg.norm(cursor - points[0] - half) > short else -rise) * normal
    )
    return [*points, centre + radius * normal]


def _unit(vector):
    length = np.linalg.norm(vector)
    if not length:
        raise ValueError("move the mouse to say in which direction")
    return vector / length
