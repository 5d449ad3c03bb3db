"""The perspective camera that looks at a layered panorama, from its centre or beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..panorama import LayeredPanorama

_UPRIGHT = 1e-6  # a direction of sight nearer to the vertical has no upright picture: sine of the angle


@dataclass(frozen=True, eq=False)
class Pinhole:
    """A camera without distortion.

    eye: (3,) [m]. axes: (3, 3) rotation, its rows the camera's right, down and forward; both in the world, or
    in the panorama's frame (see `in_panorama`). fov_deg: angle of the picture's width. width, height [px];
    pixel centres at (i + ½, j + ½), row 0 at the top.

    Raises: ValueError for a field of view outside 0 to 180°, a picture without pixels, axes that are no
    rotation, and an eye that is not finite.
    """

    eye: np.ndarray
    axes: np.ndarray
    fov_deg: float
    width: int
    height: int

    def __post_init__(self):
        if not 0 < self.fov_deg < 180:
            raise ValueError(f"field of view {self.fov_deg}° must lie between 0 and 180°")
        if self.width < 1 or self.height < 1:
            raise ValueError(f"picture of {self.width} x {self.height} px must have 1 x 1 or more")
        if np.shape(self.eye) != (3,) or not np.isfinite(self.eye).all():
            raise ValueError(f"eye {np.asarray(self.eye).tolist()} must be three finite numbers")
        if np.shape(self.axes) != (3, 3) or not np.allclose(self.axes @ self.axes.T, np.eye(3), atol=1e-5):
            raise ValueError(f"camera's axes {np.asarray(self.axes).tolist()} must be a (3, 3) rotation")

    @classmethod
    def looking_at(cls, eye, look_at, fov_deg: float, width: int, height: int) -> Pinhole:
        """An upright camera, z being up. Raises ValueError for looking along z, and at its own eye.

        >>> Pinhole.looking_at((0, 0, 0), (1, 0, 0), 90, 200, 100).axes[0]  # right, when looking along +x
        array([ 0., -1.,  0.])
        """
        eye, look_at = np.asarray(eye, dtype=np.float64), np.asarray(look_at, dtype=np.float64)
        sight = look_at - eye
        length = np.linalg.norm(sight)
        if not length > 0:
            raise ValueError(f"camera at {eye.tolist()} must look at another point than its own")
        forward = sight / length
        right = np.cross(forward, (0.0, 0.0, 1.0))
        if np.linalg.norm(right) < _UPRIGHT:
            raise ValueError(f"camera at {eye.tolist()} looks along the vertical, where nothing is upright")
        right /= np.linalg.norm(right)
        return cls(eye, np.stack([right, np.cross(forward, right), forward]) + 0.0, fov_deg, width, height)

    @property
    def focal(self) -> float:
        """Distance of the picture from the eye [px]."""
        return 0.5 * self.width / math.tan(math.radians(self.fov_deg) / 2)

    def in_panorama(self, panorama: LayeredPanorama) -> Pinhole:
        """This camera of the world in the panorama's frame, whose origin is the panorama's."""
        to_panorama = np.asarray(panorama.world_from_panorama, dtype=np.float64).T
        return replace(
            self, eye=to_panorama @ (self.eye - np.asarray(panorama.origin)), axes=self.axes @ to_panorama.T
        )

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where points (..., 3) [m] are seen -> (..., 2) [px], and their distance (...) [m] along forward.

        Points beside or behind the eye, whose distance is not above 0, get NaN for a place.
        """
        seen = (np.asarray(points) - self.eye) @ self.axes.T
        distance = seen[..., 2]
        before = np.where(distance > 0, distance, np.nan)[..., None]
        return self.focal * seen[..., :2] / before + (self.width / 2, self.height / 2), distance

    def directions(self) -> np.ndarray:
        """Of sight through the pixels' centres: (height, width, 3) unit vectors."""
        across = (np.arange(self.width) + 0.5 - self.width / 2) / self.focal
        down = (np.arange(self.height) + 0.5 - self.height / 2) / self.focal
        rays = np.empty((self.height, self.width, 3))
        rays[..., 0], rays[..., 1], rays[..., 2] = across, down[:, None], 1.0
        rays /= np.linalg.norm(rays, axis=2, keepdims=True)
        return rays @ self.axes
