"""Triangles cut until a picture can be laid on them.

Texture coordinates are linear on a triangle, and the mapping isn't. The surface stays as it is: new vertices
are middles of sides. A side is cut where the picture along it would be off by more than a limit; whether
it is depends on the side alone, so both its triangles cut it, and no T-junction comes in.
"""

from __future__ import annotations

import numpy as np

_MOST_PASSES = 12  # a side is then 1/4096 of what it was
_ALONG = np.array([[0.5, 0.5], [0.75, 0.25], [0.25, 0.75]])
"""Where on a side it is looked at: a side along a meridian that is level in its middle is right there."""
_ON_PLANE = 1e-9  # a sine
_SIDES = ((0, 1), (1, 2), (2, 0))
# Of a triangle with corners 0 1 2 and middles 3 (of 0-1), 4 (of 1-2), 5 (of 2-0): what becomes of it, by the
# sides that are cut, as bits.
_PIECES = {
    0b000: ((0, 1, 2),),
    0b001: ((0, 3, 2), (3, 1, 2)),
    0b010: ((0, 1, 4), (0, 4, 2)),
    0b100: ((0, 1, 5), (5, 1, 2)),
    0b011: ((3, 1, 4), (0, 3, 4), (0, 4, 2)),
    0b110: ((4, 2, 5), (1, 4, 5), (0, 1, 5)),
    0b101: ((0, 3, 5), (3, 1, 2), (5, 3, 2)),
    0b111: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
}


def refined(points, triangles, chart, error_px):
    """Points (n, 3) [m] and triangles (T, 3), cut until the middles of sides are textured within `error_px`
    [px].

    points are seen from the panorama's origin, in its frame; the first of those that come back are those that
    were given. chart: see `texture_coordinates`.

    Raises: ValueError for an error that is not above 0, and what the chart's `uv` raises.

    >>> from .texture_coordinates import EquirectangularChart
    >>> wall = np.array([[1.0, -1, 0], [1, 1, 0], [1, 0, 1]])
    >>> [len(refined(wall, np.array([[0, 1, 2]]), EquirectangularChart(w), 1.0)[1]) for w in (8, 64, 512)]
    [1, 1, 30]
    """
    if not error_px > 0:
        raise ValueError(f"texture error of {error_px} px must be above 0")
    points, triangles = _cut_between_faces(points, triangles, chart)
    done = []
    for _ in range(_MOST_PASSES):
        sides, of_triangle = _sides(triangles, len(points))
        cut = _off(points[sides], chart) > error_px
        touched = cut[of_triangle].any(axis=1)
        done.append(triangles[~touched])
        if not touched.any():
            break
        new, middles = _numbered(cut, points[sides[cut]].mean(axis=1), points, triangles.dtype)
        points, triangles = new, _cut(triangles[touched], middles[of_triangle[touched]])
    else:
        done.append(triangles)
    return points, np.concatenate(done)


def _cut_between_faces(points, triangles, chart):
    """Cut all triangles along the chart's planes if any of them doesn't lie on one face."""
    if chart.fits(points[triangles]).all():
        return points, triangles
    for normal in chart.planes:
        height = points @ normal
        height[np.abs(height) < _ON_PLANE * np.linalg.norm(points, axis=1)] = 0
        sides, of_triangle = _sides(triangles, len(points))
        one, other = height[sides].T
        cut = one * other < 0
        share = (one / np.where(cut, one - other, 1))[cut, None]
        places = points[sides[cut, 0]] * (1 - share) + points[sides[cut, 1]] * share
        points, middles = _numbered(cut, places, points, triangles.dtype)
        triangles = _cut(triangles, middles[of_triangle])
    return points, triangles


def _numbered(cut, places, points, kind):
    """Points with those places (n, 3) added, and the number of the one on each side, -1 where it isn't
    cut."""
    numbers = np.full(len(cut), -1, dtype=kind)
    numbers[cut] = len(points) + np.arange(len(places))
    return np.concatenate([points, places]), numbers


def _sides(triangles, count):
    """Sides (m, 2), lower point first, and which of them the sides of each triangle are, (T, 3)."""
    pairs = np.sort(np.stack([triangles[:, side] for side in _SIDES], axis=1), axis=2).astype(np.int64)
    keys, which = np.unique(pairs[..., 0] * count + pairs[..., 1], return_inverse=True)
    return np.stack([keys // count, keys % count], axis=1), which.reshape(-1, 3)


def _off(ends, chart):
    """How far the picture is off along sides with these ends (m, 2, 3), at most, (m,) [px]."""
    uv, worst = chart.uv(ends), np.zeros(len(ends))
    for share in _ALONG:
        shown, right = (chart.direction(share @ uv), share @ ends)
        right /= np.linalg.norm(right, axis=1, keepdims=True)
        np.maximum(worst, np.linalg.norm(shown - right, axis=1), out=worst)
    return worst * chart.pixels_per_radian


def _cut(triangles, middles):
    """Pieces of triangles (T, 3), whose sides have the points `middles` (T, 3) in them, -1 where uncut."""
    cases = (middles >= 0) @ (1, 2, 4)
    corners = np.concatenate([triangles, middles], axis=1)
    return np.concatenate(
        [corners[cases == case][:, piece] for case, pieces in _PIECES.items() for piece in pieces]
    )
