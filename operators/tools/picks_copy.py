"""A copy of a scene's picks as plain numbers, which a tool edits and writes back, and what it would give.

It has the fields of the scene's own properties, so that `conversion` and `progress` take either.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ...ibl_toolkit.calibration import Calibration, CalibrationError, ClickReport, calibrate_with_report
from .. import conversion, progress
from ..canvas import UNCALIBRATED

POINT_COUNT = {"RECTANGLE": 4}
"""Points of a new pick; 2 of all other kinds."""


@dataclass
class PointCopy:
    """A point: uv is (0, 0) until it is picked."""

    uv: tuple[float, float] = (0.0, 0.0)
    picked: bool = False

    def set(self, uv):
        """Put it somewhere, as precisely as the scene stores it; u wraps, v ends at the poles."""
        u, v = float(uv[0]) % 1.0, min(max(float(uv[1]), 0.0), 1.0)
        self.uv, self.picked = (conversion.number(u), conversion.number(v)), True

    def clear(self):
        """Make it missing again."""
        self.uv, self.picked = (0.0, 0.0), False


@dataclass
class PickCopy:
    """A pick; is_new: the scene does not have it yet."""

    kind: str
    plane: str = "FLOOR"
    axis: str = "X"
    metres: float = 0.0
    points: list[PointCopy] = field(default_factory=list)
    is_new: bool = False

    @classmethod
    def new(cls, kind, plane, axis):
        """A pick whose points are all missing."""
        points = [PointCopy() for _ in range(POINT_COUNT.get(kind, 2))]
        return cls(kind, plane, axis, points=points, is_new=True)

    @property
    def missing(self):
        """Indices of the points that are missing."""
        return [k for k, point in enumerate(self.points) if not point.picked]

    def complete(self):
        """The same with its complete lines only; None where nothing is complete."""
        if self.kind == "PARALLELS":
            pairs = zip(self.points[::2], self.points[1::2], strict=False)
            points = [point for pair in pairs for point in pair if pair[0].picked and pair[1].picked]
            return replace(self, points=points) if points else None
        return None if self.missing or (self.kind == "LENGTH" and not self.metres > 0) else self


@dataclass
class PicksCopy:
    """All picks of a set."""

    image_path: str
    picks: list[PickCopy]
    camera_height: float

    @classmethod
    def of(cls, state):
        """The scene's."""
        picks = [
            PickCopy(
                pick.kind,
                pick.plane,
                pick.axis,
                pick.metres,
                [PointCopy(tuple(conversion.number(x) for x in p.uv), p.picked) for p in pick.points],
            )
            for pick in state.picks
        ]
        return cls(state.image_path, picks, state.camera_height)

    def write(self, state):
        """Replace the scene's picks by these; new ones without any point are left out."""
        state.picks.clear()
        for pick in self.picks:
            if pick.is_new and len(pick.missing) == len(pick.points):
                continue
            stored = conversion.add_pick(state, pick.kind, [point.uv for point in pick.points])
            stored.plane, stored.axis, stored.metres = pick.plane, pick.axis, pick.metres
            for point, copied in zip(stored.points, pick.points, strict=True):
                point.picked = copied.picked  # `add_pick` has called them all picked
        state.calibration_is_old = True
        if conversion.number(state.camera_height) != conversion.number(self.camera_height):
            state.camera_height = self.camera_height

    def complete(self):
        """What of it can be solved; where the scale is missing, as if from an eye's height."""
        picks = [whole for pick in self.picks if (whole := pick.complete()) is not None]
        return PicksCopy(self.image_path, picks, self.camera_height or UNCALIBRATED[1])


@dataclass(frozen=True, eq=False)
class Live:
    """What picks give as they are: a calibration and its report, or a problem; and what is missing, or ""."""

    calibration: Calibration | None
    report: ClickReport | None
    problem: str
    missing: str


def solve_live(copied: PicksCopy, image_size) -> Live:
    """Solve what is complete of the picks on an image of (width, height)."""
    complete, missing = copied.complete(), progress.missing_of(copied)
    if not any(pick.kind in progress.ORIENTING for pick in complete.picks):
        return Live(None, None, "", missing)
    try:
        found = calibrate_with_report(conversion.picks_from_state(complete), image_size)
    except CalibrationError as error:
        return Live(None, None, str(error), missing)
    return Live(*found, "", missing)
