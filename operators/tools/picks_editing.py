"""Editing a copy of the picks: which point is next, selected, deleted; knows nothing of mouse or screen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...ibl_toolkit.calibration.picks import AXES, PLANES
from .. import conversion
from .picks_copy import PickCopy, PicksCopy, PointCopy


@dataclass
class PicksEditing:
    """The copy, the pick that is being filled (`target`, −1 for none) and the selected (pick, point).

    adds: the kind of lines that was begun anew: after one is complete, the next is begun.
    """

    copied: PicksCopy
    target: int = -1
    selected: tuple[int, int] | None = None
    adds: str = ""

    @property
    def active(self) -> tuple[int, int] | None:
        """(pick, point) of the selected point; None where none is, or it is missing."""
        is_there = self.selected is not None and self.has(self.selected) and self.point(self.selected).picked
        return self.selected if is_there else None

    def point(self, index) -> PointCopy:
        """The point of (pick, point)."""
        return self.copied.picks[index[0]].points[index[1]]

    def has(self, index) -> bool:
        """Whether there is a point (pick, point), picked or not."""
        pick, point = index
        return pick < len(self.copied.picks) and point < len(self.copied.picks[pick].points)

    def select(self, index):
        """Select (pick, point); its pick is filled next unless another still is."""
        try:
            self.next_missing()
        except ValueError:
            self.target = index[0]
        self.selected = index

    def begin(self, kind, plane, axis):
        """Fill a new pick."""
        self.copied.picks.append(PickCopy.new(kind, plane, axis))
        self.target, self.selected = len(self.copied.picks) - 1, None
        self.adds = kind if kind in ("VERTICAL", "PARALLELS") else ""

    def places(self):
        """All picked points: (pick, point) indices, and uv (n, 2)."""
        found = [
            ((i, k), point.uv)
            for i, pick in enumerate(self.copied.picks)
            for k, point in enumerate(pick.points)
            if point.picked
        ]
        return [index for index, _ in found], np.array([uv for _, uv in found]).reshape(-1, 2)

    def next_missing(self):
        """(pick, point) where the next click goes. Raises ValueError saying why nowhere."""
        if self.target < 0:
            raise ValueError("no pick is selected: begin one from the Add Pick menu")
        pick = self.copied.picks[self.target]
        if pick.missing:
            return self.target, pick.missing[0]
        if self.adds == pick.kind == "VERTICAL":
            return len(self.copied.picks), 0
        if self.adds == pick.kind == "PARALLELS":
            return self.target, len(pick.points)
        label = conversion.pick_label(pick, self.target)
        raise ValueError(f"{label} has all its points: drag one, or confirm")

    def set_point(self, index, uv):
        """Put a point of `next_missing` somewhere, and select it."""
        number, point = index
        if number == len(self.copied.picks):
            pick = self.copied.picks[self.target]
            self.copied.picks.append(PickCopy.new(pick.kind, pick.plane, pick.axis))
        points = self.copied.picks[number].points
        if point == len(points):
            points.extend((PointCopy(), PointCopy()))
        points[point].set(uv)
        self.target, self.selected = number, index

    def delete(self):
        """Make the selected point missing again; a new pick goes with its last point, a line as well."""
        self.target, point = self.active
        self.point((self.target, point)).clear()
        self.selected = None
        pick = self.copied.picks[self.target]
        if pick.kind == "PARALLELS":
            pairs = [pick.points[k : k + 2] for k in range(0, len(pick.points), 2)]
            kept = [pair for pair in pairs if any(point.picked for point in pair)] or pairs[:1]
            pick.points = [point for pair in kept for point in pair]
        empty = len(pick.missing) == len(pick.points)
        if pick.is_new and empty and any(other.is_new and other is not pick for other in self.copied.picks):
            del self.copied.picks[self.target]
            self.target = len(self.copied.picks) - 1

    def select_next(self, step=1):
        """Select the next picked point of all, or the one before."""
        indices, _ = self.places()
        if not indices:
            return
        if self.active in indices:
            self.select(indices[(indices.index(self.active) + step) % len(indices)])
        else:
            self.select(indices[0 if step > 0 else -1])

    @property
    def has_plane(self) -> bool:
        """Whether the pick that is being filled has a plane or an axis."""
        return self.target >= 0 and self.copied.picks[self.target].kind in ("RECTANGLE", "PARALLELS")

    def next_plane(self):
        """Let the rectangle lie in the next plane, the floor lines run along the other axis."""
        pick = self.copied.picks[self.target]
        if pick.kind == "RECTANGLE":
            pick.plane = PLANES[(PLANES.index(pick.plane) + 1) % len(PLANES)]
        else:
            pick.axis = AXES[(AXES.index(pick.axis) + 1) % len(AXES)]

    def set_scale(self, metres):
        """Set the known length, or the camera height where there is none [m]."""
        length = self.length
        if length is None:
            self.copied.camera_height = metres
        else:
            length.metres = metres

    @property
    def length(self) -> PickCopy | None:
        """The known length, if there is one."""
        return next((pick for pick in self.copied.picks if pick.kind == "LENGTH"), None)
