"""What half a pixel of click error does to the result, to first order."""

from dataclasses import dataclass

import numpy as np

from .adjustment import invert_symmetric


@dataclass(frozen=True)
class Uncertainty:
    """One standard deviation for a click error of half a pixel.

    tilt [rad]: root mean square angle between the estimated and the true vertical (both directions of error
    together). azimuth [rad] of the world's +x, 0 where nothing determines it. condition: condition number of
    the tilt's normal matrix (2 × 2, all azimuths eliminated), i.e. the squared ratio of the errors of tilt in
    its worst and its best direction. turn_sensitivity (3, n, 2): turns of the world per error of each click.
    """

    tilt: float
    azimuth: float
    condition: float
    turn_sensitivity: np.ndarray


def propagate(conditions, adjustment):
    """The Uncertainty of a solution, from its normal matrix.

    An error ε of the clicks moves the unknowns by −N⁻¹ A' M⁻¹ B ε, M = B B', N = A' M⁻¹ A, so their
    covariance is N⁻¹.
    """
    covariance = invert_symmetric(adjustment.normal)
    variances = np.linalg.eigvalsh(covariance[:2, :2])
    turns = 3 if conditions.families else 2
    sensitivity = np.zeros((3, *adjustment.sensitivity.shape[1:]))
    sensitivity[:turns] = adjustment.sensitivity[:turns]
    return Uncertainty(
        tilt=float(np.sqrt(variances.sum())),
        azimuth=float(np.sqrt(covariance[2, 2])) if conditions.families else 0.0,
        condition=float(variances[1] / variances[0]),
        turn_sensitivity=sensitivity,
    )
