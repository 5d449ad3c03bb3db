"""calibrate(): orientation and scale of a panorama from picks, and how far to trust them."""

from dataclasses import dataclass

import numpy as np

from ..equirectangular import direction_from_uv
from .clicks import CLICK_ERROR_PIXELS, collect_clicks
from .directions import angle_between
from .orientation import final_rotation, orient
from .picks import CalibrationError
from .plausibility import LEAST_DEPRESSION_DEG, check_evidence, check_horizon, check_uncertainty
from .scale import floor_length, floor_points, relative_scale_error
from .shapes import check_shapes
from .suspects import disagreement
from .uncertainty import propagate


@dataclass(frozen=True, eq=False)
class Calibration:
    """Orientation and scale of a panorama in the world of a set: metres, z up, the floor at z = 0.

    world_from_panorama (3, 3). camera_height [m]. tilt_deg: angle between the panorama's top and the world's.
    residual_deg: root mean square angle by which the clicks were corrected. uncertainty_*: one standard
    deviation for a click error of half a pixel; tilt: rms angle between the estimated and the true vertical;
    scale: with a given camera height, the relative error of lengths on the floor (the first side of the
    first floor rectangle, else the first parallel, else a distance seen 45° down); with a known length, the
    relative error of the camera height. condition: condition number of the tilt's normal matrix (1 is best:
    both directions of tilt equally well known). warnings: sentences with figures.
    """

    world_from_panorama: np.ndarray
    camera_height: float
    tilt_deg: float
    residual_deg: float
    uncertainty_tilt_deg: float
    uncertainty_scale_percent: float
    condition: float
    warnings: tuple[str, ...]

    def world_direction(self, uv):
        """The unit direction (..., 3) in the world of picks (..., 2)."""
        return direction_from_uv(np.asarray(uv, dtype=np.float64)) @ self.world_from_panorama.T

    def floor_point(self, uv):
        """Where picks (..., 2) meet the floor z = 0: (..., 2) [m].

        Raises: CalibrationError for a pick above the horizon or less than LEAST_DEPRESSION_DEG below it.
        """
        uv = np.asarray(uv, dtype=np.float64)
        directions = direction_from_uv(uv)
        depression_deg = -np.degrees(np.arcsin(np.clip(directions @ self.world_from_panorama[2], -1.0, 1.0)))
        if not np.all(depression_deg >= LEAST_DEPRESSION_DEG):
            worst = np.unravel_index(np.argmin(depression_deg), depression_deg.shape)
            u, v = uv[worst]
            raise CalibrationError(
                f"pick ({u:.4f}, {v:.4f}) lies {depression_deg[worst]:.2f}° below the horizon; "
                f"on the floor at least {LEAST_DEPRESSION_DEG}° are needed"
            )
        return self.camera_height * floor_points(directions, self.world_from_panorama)

    def to_json(self):
        """What `panorama calibrate --json` prints."""
        return {
            "world_from_panorama": self.world_from_panorama.tolist(),
            "camera_height": self.camera_height,
            "tilt_deg": self.tilt_deg,
            "residual_deg": self.residual_deg,
            "uncertainty": {
                "tilt_deg": self.uncertainty_tilt_deg,
                "scale_percent": self.uncertainty_scale_percent,
            },
            "condition": self.condition,
            "warnings": list(self.warnings),
        }


def calibrate(picks, image_size):
    """The Calibration that CalibrationPicks on an image of (width, height) pixels imply.

    Orientation by maximum likelihood: the clicks are corrected as little as possible, in units of half a
    pixel of the image, until floor, ceiling and wall rectangles are rectangles in level and upright planes,
    parallels run along the world's axes and verticals stand. Each rectangle has an azimuth of its own, but
    the first floor rectangle gives the world's +x (without one the parallels, a ceiling, a wall).

    Raises: CalibrationError, naming the pick, for anything that would give no or no trustworthy answer.
    Source: thesis section 5.4, eq. 5.2 as the start value; its signs taken so that the floor lies below.

    >>> from expanded_panoramas.ibl_toolkit.calibration import CalibrationPicks, Rectangle
    >>> corners = [[0.5738, 0.7323], [0.4262, 0.7323], [0.4737, 0.6011], [0.5263, 0.6011]]
    >>> rug = Rectangle(corners, "FLOOR")
    >>> result = calibrate(CalibrationPicks(rectangles=(rug,), camera_height=1.5), (4096, 2048))
    >>> side = result.floor_point(corners[1]) - result.floor_point(corners[0])
    >>> result.tilt_deg < 0.1, side.round(2).tolist()
    (True, [1.5, 0.0])
    """
    return solve(picks, image_size)[0]


def solve(picks, image_size):
    """What `calibrate` returns, with the Clicks and the Adjustment that it comes from."""
    if (picks.camera_height is None) == (picks.length is None):
        given = "neither" if picks.length is None else "both"
        raise CalibrationError(f"scale: exactly one of camera_height and length must be given, got {given}")
    clicks = collect_clicks(picks, image_size)
    check_shapes(clicks)
    conditions, adjustment, rivals = orient(clicks)
    rotation = final_rotation(conditions, adjustment)
    disagreeing = disagreement(clicks, conditions, adjustment, 180.0 * CLICK_ERROR_PIXELS / image_size[1])
    try:
        low = check_horizon(clicks, rotation)
    except CalibrationError as error:  # picks that contradict each other may drive one over the horizon
        raise CalibrationError("; ".join([str(error), *disagreeing])) from None
    uncertainty = propagate(conditions, adjustment)
    scale_percent = 100.0 * relative_scale_error(clicks, adjustment.world_from_panorama, uncertainty)
    poor = check_uncertainty(clicks, rotation, uncertainty, scale_percent)
    height = picks.camera_height
    if height is None:
        height = picks.length.metres / floor_length(clicks, clicks.length, rotation)
    calibration = Calibration(
        world_from_panorama=_read_only(rotation),
        camera_height=float(height),
        tilt_deg=float(np.degrees(angle_between(rotation[2], np.array([0.0, 0.0, 1.0])))),
        residual_deg=_residual_deg(clicks, conditions, adjustment),
        uncertainty_tilt_deg=float(np.degrees(uncertainty.tilt)),
        uncertainty_scale_percent=scale_percent,
        condition=uncertainty.condition,
        warnings=(
            *check_evidence(clicks, conditions, rotation, adjustment.redundancy, rivals),
            *disagreeing,
            *low,
            *poor,
        ),
    )
    return calibration, clicks, adjustment


def _residual_deg(clicks, conditions, adjustment):
    """Root mean square angle between each click that orients and where it should have been."""
    moved = np.einsum("nij,nj->ni", clicks.tangents, adjustment.corrections)
    used = np.union1d(conditions.first, conditions.second)
    return float(np.degrees(np.sqrt(np.mean(np.sum(moved[used] ** 2, axis=1)))))


def _read_only(array):
    array = np.array(array)
    array.setflags(write=False)
    return array
