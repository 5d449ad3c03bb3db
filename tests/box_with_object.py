"""A box room with a box in it, all of it known: what is seen, and what is behind it."""

from types import SimpleNamespace

import numpy as np
from box_layers import directions

LOW, HIGH = np.array([-3.0, -2.5, -1.4]), np.array([3.0, 2.5, 1.4])
"""Corners of the room, from the origin [m]."""
OBJECT_LOW, OBJECT_HIGH = np.array([1.2, -0.5, -1.4]), np.array([1.8, 0.4, -0.3])
"""Corners of the box that stands on its floor."""


def room_with_box(mapping, width, low=OBJECT_LOW, high=OBJECT_HIGH):
    """Radiance (H, W, 3) and depth (H, W) [m], those of the empty room behind, and where the box is hit."""
    rays = directions(mapping, width)
    with np.errstate(divide="ignore", invalid="ignore"):
        behind_depth = np.min(np.where(rays > 0, HIGH, LOW) / rays, axis=2)
        one, other = low / rays, high / rays
        enter, leave = np.minimum(one, other).max(axis=2), np.maximum(one, other).min(axis=2)
    hit = (enter < leave) & (enter > 0)
    depth = np.where(hit, enter, behind_depth)
    behind = _wall_colour(rays * behind_depth[..., None])
    radiance = np.where(hit[..., None], _object_colour(rays * depth[..., None]), behind)
    return SimpleNamespace(
        radiance=radiance.astype(np.float32),
        depth=depth.astype(np.float32),
        behind=behind.astype(np.float32),
        behind_depth=behind_depth.astype(np.float32),
        hit=hit,
    )


def _wall_colour(points):
    """Soft waves, another colour on floor, ceiling and walls."""
    x, y, z = np.moveaxis(points, -1, 0)
    base = np.where((z < LOW[2] + 1e-4)[..., None], (0.45, 0.3, 0.2), (0.6, 0.62, 0.55))
    base = np.where((z > HIGH[2] - 1e-4)[..., None], (0.8, 0.8, 0.8), base)
    return base * (1 + 0.25 * np.sin(2.5 * x + y) * np.cos(1.5 * z - 2 * y))[..., None]


def _object_colour(points):
    x, y, z = np.moveaxis(points, -1, 0)
    return np.array([0.7, 0.1, 0.08]) * (1 + 0.4 * np.sin(9 * (x + y + z)))[..., None]


def scanned_room(eyes, count, seed=1):
    """Points (n, 3) [m] and colours (n, 3) that scanners at `eyes` see, `count` rays from each at random."""
    rng = np.random.default_rng(seed)
    points, colours = [], []
    for eye in map(np.array, eyes):
        rays = rng.normal(size=(count, 3))
        distance, seen = shot_of_room(eye, rays)
        points.append(eye + rays * distance[:, None])
        colours.append(seen)
    return np.concatenate(points), np.concatenate(colours)


def shot_of_room(eye, rays):
    """Distances (...) in units of rays (..., 3), and colours (..., 3), of what is seen from an eye (3,)."""
    wall = np.min((np.where(rays > 0, HIGH, LOW) - eye) / rays, axis=-1)
    one, other = (OBJECT_LOW - eye) / rays, (OBJECT_HIGH - eye) / rays
    enter, leave = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
    hit = (enter < leave) & (enter > 0)
    distance = np.where(hit, enter, wall)
    met = eye + rays * distance[..., None]
    return distance, np.where(hit[..., None], _object_colour(met), _wall_colour(met))
