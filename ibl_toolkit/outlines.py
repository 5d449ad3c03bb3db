"""Closed outlines on the floor plane: area, simplicity, inside, overlap, first hit of a ray.

An outline is an array (n, 2) of points [m], closed implicitly. All tests are exact up to rounding; what is
smaller than ROUNDING times the outline's extent is taken to be zero.
"""

import numpy as np

ROUNDING = 1e-9


def signed_area(outline):
    """Area [m²], positive when the outline runs counter-clockwise seen from above.

    >>> signed_area(np.array([[0, 0], [2, 0], [2, 1], [0, 1]]))
    2.0
    """
    x, y = (outline - outline[0]).T.astype(np.float64)
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def extent(outline):
    """Diagonal of the bounding box [m]."""
    return float(np.linalg.norm(np.ptp(outline, axis=0)))


def counter_clockwise(outline):
    """The outline counter-clockwise, still beginning with its first point."""
    return outline if signed_area(outline) > 0 else np.roll(outline[::-1], 1, axis=0)


def without_redundant_points(outline):
    """Drop repeated points and those exactly on the straight line between their neighbours."""
    tolerance = ROUNDING * extent(outline)
    points = [tuple(point) for point in np.asarray(outline, dtype=np.float64)]
    index = 0
    while index < len(points) and len(points) > 2:
        before, here, after = (np.array(points[(index + step) % len(points)]) for step in (-1, 0, 1))
        if np.linalg.norm(here - before) <= tolerance or _is_between(here, before, after, tolerance):
            del points[index]
            index = max(index - 1, 0)
        else:
            index += 1
    return np.array(points)


def _is_between(point, start, end, tolerance):
    along = end - start
    length = np.linalg.norm(along)
    if length <= tolerance:
        return False
    offset = point - start
    fraction = offset @ along / length**2
    return 0 <= fraction <= 1 and abs(cross(along, offset)) / length <= tolerance


def cross(a, b):
    """z of the cross product of vectors (..., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def crossing_sides(outline):
    """The first sides (i, j) that meet without being neighbours, or fold back on each other; or None.

    Side i runs from point i to point i + 1.

    >>> crossing_sides(np.array([[0, 0], [1, 1], [1, 0], [0, 1]]))
    (0, 2)
    """
    count = len(outline)
    start, end = outline, np.roll(outline, -1, axis=0)
    tolerance = ROUNDING * extent(outline) ** 2
    for i in range(count):
        along, following = end[i] - start[i], end[(i + 1) % count] - end[i]
        if abs(cross(along, following)) <= tolerance and along @ following < 0:
            return i, (i + 1) % count
        others = np.array([j for j in range(i + 2, count) if (j + 1) % count != i], dtype=int)
        met = segments_meet(start[i], end[i], start[others], end[others], tolerance)
        if met.any():
            return i, int(others[met][0])
    return None


def segments_meet(a, b, c, d, tolerance):
    """Whether segment ab meets each of the segments cd (k, 2), touching included -> (k,) bool."""
    sides_of_ab = [_sign(cross(b - a, point - a), tolerance) for point in (c, d)]
    sides_of_cd = [_sign(cross(d - c, point - c), tolerance) for point in (a, b)]
    boxes = np.all((np.minimum(c, d) <= np.maximum(a, b)) & (np.minimum(a, b) <= np.maximum(c, d)), axis=-1)
    return (sides_of_ab[0] * sides_of_ab[1] <= 0) & (sides_of_cd[0] * sides_of_cd[1] <= 0) & boxes


def segments_cross(a, b, c, d, tolerance):
    """Whether segment ab properly crosses each of the segments cd (k, 2); touching is not -> (k,) bool."""
    return (_sign(cross(b - a, c - a), tolerance) * _sign(cross(b - a, d - a), tolerance) < 0) & (
        _sign(cross(d - c, a - c), tolerance) * _sign(cross(d - c, b - c), tolerance) < 0
    )


def _sign(values, tolerance):
    return np.where(np.abs(values) <= tolerance, 0, np.sign(values))


def contains(outline, point):
    """Whether the point (2,) lies strictly inside the outline (even-odd rule); points on a side do not."""
    start, end = outline - point, np.roll(outline, -1, axis=0) - point
    along = end - start
    length = np.linalg.norm(along, axis=1)
    fraction = np.clip(-np.sum(start * along, axis=1) / length**2, 0, 1)
    if np.min(np.linalg.norm(start + fraction[:, None] * along, axis=1)) <= ROUNDING * extent(outline):
        return False
    straddles = (start[:, 1] > 0) != (end[:, 1] > 0)
    x_crossing = start[straddles, 0] - start[straddles, 1] * along[straddles, 0] / along[straddles, 1]
    return bool(np.count_nonzero(x_crossing > 0) % 2)


def point_inside(outline):
    """A point (2,) strictly inside a simple outline: the middle of a horizontal chord."""
    levels = np.unique(outline[:, 1])
    widest = np.argmax(np.diff(levels))
    y = 0.5 * (levels[widest] + levels[widest + 1])
    start, end = outline, np.roll(outline, -1, axis=0)
    cut = (start[:, 1] > y) != (end[:, 1] > y)
    fraction = (y - start[cut, 1]) / (end[cut, 1] - start[cut, 1])
    x = np.sort(start[cut, 0] + fraction * (end[cut, 0] - start[cut, 0]))
    return np.array([0.5 * (x[0] + x[1]), y])


def overlap(first, second):
    """Whether the insides of two simple outlines share an area; a common side or corner is none."""
    tolerance = ROUNDING * max(extent(first), extent(second)) ** 2
    start, end = second, np.roll(second, -1, axis=0)
    for a, b in zip(first, np.roll(first, -1, axis=0), strict=True):
        if segments_cross(a, b, start, end, tolerance).any():
            return True
    probes = [(first, _probes(second)), (second, _probes(first))]
    return any(contains(outline, point) for outline, points in probes for point in points)


def _probes(outline):
    middles = 0.5 * (outline + np.roll(outline, -1, axis=0))
    return np.concatenate([outline, middles, point_inside(outline)[None]])


def first_hit(outline, azimuth):
    """Distance [m] at which a ray of this azimuth [rad] from the world's origin first meets the outline, or
    None.

    >>> first_hit(np.array([[2, -1], [3, -1], [3, 1], [2, 1]]), 0.0)
    2.0
    """
    ray = np.array([np.cos(azimuth), np.sin(azimuth)])
    start, end = outline, np.roll(outline, -1, axis=0)
    across, across_end = cross(ray, start), cross(ray, end)
    # A side counts when its ends lie on different sides of the ray; half-open: a corner is met only once.
    straddles = (across >= 0) != (across_end >= 0)
    fraction = across[straddles] / (across[straddles] - across_end[straddles])
    hits = (start[straddles] + fraction[:, None] * (end - start)[straddles]) @ ray
    hits = hits[hits > ROUNDING * extent(outline)]
    return float(hits.min()) if len(hits) else None
