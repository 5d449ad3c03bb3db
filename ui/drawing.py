"""Lines, dots, text and ellipses in a region's pixels, for draw callbacks; NaN breaks a line."""

from __future__ import annotations

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

FONT = 0
ELLIPSE_STEPS = 48
DISC_CORNERS = 24
SHADOW = (0, 0, 0, 0.7)


def scale() -> float:
    """The interface's scale: what is 1 px on a plain screen."""
    return bpy.context.preferences.system.ui_scale or 1


def lines(points, colour, width=1.5, *, closed=False):
    """A line through points (n, 2), broken where they are NaN; colour (4,) sRGB with alpha."""
    points = np.asarray(points, np.float32).reshape(-1, 2)
    if closed and len(points):
        points = np.vstack([points, points[:1]])
    segments = np.stack([points[:-1], points[1:]], axis=1)
    draw_segments(segments[np.isfinite(segments).all(axis=(1, 2))], colour, width)


def draw_segments(segments, colour, width=1.5):
    """Separate lines (n, 2, 2)."""
    if not len(segments):
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    corners = np.zeros((2 * len(segments), 3), np.float32)
    corners[:, :2] = np.asarray(segments, np.float32).reshape(-1, 2)
    batch = batch_for_shader(shader, "LINES", {"pos": corners})
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", width * scale())
    shader.uniform_float("color", colour)
    with blending():
        batch.draw(shader)


def dots(points, colour, radius=4):
    """Discs with a dark rim at points (n, 2)."""
    points = np.asarray(points, np.float32).reshape(-1, 2)
    points = points[np.isfinite(points).all(axis=1)]
    turns = np.linspace(0, 2 * np.pi, DISC_CORNERS, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns)]) * scale()
    for size, filling in ((radius + 1.2, SHADOW), (radius, colour)):
        _fans(points[:, None] + size * circle, filling)


def ellipse(centre, half_axes, colour, width=1.5):
    """An ellipse: centre (2,), half axes as columns of (2, 2)."""
    turns = np.linspace(0, 2 * np.pi, ELLIPSE_STEPS)
    lines(
        np.asarray(centre) + np.column_stack([np.cos(turns), np.sin(turns)]) @ np.asarray(half_axes).T,
        colour,
        width,
    )


def text(xy, string, colour=(1, 1, 1, 1), size=12, *, backed=False):
    """A line of text with its lower left corner at (2,), on a dark ground where it must be read."""
    if not np.isfinite(xy).all():
        return
    blf.size(FONT, size * scale())
    if backed:
        edge = size * scale() / 2
        width, height = blf.dimensions(FONT, string)
        rectangle(np.subtract(xy, edge), np.add(xy, (width + edge, height + edge)), SHADOW)
    blf.enable(FONT, blf.SHADOW)
    blf.shadow(FONT, 5, *SHADOW)
    blf.color(FONT, *colour)
    blf.position(FONT, float(xy[0]), float(xy[1]), 0)
    blf.draw(FONT, string)
    blf.disable(FONT, blf.SHADOW)


def rectangle(low, high, colour):
    """A filled rectangle from its lower left corner (2,) to its upper right one."""
    (x0, y0), (x1, y1) = low, high
    _fan([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], colour)


class blending:
    """Alpha blending for as long as it is needed; the state is given back."""

    def __enter__(self):
        """Switch it on."""
        self.before = gpu.state.blend_get()
        gpu.state.blend_set("ALPHA")

    def __exit__(self, *_):
        """Give it back."""
        gpu.state.blend_set(self.before)


def _fan(points, colour):
    _fans(np.asarray(points, np.float32)[None], colour)


def _fans(outlines, colour):
    """Convex outlines (n, k, 2), filled, in one call."""
    count, corners, _ = outlines.shape
    if not count:
        return
    places = np.zeros((count * corners, 3), np.float32)  # doubles would be read as if they were these
    places[:, :2] = outlines.reshape(-1, 2)
    fan = np.array([(0, i, i + 1) for i in range(1, corners - 1)])
    indices = (np.arange(count)[:, None, None] * corners + fan).reshape(-1, 3).astype(np.int32)
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    batch = batch_for_shader(shader, "TRIS", {"pos": places}, indices=indices)
    shader.uniform_float("color", colour)
    with blending():
        batch.draw(shader)
