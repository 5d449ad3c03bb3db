"""A shape of the place while it is drawn: points on its floor, then how high it stands, then picks of a set.

It knows no mouse and no window; the tool that draws tells it where the floor or the upper edge is.
"""

from __future__ import annotations

import copy

import numpy as np

from . import drawing
from .panorama_set import ROLES, Shape

SUPPORT, ENVIRONMENT = ROLES
ROOM = "room"
"""A kind beside those of a set: a floor, a polygon, and walls with a ceiling over it."""


class DrawnShape:
    """What is drawn so far.

    kind: of a set's shapes, or ROOM. stand: the Stand of the panorama. over: name and FloorShape of the flat
    shape over which walls are raised. points: list of (2,) on the floor of the world [m]. base: FloorShape,
    once it is drawn and to be raised. roles: of the floor and of the walls of a room, else of the shape.
    """

    def __init__(self, kind, stand, over=(None, None)):
        """Nothing is drawn."""
        self.kind, self.flat, self.stand = kind, drawing.base_kind(kind), stand
        self.over, self.base = over
        self.points = []
        self.roles = {ROOM: [SUPPORT, ENVIRONMENT], "walls": [ENVIRONMENT]}.get(kind, [SUPPORT])
        self.ceiling = True

    def copy(self):
        """Another one with the same points, which change no more."""
        other = copy.copy(self)
        other.points, other.roles = list(self.points), list(self.roles)
        return other

    @property
    def is_flat(self):
        """Whether it isn't raised."""
        return self.kind in drawing.FLAT

    @property
    def is_open_ended(self):
        """Whether its base takes more points than it needs, so must be closed."""
        return self.flat in drawing.OPEN_ENDED

    @property
    def has_ceiling(self):
        """Whether it may have one."""
        return self.kind in (ROOM, "walls")

    def toggle_ceiling(self):
        """Close or open what has walls."""
        self.ceiling = not self.ceiling and self.has_ceiling

    @property
    def role(self):
        """The role of the part that is drawn now."""
        return self.roles[self._part]

    def next_role(self):
        """Give the part that is drawn now the other role."""
        self.roles[self._part] = ENVIRONMENT if self.role == SUPPORT else SUPPORT

    @property
    def _part(self):
        return 0 if self.base is None else -1

    def place(self, cursor, size=None, *, squares=False):
        """Set a point, as `drawing.with_next`. Raises ValueError where it can't be."""
        self.points = drawing.with_next(self.flat, self.points, cursor, size, squares=squares)

    def move(self, index, cursor, *, squares=False):
        """Move a point to the cursor (2,), or square to those before it."""
        before = self.points[:index]
        self.points[index] = drawing.squared(self.flat, before, cursor) if squares and before else cursor

    def is_whole(self):
        """Whether no more points are to be set."""
        return self.base is not None or drawing.is_whole(self.flat, self.points)

    def outline(self):
        """The FloorShape of the points. Raises ValueError where they make none."""
        missing = drawing.FEWEST[self.flat] - len(self.points)
        if missing > 0:
            raise ValueError(f"{missing} more point{'' if missing == 1 else 's'} needed")
        return drawing.floor_shape(self.flat, self.points, self.stand.camera_height)

    def preview(self, cursor, size=None, *, squares=False):
        """What it would be with a point at the cursor: (points, FloorShape or None).

        Raises ValueError where it would be nothing.
        """
        if self.base is not None:
            return self.points, self.base
        other = self.copy()
        if cursor is not None and not other.is_whole():
            other.place(cursor, size, squares=squares)
        if len(other.points) < drawing.FEWEST[self.flat]:
            return other.points, None
        try:
            return other.points, other.outline()
        except ValueError:
            if self.flat == "polygon":  # its sides may cross until its last corner is there
                return other.points, None
            raise

    def take_back(self):
        """Undo what was set last."""
        if self.over is not None:
            return
        was_raised, self.base = self.base is not None, None
        if not was_raised or not self.is_open_ended:
            self.points = self.points[:-1]

    def shapes(self, free_name, top=None, height=None):
        """The set's shapes that were drawn: tuple of Shape.

        free_name: gives a name that no shape has. top (3,): a point of the upper edge [m], or else its
        height [m], of what was raised. Raises ValueError where a top can't be picked.
        """
        picks = self.stand.uv_of(on_floor(self.points)) if self.points else None
        if self.is_flat:
            return (Shape(free_name(self.kind), self.kind, picks, role=self.role),)
        raised = {"top": self._top_pick(top)} if height is None else {"height": height}
        if not self.has_ceiling:
            return (Shape(free_name(self.kind), self.kind, picks, role=self.role, **raised),)
        floor, of = (), self.over
        if of is None:
            floor = (Shape(free_name("floor"), self.flat, picks, role=self.roles[0]),)
            of = floor[0].name
        walls = Shape(free_name("walls"), "walls", of=of, ceiling=self.ceiling, role=self.role, **raised)
        return (*floor, walls)

    def _top_pick(self, top):
        point = self.points[0] if self.kind == "box" else self.stand.upper_edge(self.base, top[:2])
        return self.stand.uv_of(np.array([*point, top[2]]))


def on_floor(points):
    """Points (n, 3) of the world at z = 0 [m] of (n, 2)."""
    points = np.asarray(points, np.float64).reshape(-1, 2)
    return np.column_stack([points, np.zeros(len(points))])
