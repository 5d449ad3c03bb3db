"""The tool that draws shapes on the floor: what clicks, keys and moves of the mouse make of a shape.

It is plain Python; `draw_shape` runs it in Blender.
"""

from __future__ import annotations

import numpy as np

from ...ibl_toolkit.drawn_shape import on_floor
from .base import CANCEL, CONFIRM, PASS, RUNNING, Tool
from .draw_hints import hints
from .lengths import typed_character

GRAB = 9
"""How near to a point the mouse takes hold of it [px of a plain screen]."""
STILL = 3
"""Farthest move of a click [px of a plain screen]; beyond, it drags."""
TOP = "TOP"
MOVES = {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "LEFT_SHIFT", "RIGHT_SHIFT"}
PRESSED = {"PRESS", "DOUBLE_CLICK"}


class DrawTool(Tool):
    """Draws one shape, or a room.

    shape: the DrawnShape to begin with. lengths: Lengths of the scene. ui_scale: the interface's.
    """

    label = "Draw Shape"

    def __init__(self, shape, lengths, ui_scale=1.0):
        """Nothing is drawn yet."""
        super().__init__()
        self.shape, self.lengths, self.ui_scale = shape, lengths, ui_scale
        self.typed = ""
        self.cursor, self.top = None, None  # the floor (2,) and the upper edge (3,) last seen under the mouse
        self.refusal = ""  # why there is none under it now
        self.squares = False
        self._pressed_at, self._is_new = None, False  # where a press began, while it may be a click
        self._note_stage()

    @property
    def keys(self):
        """What the mouse and the keys do now."""
        return hints(self.shape, self.typed)

    def state(self):
        """What is drawn so far."""
        return self.shape.copy()

    def restore(self, state):
        """Set it, and forget what was typed."""
        self.shape = state.copy()
        self.typed, self.problem, self.dragged = "", "", None
        self._note_stage()

    def handle(self, on, xy, event):
        """Look where the mouse is, then do what the event says."""
        self._look(on, xy, event.shift)
        if event.type in MOVES:
            return self._drag(xy)
        if event.type == "LEFTMOUSE" and event.value == "RELEASE":
            return self._release()
        if event.value not in PRESSED:
            return PASS
        answer = RUNNING if self._type(event) else self._act(on, xy, event)
        self._note_stage()
        return answer

    def result(self, free_name):
        """The set's shapes that were drawn; see `DrawnShape.shapes`."""
        return self.shape.shapes(free_name, self.top, self._size())

    def preview(self):
        """What a click would make: (points, FloorShape or None, height [m] or None, problem)."""
        cursor = None if self.dragged is not None or (self.refusal and not self.typed) else self.cursor
        try:
            size = self._size()
            points, base = self.shape.preview(cursor, size, squares=self.squares)
        except ValueError as error:
            return self.shape.points, self.shape.base, None, str(error)
        height = None
        if self.shape.base is not None:
            height = size if size or self.refusal or self.top is None else float(self.top[2])
        return points, base, height, self.refusal if not self.typed else ""

    def refuse(self, problem):
        """Say why this shape can't be, and take back what made it whole."""
        if self.shape.base is None and self.shape.is_whole():
            self.undo()
        self.problem = problem

    def _note_stage(self):
        self.takes_numbers = bool(self.shape.points) or self.shape.base is not None

    def _act(self, on, xy, event):
        if event.type == "LEFTMOUSE":
            closes_twice = event.value == "DOUBLE_CLICK" and self.shape.base is not None
            return RUNNING if closes_twice else self._press(on, xy)
        actions = {
            "RIGHTMOUSE": lambda: CANCEL,
            "ESC": lambda: CANCEL,
            "RET": self._enter,
            "NUMPAD_ENTER": self._enter,
            "BACK_SPACE": self._take_back,
            "R": lambda: self._change(self.shape.next_role),
            "C": lambda: self._change(self.shape.toggle_ceiling),
        }
        if event.type in actions and not event.ctrl:
            return actions[event.type]()
        return PASS if on is None else RUNNING

    def _look(self, on, xy, squares):
        self.squares = squares or bool(self.typed and self.squares)  # a typed side stays square
        if on is None:
            return
        ray = on.ray_at(xy)
        try:
            if ray is None:
                raise ValueError("outside of the panorama")
            if self.shape.base is None:
                self.cursor = self.shape.stand.floor_under(*ray)
            else:
                self.top = self.shape.stand.above_base(*ray, self.shape.base)
            self.refusal = ""
        except ValueError as error:
            self.refusal = str(error)

    def _press(self, on, xy):
        self.problem = ""
        if on is None:
            return PASS
        if self.shape.base is not None:
            self.dragged = TOP
            return RUNNING
        held = self._held_at(on, xy)
        if held is None:
            was_typed = bool(self.typed)
            if not self._place():
                return RUNNING
            if was_typed:  # it is where the length says, not under the mouse
                return self._close_if_whole()
        self._pressed_at, self._is_new = np.array(xy), held is None
        self.dragged = len(self.shape.points) - 1 if held is None else held
        return RUNNING

    def _held_at(self, on, xy):
        """The number of the point under the mouse."""
        points = self.shape.stand.from_origin(on_floor(self.shape.points))
        away = [np.linalg.norm(on.curve_of(point[None])[0] - xy) for point in points]
        near = [index for index, pixels in enumerate(away) if pixels <= GRAB * self.ui_scale]
        return min(near, key=lambda index: away[index], default=None)

    def _drag(self, xy):
        if self.dragged in (None, TOP) or self.refusal or xy is None:
            return RUNNING
        if self._pressed_at is not None:
            if np.linalg.norm(xy - self._pressed_at) <= STILL * self.ui_scale:
                return RUNNING
            self._pressed_at = None
            if not self._is_new:
                self.push()
        self.shape.move(self.dragged, self.cursor, squares=self.squares)
        return RUNNING

    def _release(self):
        held, self.dragged = self.dragged, None
        if held is None:
            return PASS
        if held == TOP:
            return self._raise()
        is_click = self._pressed_at is not None and not self._is_new
        if is_click and held == 0 and self.shape.is_open_ended:
            return self._close()
        return self._close_if_whole()

    def _place(self):
        """Set a point where the mouse is, at the typed length; whether one was set."""
        try:
            size = self._size()
            if self.cursor is None or (self.refusal and size is None):
                raise ValueError(self.refusal or "move the mouse over the panorama")
            longer = self.shape.copy()
            longer.place(self.cursor, size, squares=self.squares)
        except ValueError as error:
            self.problem = str(error)
            return False
        self.push()
        self.shape, self.typed, self.problem = longer, "", ""
        return True

    def _close_if_whole(self):
        return self._close() if self.shape.is_whole() else RUNNING

    def _close(self):
        """The base is drawn: raise it, or be done."""
        try:
            base = self.shape.outline()
        except ValueError as error:
            self.refuse(str(error))
            return RUNNING
        if self.shape.is_flat:
            return CONFIRM
        if self.shape.is_open_ended:
            self.push()
        self.shape.base, self.top, self.refusal = base, None, "move up to raise it"
        self._note_stage()
        return RUNNING

    def _raise(self):
        try:
            if self._size() is None and self.refusal:
                raise ValueError(self.refusal)
        except ValueError as error:
            self.problem = str(error)
            return RUNNING
        return CONFIRM

    def _enter(self):
        if self.shape.base is not None:
            return self._raise()
        if not self.typed:
            return self._close()
        if not self._place():
            return RUNNING
        return self._close() if self.shape.flat == "circle" else self._close_if_whole()

    def _take_back(self):
        self.problem = ""
        if self.typed:
            self.typed = self.typed[:-1]
        elif self.takes_numbers:
            self._change(self.shape.take_back)
        return RUNNING

    def _change(self, change):
        self.push()
        change()
        return RUNNING

    def _type(self, event):
        character = typed_character(event, self.typed) if self.takes_numbers else ""
        if character:
            self.typed, self.problem = self.typed + character, ""
        return bool(character)

    def _size(self):
        return self.lengths.value(self.typed) if self.typed else None
