"""Triangles of planar polygons, concave ones too, without new vertices."""

import numpy as np

from .meshes import newell
from .outlines import cross


def triangulate(points):
    """Triangles (k − 2, 3) of a simple planar polygon, points (k, 3), as indices into it; same winding.

    Ear clipping that takes the ear with the widest smallest angle first, so that slivers are rare.
    Raises ValueError for a polygon without area or whose sides cross.

    >>> triangulate(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])).tolist()
    [[3, 0, 1], [1, 2, 3]]
    """
    if len(points) == 3:
        return np.array([[0, 1, 2]])
    flat = _in_its_plane(np.asarray(points, dtype=np.float64))
    left = list(range(len(flat)))
    triangles = []
    while len(left) > 3:
        here = _best_ear(flat[left])
        triangles.append([left[here - 1], left[here], left[(here + 1) % len(left)]])
        del left[here]
    return np.array([*triangles, left])


def _in_its_plane(points):
    normal = newell(points)
    if not normal.any():
        raise ValueError(f"a face of {len(points)} corners has no area")
    sides = np.roll(points, -1, axis=0) - points
    x = sides[np.argmax(np.sum(sides**2, axis=1))]
    return (points - points[0]) @ np.stack([x, np.cross(normal / np.linalg.norm(normal), x)], axis=1)


def _best_ear(outline):
    before, after = np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0)
    quality = np.array([_smallest_angle(*ear) for ear in zip(before, outline, after, strict=True)])
    for here in np.argsort(-quality, kind="stable"):
        if quality[here] > 0 and _is_empty(before[here], outline[here], after[here], outline):
            return int(here)
    raise ValueError(f"a face of {len(outline)} corners has crossing sides")


def _smallest_angle(a, b, c):
    """Sine-like measure of the smallest angle of triangle abc, negative when it runs clockwise."""
    longest = max(np.sum((b - a) ** 2), np.sum((c - b) ** 2), np.sum((a - c) ** 2))
    return cross(b - a, c - a) / longest


def _is_empty(a, b, c, outline):
    inside = np.ones(len(outline), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= cross(end - start, outline - start) >= 0
    corners = [np.all(outline == corner, axis=1) for corner in (a, b, c)]
    return not np.any(inside & ~np.any(corners, axis=0))
