"""Least-squares circle through points of a plane, with its residual and how well the points fix it."""

from dataclasses import dataclass

import numpy as np

COLLINEAR = 1e-6  # smallest ratio of the points' extents across and along
SHORTEST_ARC_DEG = 20.0  # below it one part in a hundred of click error moves the radius by all of itself
ADVISED_ARC_DEG = 60.0
ADVISED_RESIDUAL = 0.05  # of the radius
STEPS = 50


@dataclass(frozen=True, eq=False)
class CircleFit:
    """centre (2,) [m], radius [m], residual_m: root mean square distance of the points from the circle [m],
    arc_deg: the part of the circle that the points span, conditioning: metres that the radius moves per metre
    of independent error of each point (1/√n at best)."""

    centre: np.ndarray
    radius: float
    residual_m: float
    arc_deg: float
    conditioning: float

    @property
    def warnings(self):
        """What an artist should know about this fit."""
        notes = []
        if self.arc_deg < ADVISED_ARC_DEG:
            notes.append(
                f"the points span {self.arc_deg:.0f}° of the circle, 1 mm of pick error moves its radius "
                f"by {self.conditioning:.1f} mm: pick points farther apart"
            )
        if self.residual_m > ADVISED_RESIDUAL * self.radius:
            notes.append(
                f"the points are {self.residual_m:.3f} m (RMS) off a circle of radius {self.radius:.3f} m"
            )
        return tuple(notes)


def fit_circle(points):
    """Circle with the smallest sum of squared distances to points (n ≥ 3, 2) [m] -> CircleFit.

    The linear (algebraic) fit is the start of Gauss–Newton steps on the distances.

    Raises ValueError for points on a line and for an arc shorter than SHORTEST_ARC_DEG, with the figure.
    Source: thesis, eq. 5.3, replaced: its bisectors meet nowhere for near-collinear points.

    >>> fit_circle([[1, 0], [0, 1], [-1, 0], [0, -1]]).radius
    1.0
    """
    points = np.asarray(points, dtype=np.float64)
    mean = points.mean(axis=0)
    spread = np.linalg.svd(points - mean, compute_uv=False)
    if spread[1] <= COLLINEAR * spread[0] or spread[0] == 0:
        raise ValueError(f"the {len(points)} points lie on one line: pick them around the circle")
    unit = (points - mean) / spread[0]
    centre, radius = _refine(unit, *_algebraic_fit(unit))
    jacobian, distances = _jacobian(unit, centre)
    arc_deg = _arc_deg(unit - centre)
    if arc_deg < SHORTEST_ARC_DEG:
        raise ValueError(
            f"the points span {arc_deg:.1f}° of a circle of radius {radius * spread[0]:.2g} m: "
            f"pick points over {SHORTEST_ARC_DEG:.0f}° or more"
        )
    conditioning = np.sqrt(np.linalg.inv(jacobian.T @ jacobian)[2, 2])
    residual = np.sqrt(np.mean((distances - radius) ** 2))
    return CircleFit(
        mean + spread[0] * centre,
        float(spread[0] * radius),
        float(spread[0] * residual),
        arc_deg,
        float(conditioning),
    )


def _algebraic_fit(points):
    system = np.column_stack([2 * points, np.ones(len(points))])
    x, y, constant = np.linalg.lstsq(system, np.sum(points**2, axis=1), rcond=None)[0]
    return np.array([x, y]), np.sqrt(constant + x * x + y * y)


def _jacobian(points, centre):
    offsets = points - centre
    distances = np.linalg.norm(offsets, axis=1)
    return np.column_stack([offsets / distances[:, None], np.ones(len(points))]), distances


def _refine(points, centre, radius):
    for _ in range(STEPS):
        jacobian, distances = _jacobian(points, centre)
        step = np.linalg.lstsq(jacobian, distances - radius, rcond=None)[0]
        centre, radius = centre + step[:2], radius + step[2]
        if np.abs(step).max() <= 1e-14 * max(1.0, radius):
            break
    return centre, radius


def _arc_deg(offsets):
    angles = np.sort(np.arctan2(offsets[:, 1], offsets[:, 0]))
    gaps = np.diff(angles, append=angles[0] + 2 * np.pi)
    return float(360 - np.degrees(gaps.max()))
