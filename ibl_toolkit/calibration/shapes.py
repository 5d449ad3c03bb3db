"""What picks must look like before any orientation is known: distinct, not on one line, not crossed."""

from itertools import combinations

import numpy as np

from .directions import angle_between, corner_volumes
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
        volumes = corner_volumes(clicks.directions[list(quad.clicks)])
        _check_bent(clicks, quad, volumes)
        _check_convex(quad, volumes)
    for line in clicks.lines:
        _check_distinct(clicks, line.clicks, line.name)
        _check_not_opposite(clicks, line.clicks, line.name)
    if clicks.length is not None:
        _check_distinct(clicks, clicks.length, "length")


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


def _check_bent(clicks, quad, volumes):
    """Every corner must stand off the great circle through any two others."""
    d = clicks.directions[list(quad.clicks)]
    flat = []
    for left_out, volume in enumerate(np.abs(volumes)):
        triple = [k for k in range(4) if k != left_out]
        longest = max(np.sin(angle_between(d[m], d[n])) for m, n in combinations(triple, 2))
        if volume < COLLINEAR_CLICK_ERRORS * _click_error(clicks, quad.clicks[0]) * longest:
            flat.append([k + 1 for k in triple])
    if len(flat) >= 3 and quad.plane == "WALL":
        raise CalibrationError(
            f"{quad.name}: is seen edge-on (its plane runs through the camera); look for another wall"
        )
    if flat:
        numbers = ", ".join(map(str, flat[-1]))
        raise CalibrationError(
            f"{quad.name}: points {numbers} lie on one line as seen from the camera; it is too thin, too "
            f"far away, or a corner was clicked on a side"
        )


def _check_convex(quad, volumes):
    turns = abs(np.sign(volumes).sum())
    if turns == 0.0:
        raise CalibrationError(
            f"{quad.name}: its sides cross; click the corners in order around it (either way round)"
        )
    if turns != 4.0:
        raise CalibrationError(
            f"{quad.name}: is not convex, so no view of a rectangle; one corner points inwards"
        )
