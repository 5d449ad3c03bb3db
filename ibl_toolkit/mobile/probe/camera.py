"""The camera that took a photograph: pixels <-> rays, with OpenCV's distortion.

The frame `camera` is OpenCV's: x to the right, y down, z forward, the eye at the origin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from .errors import ProbeError

COEFFICIENTS = (0, 4, 5, 8, 12, 14)
"""How many distortion coefficients OpenCV knows the meaning of."""
FILM_MM = 36, 24
_HALF_PIXEL = 0.5  # OpenCV's pixel centres lie at the integers, ours half a pixel further
_undistorted = getattr(cv2, "undistortPointsIter", cv2.undistortPoints)  # the second takes steps in OpenCV 5
_STEPS = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-12)


@dataclass(frozen=True)
class PhotoCamera:
    """Intrinsics of a photograph.

    focal: (fx, fy) [px]. centre: (cx, cy) [px] of the principal point, pixel centres at (i + ½, j + ½).
    width, height [px]. distortion: OpenCV's k1, k2, p1, p2[, k3, …]; none for a picture without.

    Raises: ProbeError for a focal length that is not above 0, a picture without pixels, a principal point
    that is not finite, and a number of coefficients that has no meaning.
    """

    focal: tuple[float, float]
    centre: tuple[float, float]
    width: int
    height: int
    distortion: tuple[float, ...] = ()

    def __post_init__(self):
        if not all(math.isfinite(f) and f > 0 for f in self.focal):
            raise ProbeError(f"focal length {self.focal} px must be above 0")
        if not all(map(math.isfinite, self.centre)):
            raise ProbeError(f"principal point {self.centre} px must be two finite numbers")
        if self.width < 1 or self.height < 1:
            raise ProbeError(f"picture of {self.width} × {self.height} px must have 1 × 1 or more")
        if len(self.distortion) not in COEFFICIENTS or not all(map(math.isfinite, self.distortion)):
            raise ProbeError(
                f"distortion {self.distortion}: must be 4, 5, 8, 12 or 14 finite numbers (k1, k2, p1, p2, …)"
            )

    @classmethod
    def from_fov(cls, fov_deg, width, height, centre=None, distortion=()) -> PhotoCamera:
        """A camera by the angle of its picture's width [°]; the principal point is the middle unless given.

        Raises: ProbeError for an angle outside 0 to 180°, and what the class refuses.

        >>> PhotoCamera.from_fov(90, 200, 100).focal
        (100.00000000000001, 100.00000000000001)
        """
        if not 0 < fov_deg < 180:
            raise ProbeError(f"field of view {fov_deg}° must lie between 0 and 180°")
        focal = 0.5 * width / math.tan(math.radians(fov_deg) / 2)
        return cls.from_focal(focal, width, height, centre, distortion)

    @classmethod
    def from_focal(cls, focal, width, height, centre=None, distortion=()) -> PhotoCamera:
        """A camera of square pixels by its focal length [px]; the principal point is the middle unless given.

        Raises: ProbeError for what the class refuses.
        """
        middle = (width / 2, height / 2) if centre is None else tuple(map(float, centre))
        return cls((focal, focal), middle, width, height, tuple(map(float, distortion)))

    @classmethod
    def from_35mm(cls, focal_mm, width, height) -> PhotoCamera:
        """A camera by its focal length in 35 mm terms [mm], as EXIF tells it: by the picture's diagonal.

        Raises: ProbeError for what the class refuses.

        >>> PhotoCamera.from_35mm(36, 3000, 2000).focal[0]
        3000.0
        """
        return cls.from_focal(focal_mm / math.hypot(*FILM_MM) * math.hypot(width, height), width, height)

    @property
    def matrix(self) -> np.ndarray:
        """(3, 3) of OpenCV, whose pixel centres lie at the integers."""
        (fx, fy), (cx, cy) = self.focal, self.centre
        return np.array([[fx, 0, cx - _HALF_PIXEL], [0, fy, cy - _HALF_PIXEL], [0, 0, 1.0]])

    @property
    def coefficients(self) -> np.ndarray:
        """(n,) of the distortion, as OpenCV takes them."""
        return np.array(self.distortion or (0.0,) * 4)

    def rays(self, xy) -> np.ndarray:
        """Unit directions (..., 3) of sight through picture points (..., 2) [px].

        >>> PhotoCamera.from_fov(90, 200, 100).rays([100, 50])
        array([0., 0., 1.])
        """
        xy = np.asarray(xy, dtype=np.float64)
        if self.distortion:
            flat = (xy - _HALF_PIXEL).reshape(-1, 1, 2)
            flat = _undistorted(flat, self.matrix, self.coefficients, R=None, P=None, criteria=_STEPS)
            normalised = flat.reshape(xy.shape)
        else:
            normalised = (xy - self.centre) / self.focal
        rays = np.concatenate([normalised, np.ones((*xy.shape[:-1], 1))], axis=-1)
        return rays / np.linalg.norm(rays, axis=-1, keepdims=True)

    def pixels(self, points) -> np.ndarray:
        """Picture points (..., 2) [px] of points or directions (..., 3); NaN for those not before the camera.

        >>> PhotoCamera.from_fov(90, 200, 100).pixels([[1, 0, 2], [0, 0, -1]]).round(9).tolist()
        [[150.0, 50.0], [nan, nan]]
        """
        points = np.asarray(points, dtype=np.float64)
        before = points[..., 2:] > 0
        safe = np.where(before, points, (0.0, 0.0, 1.0))
        if self.distortion:
            zero = np.zeros(3)
            xy, _ = cv2.projectPoints(safe.reshape(-1, 1, 3), zero, zero, self.matrix, self.coefficients)
            xy = xy.reshape(*points.shape[:-1], 2) + _HALF_PIXEL
        else:
            xy = safe[..., :2] / safe[..., 2:] * self.focal + self.centre
        return np.where(before, xy, np.nan)

    def is_inside(self, xy) -> np.ndarray:
        """Which picture points (..., 2) [px] lie in the frame."""
        x, y = np.moveaxis(np.asarray(xy), -1, 0)
        return (x >= 0) & (x <= self.width) & (y >= 0) & (y <= self.height)
