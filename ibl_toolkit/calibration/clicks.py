"""The picks as one table of clicks: directions, what half a pixel is worth, and who uses which click."""

from dataclasses import dataclass

import numpy as np

from ..equirectangular import direction_from_uv
from .picks import CalibrationError

CLICK_ERROR_PIXELS = 0.5
# Half a pixel sideways covers a vanishing angle as a pick nears a pole of the image; taken literally, a click
# there would outweigh all others. No pick is trusted sideways 20 times more than one at the image's equator,
# which is so within 3° of a pole.
SMALLEST_COSINE = 0.05


@dataclass(frozen=True)
class Quad:
    """A rectangle in the table: indices (4,) of its clicks, its plane, its name in messages."""

    clicks: tuple[int, ...]
    plane: str
    name: str


@dataclass(frozen=True)
class Line:
    """A line in the table: its two clicks, the world axis (X, Y or Z) that it runs along, its name."""

    clicks: tuple[int, ...]
    axis: str
    name: str


@dataclass(frozen=True)
class Clicks:
    """Every distinct click once: one that serves two purposes has one error, not two.

    uv (n, 2): u in [0, 1). directions (n, 3): unit, panorama frame. tangents (n, 3, 2) [rad]: how the
    direction moves, to first order, when the click errs by half a pixel sideways and up or down; so an error
    in these coordinates has unit variance. names: one role of each click. length: the two clicks of the
    known length or None.
    """

    uv: np.ndarray
    directions: np.ndarray
    tangents: np.ndarray
    names: tuple[str, ...]
    quads: tuple[Quad, ...]
    lines: tuple[Line, ...]
    length: tuple[int, ...] | None

    def floor_clicks(self):
        """The indices of all clicks that lie on the floor, without repeats."""
        found = [k for quad in self.quads if quad.plane == "FLOOR" for k in quad.clicks]
        found += [k for line in self.lines if line.axis != "Z" for k in line.clicks]
        return list(dict.fromkeys(found + list(self.length or ())))

    def ceiling_clicks(self):
        """The indices of all clicks that lie on a ceiling, without repeats."""
        return list(dict.fromkeys(k for quad in self.quads if quad.plane == "CEILING" for k in quad.clicks))


class _Table:
    """Collects clicks; the same (u, v) gets the same index."""

    def __init__(self):
        self.index = {}
        self.names = []

    def add(self, points, name):
        return tuple(self._add_one(uv, f"{name}, point {k}") for k, uv in enumerate(points, start=1))

    def _add_one(self, uv, name):
        if not (np.all(np.isfinite(uv)) and np.all(uv >= 0.0) and np.all(uv <= 1.0)):
            raise CalibrationError(f"{name}: pick ({uv[0]:g}, {uv[1]:g}) must lie within 0 to 1")
        key = (float(uv[0]) % 1.0, float(uv[1]))  # u = 0 and u = 1 are the same column
        if key not in self.index:
            self.index[key] = len(self.names)
            self.names.append(name)
        return self.index[key]


def collect_clicks(picks, image_size):
    """All clicks of CalibrationPicks for an image of (width, height) pixels.

    Raises: CalibrationError for a pick that is not finite or outside the image, or a size that is no size.
    """
    width, height = _checked_size(image_size)
    table = _Table()
    quads = []
    for number, rectangle in enumerate(picks.rectangles, start=1):
        name = f"{rectangle.plane.lower()} rectangle {number}"
        quads.append(Quad(table.add(rectangle.points, name), rectangle.plane, name))
    lines = []
    for parallels in picks.parallels:
        for pair in parallels.lines:
            number = 1 + sum(line.axis == parallels.axis for line in lines)
            name = f"{parallels.axis} parallel {number}"
            lines.append(Line(table.add(pair, name), parallels.axis, name))
    for number, pair in enumerate(picks.verticals, start=1):
        lines.append(Line(table.add(pair, f"vertical {number}"), "Z", f"vertical {number}"))
    length = table.add(picks.length.points, "length") if picks.length else None
    uv = np.array(list(table.index)).reshape(-1, 2)
    directions = direction_from_uv(uv)
    tangents = click_tangents(directions, width, height)
    return Clicks(uv, directions, tangents, tuple(table.names), tuple(quads), tuple(lines), length)


def _checked_size(image_size):
    width, height = image_size
    if not (np.isfinite(width) and np.isfinite(height) and width >= 1 and height >= 1):
        raise CalibrationError(f"image_size {image_size!r} must be (width, height) of at least one pixel")
    return width, height


def click_tangents(directions, width, height):
    """How far half a pixel moves a direction, (..., 3) -> (..., 3, 2) [rad]: sideways, and upwards.

    Half a column is CLICK_ERROR_PIXELS · 2π/width · cos θ, half a row CLICK_ERROR_PIXELS · π/height.
    Source: derivative of ω(u, v), thesis appendix A.

    >>> import numpy as np
    >>> t = click_tangents(np.array([1.0, 0.0, 0.0]), 2000, 1000)
    >>> (np.degrees(t.T) + 0.0).round(3).tolist()
    [[0.0, 0.09, 0.0], [0.0, 0.0, 0.09]]
    """
    x, y, z = np.moveaxis(directions, -1, 0)
    azimuth = np.arctan2(y, x)
    cosine = np.hypot(x, y)
    sideways = np.stack([-np.sin(azimuth), np.cos(azimuth), np.zeros_like(x)], axis=-1)
    upwards = np.stack([-z * np.cos(azimuth), -z * np.sin(azimuth), cosine], axis=-1)
    column = CLICK_ERROR_PIXELS * 2.0 * np.pi / width * np.maximum(cosine, SMALLEST_COSINE)
    row = CLICK_ERROR_PIXELS * np.pi / height
    return np.stack([sideways * column[..., None], upwards * row], axis=-1)
