"""The picking tool: points of the calibration's picks, set and moved on the panorama wherever it shows."""

from __future__ import annotations

import copy

import numpy as np

from ...ibl_toolkit.corner_snap import Snap, snap_to_corner
from ...ibl_toolkit.equirectangular import direction_from_uv, uv_from_direction
from ..canvas import ViewCanvas
from . import base
from .lengths import Lengths, typed_character
from .picks_copy import Live, solve_live
from .picks_editing import PicksEditing

GRAB_PIXELS = 12
"""How near to a point a press takes hold of it [px of the screen at a UI scale of 1] …"""
SHARE_PIXELS = 5
"""… while there are points to be set: beyond, the next one is set. A click without a drag shares it."""
STILL_PIXELS = 2
"""A press that moves less than this only selects [px of the screen]."""
SNAP_PIXELS = 6
"""How far from a click corners are looked for [px of the screen at a UI scale of 1] …"""
SNAP_ROWS = (1.5, 12)
"""… but at least and at most so far [px of the image]."""
PRESSES = ("PRESS", "DOUBLE_CLICK")
ARROWS = {"LEFT_ARROW": (-1, 0), "RIGHT_ARROW": (1, 0), "UP_ARROW": (0, 1), "DOWN_ARROW": (0, -1)}
BLENDERS_OWN = ("N", "T")
"""Letters that reach the editor: its sidebar and toolbar. Others would move or delete objects behind."""
METRES = Lengths("METRIC", "m", 1.0)


class PickTool(base.Tool):
    """Edits a copy of all picks.

    image: (H, W, 3) linear radiance, for corners and the magnifier; None where there is none to read.
    lengths: the units in which the scale is typed.
    """

    label = "Pick Points"
    keys = (
        ("MOUSE_LMB", "Set / Drag"),
        ("EVENT_CTRL", "Snap the Other Way"),
        ("EVENT_S", "Snap to Corners"),
        ("EVENT_TAB", "Next Point"),
        ("EVENT_P", "Plane / Axis"),
        ("EVENT_LEFT_ARROW", "Nudge (Shift: Finer)"),
        ("EVENT_X", "Delete Point"),
        ("EVENT_RETURN", "Confirm"),
        ("EVENT_ESC", "Cancel"),
    )

    def __init__(self, editing: PicksEditing, image_size, *, image=None, lengths=METRES, ui_scale=1.0):
        """Begin with what `editing` says."""
        super().__init__()
        self.editing, self.image_size, self.image = editing, tuple(image_size), image
        self.lengths, self.ui_scale, self.snapping, self.typed = lengths, ui_scale, True, ""
        self._pressed_at, self._held_from = None, None
        self._solved = (None, None)
        self.scene_name, self.image_path, self.settings = "", "", ()  # of whom the picks are

    @property
    def live(self) -> Live:
        """What the picks give as they are now; solved again when it is asked for after a change."""
        if self._solved[0] != self.editing.copied:
            copied = copy.deepcopy(self.editing.copied)
            self._solved = copied, solve_live(copied, self.image_size)
        return self._solved[1]

    def snapped(self, on, xy, other_way=False) -> Snap | None:
        """Where a click at (2,) [px] of a canvas goes: to a corner near it, or just there; None off it."""
        uv = on.uv_at(xy)
        if uv is None or self.image is None or self.snapping == other_way:
            return None if uv is None else Snap(uv, 0.0)
        rows = SNAP_PIXELS * self.ui_scale * _rows_per_pixel(on, xy, self.image.shape[0])
        return snap_to_corner(self.image, uv, float(np.clip(rows, *SNAP_ROWS)))

    def state(self):
        """A copy of the picks."""
        return copy.deepcopy(self.editing)

    def restore(self, state):
        """Set it again; what was held is let go."""
        self.editing, self.dragged = state, None
        self._stop_typing()

    def handle(self, on, xy, event):
        """Use an event."""
        if self.dragged is not None:
            return self._drag(on, xy, event)
        if event.value not in PRESSES or event.type.endswith("MOUSEMOVE"):
            return base.RUNNING if event.type in base.MOUSE else base.PASS
        if event.type in ("RET", "NUMPAD_ENTER"):
            return base.CONFIRM
        if event.type in ("ESC", "RIGHTMOUSE"):
            return base.CANCEL
        if on is None:
            return base.PASS
        if event.type == "LEFTMOUSE":
            self._press(on, xy, event)
            return base.RUNNING
        return self._key(on, event)

    def _key(self, on, event):
        if self._type(event):  # first, since letters may belong to a unit
            return base.RUNNING
        if event.type in ARROWS:
            self._nudge(on, np.array(ARROWS[event.type], float) * (0.1 if event.shift else 1))
        elif event.type == "TAB":
            self.editing.select_next(-1 if event.shift else 1)
        elif event.type in ("X", "DEL") and not event.ctrl:
            self._delete()
        elif event.type == "P" and self.editing.has_plane:
            self.push()
            self.editing.next_plane()
        elif event.type == "S" and not event.ctrl:
            self.snapping = not self.snapping
        else:
            swallowed = len(event.type) == 1 and not event.ctrl and event.type not in BLENDERS_OWN
            return base.RUNNING if swallowed else base.PASS
        return base.RUNNING

    def _press(self, on, xy, event):
        self.problem = ""
        self._stop_typing()
        place, reason = self._next()
        index, offset = self._near(on, xy, GRAB_PIXELS if place is None else SHARE_PIXELS), np.zeros(2)
        if index is not None:
            self.push()
            self.editing.select(index)
            offset = on.pixels_of(np.array(self.editing.point(index).uv)) - xy
        else:
            snap = self.snapped(on, xy, event.ctrl)
            if place is None or snap is None:
                self.problem = reason
                return
            index = place
            self.push()
            self.editing.set_point(index, snap.uv)
        self.dragged, self._pressed_at, self._held_from = index, np.array(xy), offset

    def _drag(self, on, xy, event):
        if event.type in ("ESC", "RIGHTMOUSE") and event.value in PRESSES:
            self._put_back(self.dragged)
        elif event.type == "LEFTMOUSE" and event.value == "RELEASE":
            held, self.dragged = self.dragged, None
            if self._past and self._past[-1].copied == self.editing.copied:
                self._put_back(held, shared=True)
        elif event.type in base.MOUSE and on is not None:
            moved = self._pressed_at is None or np.linalg.norm(xy - self._pressed_at) > STILL_PIXELS
            snap = self.snapped(on, xy + self._held_from, event.ctrl) if moved else None
            if snap is not None:
                self._pressed_at = None
                self.editing.point(self.dragged).set(snap.uv)
        return base.RUNNING

    def _put_back(self, held, *, shared=False):
        """Undo a press on a point and select it; or, if it may be shared, set the next point there, too."""
        self.undo()
        self._future.clear()
        place, _ = self._next()
        if shared and place is not None and held[0] != self.editing.target:
            self.push()
            self.editing.set_point(place, self.editing.point(held).uv)
        elif self.editing.has(held):
            self.editing.select(held)

    def _next(self):
        """Where the next click goes (pick, point), or None and why nowhere."""
        try:
            return self.editing.next_missing(), ""
        except ValueError as error:
            return None, str(error)

    def _near(self, on, xy, reach):
        """The point under the mouse, or None; reach [px of the screen at a UI scale of 1]."""
        indices, uv = self.editing.places()
        apart = np.linalg.norm(on.pixels_of(uv) - xy, axis=-1)
        reached = np.flatnonzero(apart <= reach * self.ui_scale)  # NaN is not
        return indices[reached[apart[reached].argmin()]] if len(reached) else None

    def _delete(self):
        if self.editing.active is not None:
            self.push()
            self.editing.delete()

    def _nudge(self, on, arrow):
        """Move the active point by an arrow (2,) [px of the image], rightwards and upwards as it is seen."""
        if self.editing.active is None:
            return
        self.push()
        point, (width, height) = self.editing.point(self.editing.active), self.image_size
        uv = np.array(point.uv)
        xy = on.pixels_of(uv)
        beside = on.uv_at(xy + arrow / np.linalg.norm(arrow)) if np.isfinite(xy).all() else None
        if isinstance(on, ViewCanvas) and beside is not None:
            point.set(_turned(uv, beside, np.linalg.norm(arrow) * np.pi / height))
        else:
            point.set(uv + arrow * (1 / width, -1 / height))

    def _type(self, event):
        """Whether an event was a digit of the scale: of the known length, or else of the camera height."""
        character = typed_character(event, self.typed)
        if event.type == "BACK_SPACE" and self.typed:
            text = self.typed[:-1]
        elif character:
            text = self.typed + character
        else:
            return False
        if not self.typed:
            self.push()
        self.typed, self.takes_numbers, self.problem = text, bool(text), ""
        try:
            self.editing.set_scale(self.lengths.value(text) if text else 0.0)
        except ValueError as error:
            self.problem = str(error)
        return True

    def _stop_typing(self):
        self.typed, self.takes_numbers = "", False


def _rows_per_pixel(on, xy, height):
    """How many rows of the image a pixel of the screen covers; 1 at the image's border."""
    here, beside = on.uv_at(xy), on.uv_at((xy[0] + 1, xy[1]))
    if here is None or beside is None:
        return 1.0
    return float(np.linalg.norm(direction_from_uv(beside) - direction_from_uv(here)) * height / np.pi)


def _turned(uv, towards, angle):
    """The image point (2,) at an angle [rad] from another, in the direction of a third."""
    a, b = direction_from_uv(uv), direction_from_uv(towards)
    side = b - (a @ b) * a
    return uv_from_direction(np.cos(angle) * a + np.sin(angle) * side / np.linalg.norm(side))
