"""The most likely orientation: the smallest correction of the clicks that fulfils all conditions.

Least squares with conditions between observations and unknowns (the Gauss-Helmert model): minimise |v|²
subject to c(v, x) = 0, where v are the corrections of the clicks in units of their own error and x is the
orientation with one azimuth per further rectangle. For normal errors this is maximum likelihood of the
reprojection.
"""

from dataclasses import dataclass

import numpy as np

from .conditions import VERTICAL

# Conditions that repeat each other (the foot of a wall on a side of the floor) would make the cofactors
# singular; each is granted an error of 3e-5 of a click's, invisible next to it.
CONDITION_VARIANCE = 1e-9
LONGEST_STEP = 0.4  # [rad]; a start value is rarely worse, and the linearisation does not reach further
STEP_DONE = 1e-10  # [rad]
CORRECTION_DONE = 1e-7  # of a click's error
# Contradictory picks converge slowly, by the ratio of their residual to their extent; if this many steps
# don't do, no orientation is near.
MOST_STEPS = 100
# A good solution takes 4 to 8 steps, one from a start with near and far exchanged up to 20.
RIVAL_STEPS = 30


@dataclass(frozen=True)
class Adjustment:
    """A solution and its first-order statistics, in units of click errors and radians.

    world_from_panorama (3, 3); azimuths (families,) of the rectangles, [0] = 0; corrections (n, 2);
    multipliers (m,) and their cofactors (m, m); normal (p, p): normal matrix of the unknowns (turns about
    world x, y and, if anything gives it, z; then the further azimuths); sensitivity (p, n, 2): change
    of the unknowns per error of each click; by_click (m, n, 2): the conditions' derivatives by the clicks;
    converged: whether it is a minimum.
    """

    world_from_panorama: np.ndarray
    azimuths: np.ndarray
    corrections: np.ndarray
    multipliers: np.ndarray
    multiplier_cofactors: np.ndarray
    normal: np.ndarray
    sensitivity: np.ndarray
    by_click: np.ndarray
    converged: bool

    @property
    def cost(self):
        """Sum of squared corrections, in squared click errors."""
        return float(np.sum(self.corrections**2))

    @property
    def redundancy(self):
        """How many conditions there are beyond the unknowns."""
        return len(self.multipliers) - len(self.normal)


def rotation_from_vector(turn):
    """The rotation (3, 3) about the vector turn (3,), by its length [rad].

    >>> rotation_from_vector([0.0, 0.0, 1.5707963267948966]).round(6).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    x, y, z = turn
    angle = np.sqrt(x * x + y * y + z * z)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # sinc keeps both factors exact near 0
    return np.eye(3) + np.sinc(angle / np.pi) * skew + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * (skew @ skew)


def adjust(clicks, conditions, world_from_panorama, azimuths, most_steps=MOST_STEPS):
    """Iterate from a start value to the Adjustment; never raises for bad data, `converged` says it."""
    rotation, azimuths = world_from_panorama, np.array(azimuths, dtype=np.float64)
    corrections = np.zeros((len(clicks.directions), 2))
    turns = 3 if conditions.families else 2
    converged = False
    for _ in range(most_steps):
        value, by_unknown, by_click = _linearise(clicks, conditions, rotation, azimuths, corrections)
        weight = invert_symmetric(by_click @ by_click.T + CONDITION_VARIANCE * np.eye(len(value)))
        normal = by_unknown.T @ weight @ by_unknown
        misfit = by_click @ corrections.ravel() - value
        step = np.linalg.lstsq(normal, by_unknown.T @ weight @ misfit, rcond=1e-14)[0]
        step *= min(1.0, LONGEST_STEP / (np.abs(step).max() + 1e-300))
        multipliers = weight @ (misfit - by_unknown @ step)
        updated = (by_click.T @ multipliers).reshape(-1, 2)
        rotation = rotation_from_vector(np.append(step[:turns], np.zeros(3 - turns))) @ rotation
        azimuths[1:] += step[turns:]
        moved, corrections = np.abs(updated - corrections).max(), updated
        if np.abs(step).max() < STEP_DONE and moved < CORRECTION_DONE:
            converged = True
            break
    inverse = invert_symmetric(normal)
    gain = weight @ by_unknown @ inverse
    sensitivity = -(gain.T @ by_click).reshape(len(normal), -1, 2)
    cofactors = weight - gain @ by_unknown.T @ weight
    statistics = multipliers, cofactors, normal, sensitivity, by_click.reshape(len(value), -1, 2)
    return Adjustment(rotation, azimuths, corrections, *statistics, converged)


def invert_symmetric(matrix):
    """Inverse of a positive matrix (n, n); what nothing determines gets a huge variance, no exception."""
    values, vectors = np.linalg.eigh(matrix)
    floor = max(values.max(), 1.0) * 1e-15
    return (vectors / np.maximum(values, floor)) @ vectors.T


def _linearise(clicks, conditions, rotation, azimuths, corrections):
    """Conditions (m,), derivatives by the unknowns (m, p) and by the clicks (m, 2n); rows in click errors."""
    directions = clicks.directions + np.einsum("nij,nj->ni", clicks.tangents, corrections)
    a, b = directions[conditions.first], directions[conditions.second]
    along, along_by_azimuth = conditions.directions(azimuths)
    normals = np.cross(a, b) @ rotation.T
    value = np.sum(normals * along, axis=1)

    rows = np.arange(len(value))
    by_turn = np.cross(normals, along)
    by_azimuth = np.zeros((len(value), conditions.families))
    level = conditions.family != VERTICAL
    slope = np.sum(normals * along_by_azimuth, axis=1)
    by_azimuth[rows[level], conditions.family[level]] = slope[level]
    # Family 0 is the world's own azimuth: it turns with the rotation about z, and without it z is free.
    by_unknown = np.hstack([by_turn if conditions.families else by_turn[:, :2], by_azimuth[:, 1:]])

    seen = along @ rotation
    by_click = np.zeros((len(value), len(directions), 2))
    for ends, gradient in ((conditions.first, np.cross(b, seen)), (conditions.second, np.cross(seen, a))):
        by_click[rows, ends] += np.einsum("mi,mij->mj", gradient, clicks.tangents[ends])
    by_click = by_click.reshape(len(value), -1)
    scale = 1.0 / np.maximum(np.linalg.norm(by_click, axis=1), 1e-12)
    return value * scale, by_unknown * scale[:, None], by_click * scale[:, None]
