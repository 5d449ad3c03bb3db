"""What picks must look like before any orientation is known: distinct, not on one line, not crossed."""

from itertools import combinations

import numpy as np

from .picks import CalibrationError

# Two clicks closer than twice their own error (2 · ½ pixel) can't be told from one click.
COINCIDENT_CLICK_ERRORS = 2.0
# A corner nearer than this to the line through two others may lie on either side of it: 4 click errors are
# where chance no longer explains it (1 in 16,000), and less leaves the shape undefined.
COLLINEAR_CLICK_ERRORS = 4.0


def check_shapes(clicks):
    """Refuse what no rectangle or line can look like. Raises: CalibrationError naming the clicks.

    Works on the sphere, so neither the seam nor the orientation matters.
    """
    for quad in clicks.quads:
        _check_distinct(clicks, quad.clicks, quad.name)
        _check_bent(clicks, quad)
        _check_convex(clicks, quad)
    for line in clicks.lines:
        _check_distinct(clicks, line.clicks, line.name)
        _check_not_opposite(clicks, line.clicks, line.name)
    if clicks.length is not None:
        _check_distinct(clicks, clicks.length, "length")


def angle_between(a, b):
    """The angle between two vectors [rad], accurate for tiny angles and near π."""
    return np.arctan2(np.linalg.norm(np.cross(a, b)), np.dot(a, b))


def _click_error(clicks, index):
    """Half a row of the image [rad]: the click error that does not shrink towards the poles."""
    return np.linalg.norm(clicks.tangents[index, :, 1])


def _check_distinct(clicks, indices, name):
    for (m, a), (n, b) in combinations(enumerate(indices, start=1), 2):
        apart = angle_between(clicks.directions[a], clicks.directions[b])
        least = COINCIDENT_CLICK_ERRORS * _click_error(clicks, a)
        if apart < least:
            raise CalibrationError(
                f"{name}: points {m} and {n} coincide ({np.degrees(apart):.3f}° apart, "
                f"at least {np.degrees(least):.3f}° needed)"
            )


def _check_not_opposite(clicks, indices, name):
    a, b = (clicks.directions[k] for k in indices)
    if np.pi - angle_between(a, b) < COINCIDENT_CLICK_ERRORS * _click_error(clicks, indices[0]):
        raise CalibrationError(f"{name}: its two points are opposite each other, so no line is defined")


def _check_bent(clicks, quad):
    """Every corner must stand off the great circle through any two others."""
    flat = []
    for triple in combinations(range(4), 3):
        a, b, c = (clicks.directions[quad.clicks[k]] for k in triple)
        volume = abs(np.dot(a, np.cross(b, c)))
        longest = max(np.linalg.norm(np.cross(*pair)) for pair in ((a, b), (b, c), (c, a)))
        if volume < COLLINEAR_CLICK_ERRORS * _click_error(clicks, quad.clicks[0]) * longest:
            flat.append([k + 1 for k in triple])
    if len(flat) >= 3 and quad.plane == "WALL":
        raise CalibrationError(
            f"{quad.name}: is seen edge-on (its plane runs through the camera); choose one in front of it"
        )
    if flat:
        numbers = ", ".join(map(str, flat[0]))
        raise CalibrationError(
            f"{quad.name}: points {numbers} lie on one line as seen from the camera; it is too thin, too "
            f"far away, or a corner was clicked on a side"
        )


def _check_convex(clicks, quad):
    """All four turns agree for a convex outline seen from off its plane; for a bow-tie they are 2 and 2."""
    d = clicks.directions[list(quad.clicks)]
    turns = np.sign([np.dot(d[k], np.cross(d[(k + 1) % 4], d[(k + 2) % 4])) for k in range(4)])
    if abs(turns.sum()) == 4.0:
        return
    if turns.sum() == 0.0:
        raise CalibrationError(
            f"{quad.name}: its sides cross; click the corners in order around it (either way round)"
        )
    raise CalibrationError(
        f"{quad.name}: is not convex, so no view of a rectangle; one corner points inwards"
    )
