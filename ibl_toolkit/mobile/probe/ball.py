"""A ball before a camera: where its surface and its outline are seen, and what it mirrors.

The rays of sight that touch a ball form a right circular cone about the direction of its centre; the outline
in the picture is that cone's section, an ellipse (a circle only in the middle of the picture). A cone about
the unit vector a with half angle α holds the unit directions d with d·a = cos α, so m = a / cos α is linear
in them: d·m = 1. Three points fix it. The ball's distance in radii is 1 / sin α.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .errors import ProbeError


@dataclass(frozen=True, eq=False)
class Ball:
    """centre (3,) and radius in one unit, metres or radii of the ball, in the frame `camera`.

    Raises: ProbeError for a radius that is not above 0, a centre that is not finite or not before the camera,
    and a ball with the camera inside.
    """

    centre: np.ndarray
    radius: float

    def __post_init__(self):
        if not (np.isfinite(self.radius) and self.radius > 0):
            raise ProbeError(f"ball's radius {self.radius} must be above 0")
        if np.shape(self.centre) != (3,) or not np.isfinite(self.centre).all():
            raise ProbeError(f"ball's centre {np.asarray(self.centre).tolist()} must be three finite numbers")
        if not self.centre[2] > 0:
            raise ProbeError(
                f"ball at {np.round(self.centre, 4).tolist()} lies behind the camera, which looks along +z"
            )
        if self.distance <= self.radius:
            raise ProbeError(
                f"camera lies in the ball: {self.distance:.3g} from its centre, radius {self.radius:.3g}"
            )

    @property
    def distance(self) -> float:
        """From the camera to the centre."""
        return float(np.linalg.norm(self.centre))

    @property
    def axis(self) -> np.ndarray:
        """(3,) unit vector from the camera to the centre."""
        return np.asarray(self.centre) / self.distance

    @property
    def angular_radius(self) -> float:
        """Half angle of the cone of touching rays [rad]; it is the blind spot's too."""
        return float(np.arcsin(self.radius / self.distance))

    def normals(self, rays) -> np.ndarray:
        """Outward unit normals (..., 3) where unit rays (..., 3) from the camera meet a ball; NaN where not.

        >>> Ball(np.array([0.0, 0.0, 5.0]), 1.0).normals([0, 0, 1])
        array([ 0.,  0., -1.])
        """
        rays = np.asarray(rays, dtype=np.float64)
        along = rays @ self.centre
        with np.errstate(invalid="ignore"):
            depth = along - np.sqrt(along**2 - (self.distance**2 - self.radius**2))
        return (depth[..., None] * rays - self.centre) / self.radius

    def outline(self, count=360) -> np.ndarray:
        """Unit directions (count, 3) of sight round the outline."""
        side, up = across(self.axis)
        turn = np.arange(count) * (2 * np.pi / count)
        rim = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * up
        return np.cos(self.angular_radius) * self.axis + np.sin(self.angular_radius) * rim

    def scaled(self, radius) -> Ball:
        """The ball that looks the same and has this radius.

        >>> Ball(np.array([0.0, 0.0, 5.0]), 1.0).scaled(0.1).centre
        array([0. , 0. , 0.5])
        """
        return Ball(np.asarray(self.centre) * (radius / self.radius), float(radius))


def across(axis) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors (3,) that make a right-handed frame with a unit vector (3,)."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    side = np.cross(helper, axis)
    side /= np.linalg.norm(side)
    return side, np.cross(axis, side)


def reflected(rays, normals) -> np.ndarray:
    """Where unit rays (..., 3) go from mirrors with unit normals (..., 3): r = c − 2 (c·n) n.

    Source: Realistic Shadows for Mobile Augmented Reality, section III.A, whose print has the sign and one of
    the vectors otherwise.

    >>> reflected(np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0]))
    array([ 0.,  0., -1.])
    """
    rays, normals = np.asarray(rays, dtype=np.float64), np.asarray(normals, dtype=np.float64)
    return rays - 2 * np.sum(rays * normals, axis=-1, keepdims=True) * normals


def ball_from_rays(rays, weights=None) -> Ball:
    """The ball of radius 1 that unit rays (n ≥ 3, 3) of sight touch, by least squares on their angles.

    To first order d·m − 1 is tan α times the angle by which a ray misses the cone, for all rays alike.

    Raises: ProbeError for fewer than 3 rays, and for rays of no cone.

    >>> made = Ball(np.array([0.5, 0.0, 4.0]), 1.0)
    >>> ball_from_rays(made.outline(7)).centre.round(9).tolist()
    [0.5, 0.0, 4.0]
    """
    rays = np.asarray(rays, dtype=np.float64)
    if rays.ndim != 2 or len(rays) < 3:
        raise ProbeError(
            f"{len(rays)} points of the ball's outline: 3 or more are needed, 5 or more are better"
        )
    weights = np.ones(len(rays)) if weights is None else np.asarray(weights, dtype=np.float64)
    solved, _, rank, _ = np.linalg.lstsq(rays * weights[:, None], weights, rcond=1e-9)
    length = np.linalg.norm(solved)
    if rank < 3 or not 1 < length < 1e6:
        raise ProbeError("the points of the ball's outline lie on one line, or round no ball")
    distance = 1 / np.sqrt(1 - length**-2)  # in radii: 1 / sin α, cos α = 1 / |m|
    if solved[2] <= 0:
        raise ProbeError("the points of the ball's outline go round what lies behind the camera")
    return Ball(solved / length * distance, 1.0)


def ball_from_ellipse(camera, centre, semi_axes, angle_deg) -> Ball:
    """The ball of radius 1 whose outline is an ellipse of the picture.

    centre (2,) and semi_axes (2,) [px]; angle_deg: of the first axis, from x towards y [°]. An ellipse has
    five parameters and a ball three, so what a ball cannot look like is met by least squares.

    Raises: ProbeError for semi-axes that are not above 0, and where no ball looks so.
    """
    semi_axes = np.asarray(semi_axes, dtype=np.float64)
    if semi_axes.shape != (2,) or not (semi_axes > 0).all():
        raise ProbeError(f"semi-axes {semi_axes.tolist()} px of the outline must be two numbers above 0")
    turn = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    angle = np.radians(angle_deg)
    first = np.array([np.cos(angle), np.sin(angle)])
    second = np.array([-first[1], first[0]])
    points = np.outer(np.cos(turn), semi_axes[0] * first) + np.outer(np.sin(turn), semi_axes[1] * second)
    return ball_from_rays(camera.rays(np.asarray(centre) + points))
