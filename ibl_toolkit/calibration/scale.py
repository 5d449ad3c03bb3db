"""Camera height from a known length, and how well lengths on the floor are known (thesis section 5.4.2)."""

import numpy as np


def floor_points(directions, world_from_panorama):
    """Where directions (..., 3) of the panorama meet the floor, (..., 2), in units of the camera height.

    >>> import numpy as np
    >>> floor_points(np.array([0.6, 0.0, -0.8]), np.eye(3)).tolist()
    [0.7499999999999999, 0.0]
    """
    world = directions @ world_from_panorama.T
    return world[..., :2] / -world[..., 2:]


def floor_length(clicks, pair, world_from_panorama):
    """Distance on the floor between two clicks, in units of the camera height."""
    a, b = floor_points(clicks.directions[list(pair)], world_from_panorama)
    return float(np.linalg.norm(b - a))


def relative_length_error(clicks, pair, world_from_panorama, turn_sensitivity):
    """One standard deviation of floor_length, relative; a click that also oriented counts once."""
    points = floor_points(clicks.directions[list(pair)], world_from_panorama)
    along = (points[1] - points[0]) / np.sum((points[1] - points[0]) ** 2)
    by_click = np.zeros((len(clicks.directions), 2))
    by_turn = np.zeros(3)
    for index, sign in zip(pair, (-1.0, 1.0), strict=True):
        x, y, z = world_from_panorama @ clicks.directions[index]
        by_world = np.array([[-1.0, 0.0, x / z], [0.0, -1.0, y / z]]) / z  # derivative of (x, y) / −z
        gradient = sign * along @ by_world
        by_click[index] += gradient @ world_from_panorama @ clicks.tangents[index]
        by_turn += np.cross([x, y, z], gradient)  # (turn × w) · g = turn · (w × g)
    total = by_click + np.einsum("k,knj->nj", by_turn, turn_sensitivity)
    return float(np.sqrt(np.sum(total**2)))


def reference_length(clicks):
    """The two clicks whose distance stands for lengths on the floor, or None if no click lies on it.

    The known length; without it the first side of the first floor rectangle, then the first parallel.
    """
    if clicks.length is not None:
        return clicks.length
    for quad in clicks.quads:
        if quad.plane == "FLOOR":
            return quad.clicks[:2]
    return next((line.clicks for line in clicks.lines if line.axis != "Z"), None)


def relative_scale_error(clicks, world_from_panorama, uncertainty):
    """One standard deviation of lengths on the floor, relative; of the camera height if a length was given.

    Without any click on the floor: of the distance to a floor point seen 45° below the horizon, which a
    tilt δ towards it changes by 2 δ, averaged over all azimuths.
    """
    pair = reference_length(clicks)
    if pair is None:
        return float(np.sqrt(2.0) * uncertainty.tilt)
    return relative_length_error(clicks, pair, world_from_panorama, uncertainty.turn_sensitivity)
