"""What an artist clicked to calibrate a panorama, and the errors that name a click."""

from dataclasses import dataclass, field

import numpy as np

PLANES = ("FLOOR", "CEILING", "WALL")
AXES = ("X", "Y")


class CalibrationError(ValueError):
    """Picks that give no trustworthy calibration; one line that names the pick and what would be right."""


def _picks(points, shape, what):
    """The points as a read-only float64 array of the given shape; a -1 stands for any number."""
    try:
        array = np.array(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise CalibrationError(f"{what}: picks must be numbers (u, v), got {points!r}") from None
    if array.size == 0 and -1 in shape:
        array = np.empty([0 if n == -1 else n for n in shape])
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        wanted = " × ".join("n" if n == -1 else str(n) for n in shape)
        raise CalibrationError(f"{what}: needs {wanted} numbers, got an array of shape {array.shape}")
    array.setflags(write=False)
    return array


def _metres(value, what):
    if value is None:
        return None
    try:
        metres = float(value)
    except (TypeError, ValueError):
        raise CalibrationError(f"{what} must be a number of metres above 0, got {value!r}") from None
    if not (np.isfinite(metres) and metres > 0.0):
        raise CalibrationError(f"{what} must be a number of metres above 0, got {value!r}")
    return metres


@dataclass(frozen=True, eq=False)
class Rectangle:
    """Four corners in order, either way round, of a rectangle of the place.

    points: (4, 2) picks (u, v). plane: FLOOR, CEILING or WALL; a WALL rectangle has two vertical sides,
    whichever they are. Raises CalibrationError.
    """

    points: np.ndarray
    plane: str = "FLOOR"

    def __post_init__(self):
        """Convert and check."""
        if self.plane not in PLANES:
            raise CalibrationError(f"rectangle: plane {self.plane!r} must be one of {', '.join(PLANES)}")
        object.__setattr__(self, "points", _picks(self.points, (4, 2), "rectangle"))


@dataclass(frozen=True, eq=False)
class Parallels:
    """Lines on the floor along one axis of the world.

    axis: X or Y. lines: (n, 2, 2), two picks (u, v) per line. Raises CalibrationError.
    """

    axis: str
    lines: np.ndarray

    def __post_init__(self):
        """Convert and check."""
        if self.axis not in AXES:
            raise CalibrationError(f"parallels: axis {self.axis!r} must be X or Y")
        object.__setattr__(self, "lines", _picks(self.lines, (-1, 2, 2), f"parallels {self.axis}"))


@dataclass(frozen=True, eq=False)
class KnownLength:
    """Two picks on the floor, points (2, 2), and the distance between them [m]. Raises CalibrationError."""

    points: np.ndarray
    metres: float

    def __post_init__(self):
        """Convert and check."""
        object.__setattr__(self, "points", _picks(self.points, (2, 2), "length"))
        metres = _metres(self.metres, "length: metres")
        if metres is None:
            raise CalibrationError("length: metres must be a number above 0, got None")
        object.__setattr__(self, "metres", metres)


@dataclass(frozen=True, eq=False)
class CalibrationPicks:
    """All that calibrates one panorama; exactly one of camera_height [m] and length gives the scale.

    rectangles and parallels are tuples, verticals is (n, 2, 2): two picks on each vertical line, in either
    order. Which of camera_height and length is there is checked by calibrate(), so that a half-finished
    set of picks can be kept.
    """

    rectangles: tuple[Rectangle, ...] = ()
    parallels: tuple[Parallels, ...] = ()
    verticals: np.ndarray = field(default_factory=lambda: np.empty((0, 2, 2)))
    camera_height: float | None = None
    length: KnownLength | None = None

    def __post_init__(self):
        """Convert and check."""
        object.__setattr__(self, "rectangles", tuple(self.rectangles))
        object.__setattr__(self, "parallels", tuple(self.parallels))
        object.__setattr__(self, "verticals", _picks(self.verticals, (-1, 2, 2), "verticals"))
        object.__setattr__(self, "camera_height", _metres(self.camera_height, "camera_height"))
