"""Curves of the panorama in a canvas's pixels: great circles, and straight lines of the place."""

import numpy as np

from ..ibl_toolkit.equirectangular import uv_from_direction
from ..operators.canvas import ImageCanvas

STEP_DEG = 1.0
"""Longest step of a curve, as the panorama sees it."""
FARTHEST_PIXELS = 20000
"""Beyond, a 3D View's pixels lose their precision on the graphics card."""


def curve_pixels(canvas, directions):
    """Curves through directions (..., n, 3) of the panorama frame in pixels (m, 2), one after the other.

    NaN between them, and where they are not shown; across the seam of a flat image they go on at the other
    side.
    """
    uv = uv_from_direction(np.reshape(directions, (-1, *np.shape(directions)[-2:])))
    if isinstance(canvas, ImageCanvas):
        return _on_flat_image(canvas, uv)
    pixels = canvas.pixels_of(uv)
    return _broken(np.where((np.abs(pixels) < FARTHEST_PIXELS).all(axis=-1, keepdims=True), pixels, np.nan))


def circle(first, second):
    """Directions (n, 3) of the great circle through two perpendicular unit vectors (3,)."""
    turns = np.linspace(0, 2 * np.pi, int(360 / STEP_DEG) + 1)[:, None]
    return np.cos(turns) * first + np.sin(turns) * second


def segments(first, second):
    """Directions (m, n, 3) of straight lines of the place from directions (m, 3) to others (m, 3)."""
    cosine = np.einsum("mi,mi->m", first, second)[:, None]
    across = second - cosine * first
    sine = np.linalg.norm(across, axis=1, keepdims=True)
    angle = np.arctan2(sine, cosine)
    steps = max(int(np.degrees(angle.max(initial=0.0)) / STEP_DEG), 1) + 1
    turns = np.linspace(0, 1, steps)[None, :, None] * angle[:, None]
    return np.cos(turns) * first[:, None] + np.sin(turns) * (across / np.maximum(sine, 1e-12))[:, None]


def _on_flat_image(canvas, uv):
    u, v = np.unwrap(uv[..., :1], period=1.0, axis=1), uv[..., 1:]
    if not u.size:
        return np.empty((0, 2))
    copies = []
    for shift in range(int(np.floor(u.min())), int(np.floor(u.max())) + 1):
        here = u - shift
        pixels = canvas.pixels_of(np.concatenate([here, v], axis=-1))
        copies.append(_broken(np.where((here >= 0) & (here <= 1), pixels, np.nan)))
    return np.concatenate(copies)


def _broken(curves):
    """Curves (m, n, 2) as one (k, 2), with NaN between them."""
    gaps = np.full((len(curves), 1, 2), np.nan)
    return np.concatenate([curves, gaps], axis=1).reshape(-1, 2)
