"""Curves of the panorama in a canvas's pixels: great circles, and straight lines of the place."""

import numpy as np

from ..ibl_toolkit.equirectangular import uv_from_direction
from ..ibl_toolkit.overlay import STEP_DEG, unwrapped
from ..operators.canvas import ImageCanvas

FARTHEST_PIXELS = 20000
"""Beyond, a 3D View's pixels lose their precision on the graphics card."""


def curve_pixels(canvas, directions):
    """A curve through directions (n, 3) of the panorama frame in pixels (m, 2), NaN where it is not shown.

    Across the seam of a flat image it goes on at the other side.
    """
    if isinstance(canvas, ImageCanvas):
        return _on_flat_image(canvas, uv_from_direction(directions))
    pixels = canvas.pixels_of(uv_from_direction(directions))
    return np.where((np.abs(pixels) < FARTHEST_PIXELS).all(axis=-1, keepdims=True), pixels, np.nan)


def circle(first, second):
    """Directions (n, 3) of the great circle through two perpendicular unit vectors (3,), in short steps."""
    turns = np.linspace(0, 2 * np.pi, int(360 / STEP_DEG) + 1)[:, None]
    return np.cos(turns) * first + np.sin(turns) * second


def segment(first, second):
    """Directions (n, 3) of a straight line of the place from one direction (3,) to another."""
    normal = np.cross(np.cross(first, second), first)
    angle = np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second)
    turns = np.linspace(0, angle, max(int(np.degrees(angle) / STEP_DEG), 1) + 1)[:, None]
    return np.cos(turns) * first + np.sin(turns) * normal / max(np.linalg.norm(normal), 1e-12)


def outline(corners, *, closed):
    """Directions (n, 3) of straight lines of the place that join directions (k, 3)."""
    ends = np.roll(corners, -1, axis=0) if closed else corners[1:]
    return np.concatenate([segment(a, b) for a, b in zip(corners, ends, strict=False)])


def _on_flat_image(canvas, uv):
    uv = unwrapped(uv)
    shifts = range(int(np.floor(uv[:, 0].min())), int(np.floor(uv[:, 0].max())) + 1)
    copies = []
    for shift in shifts:
        u = uv[:, :1] - shift
        inside = (u >= 0) & (u <= 1)
        copies += [np.where(inside, canvas.pixels_of(np.hstack([u, uv[:, 1:]])), np.nan), [[np.nan] * 2]]
    return np.concatenate(copies)
