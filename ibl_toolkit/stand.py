"""How a panorama stands over its floor: what a ray of a view means for a shape that is drawn with the mouse.

Seen from the panorama's origin this is what its picks mean; from beside it, a ray meets the floor, and what
stands on it, elsewhere than the picture's: then the point is taken in the world and seen from the origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .calibration.plausibility import LEAST_DEPRESSION_DEG
from .equirectangular import uv_from_direction
from .outlines import cross, first_hit, point_inside
from .solids import first_hit_of_circle

STEEP = 1e-3
"""Share of a ray's length that it must go sideways to tell a height."""


@dataclass(frozen=True, eq=False)
class Stand:
    """world_from_panorama (3, 3), and the camera height [m] of the origin above the floor z = 0."""

    world_from_panorama: np.ndarray
    camera_height: float

    def is_close(self, world_from_panorama, camera_height) -> bool:
        """Whether a panorama so calibrated stands as this one."""
        same_height = np.isclose(self.camera_height, camera_height)
        return bool(same_height and np.allclose(self.world_from_panorama, world_from_panorama, atol=1e-6))

    def world_ray(self, start, direction):
        """A ray (start [m], direction) of the panorama frame, (3,) each, in the world."""
        return self.world_from_panorama @ start + (
            0,
            0,
            self.camera_height,
        ), self.world_from_panorama @ direction

    def from_origin(self, points):
        """Points (..., 3) of the world [m] in the panorama frame [m]."""
        return (np.asarray(points, np.float64) - (0, 0, self.camera_height)) @ self.world_from_panorama

    def uv_of(self, points):
        """The picks (..., 2) of points (..., 3) of the world [m]."""
        return uv_from_direction(self.from_origin(points))

    def floor_under(self, start, direction):
        """Where a ray of the panorama frame meets the floor: (2,) of the world [m].

        Raises ValueError where it does not, or where the origin sees that point too near the horizon.

        >>> Stand(np.eye(3), 1.5).floor_under(np.zeros(3), np.array([1.0, 0.0, -0.5])).tolist()
        [3.0, 0.0]
        """
        start, ray = self.world_ray(start, direction)
        if start[2] * ray[2] >= 0:
            raise ValueError("above the horizon: the floor lies below it")
        point = (start - start[2] / ray[2] * ray)[:2]
        depression_deg = np.degrees(np.arctan2(self.camera_height, np.linalg.norm(point)))
        if depression_deg < LEAST_DEPRESSION_DEG:
            raise ValueError(
                f"{depression_deg:.2f}° below the horizon: at least {LEAST_DEPRESSION_DEG}° are needed"
            )
        return point

    def above_base(self, start, direction, base):
        """The point (3,) of the world [m] where a ray of the panorama frame passes over the edge of a base.

        On the upright plane over the FloorShape's nearest side; for a ray that passes beside the base, on the
        upright line over the corner next to it. Raises ValueError where that tells no height above 0.

        >>> from .floor_shapes import square
        >>> stand, base = Stand(np.eye(3), 1.5), square([[2, -1], [4, 1]])
        >>> stand.above_base(np.zeros(3), np.array([1.0, 0.0, -0.25]), base).tolist()
        [2.0, 0.0, 1.0]
        """
        start, ray = self.world_ray(start, direction)
        across = np.linalg.norm(ray[:2])
        if across <= STEEP * np.linalg.norm(ray):
            raise ValueError("seen from straight above, nothing tells a height: type it")
        along = ray[:2] / across
        distance = _distance_to(base, start[:2], along)
        if distance is not None:
            point = start[:2] + distance * along
        else:
            point, distance = _nearest_beside(base, start[:2], along)
        height = start[2] + distance * ray[2] / across
        if height <= 0:
            raise ValueError("below the floor: move up to raise it")
        return np.array([*point, height])

    def upper_edge(self, base, towards):
        """Where (2,) on the floor a top over a FloorShape is picked: first met from the origin [m].

        In the azimuth of the point `towards` (2,); where that misses the base, of a point inside it.
        """
        for point in (np.asarray(towards, np.float64), point_inside(base.outline)):
            along = point / max(np.linalg.norm(point), 1e-12)
            distance = _distance_to(base, np.zeros(2), along)
            if distance is not None:
                return distance * along
        raise ValueError(
            "the base lies straight below the panorama, where no top can be picked: type its height"
        )


def _distance_to(base, start, along):
    """How far [m] from a point (2,) a base is first met along a unit vector (2,); None where it is missed."""
    azimuth = np.arctan2(along[1], along[0])
    if base.circle is None:
        return first_hit(base.outline - start, azimuth)
    centre, radius = base.circle
    return first_hit_of_circle(centre - start, radius, azimuth)


def _nearest_beside(base, start, along):
    """The outline's point (2,) next to a ray that misses it, and how far along the ray that is [m]."""
    offsets = base.outline - start
    ahead = np.flatnonzero(offsets @ along > 0)
    if not len(ahead):
        raise ValueError("the base lies behind: look at it to raise it")
    nearest = ahead[np.argmin(np.abs(cross(along, offsets[ahead])))]
    return base.outline[nearest], float(offsets[nearest] @ along)
