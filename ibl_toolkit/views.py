"""How a view of a modelling program shows the panorama: pixels of the view <-> directions of the panorama.

In perspective and camera views the panorama lies at infinity: what is looked up is the direction of the
pixel's ray. In orthographic views all rays are parallel, so that would be one colour; there the panorama is
shown as it lies on the floor: a plan of the place, seen from above.

Source: thesis section 5.5.2, eq. 5.5 and Alg. 5.1, which un-projects a point of the far plane and multiplies
by w where it must divide. Here the ray itself is un-projected, so near and far clip do not enter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PARALLEL = 1e-6
"""Sine of the angle to the floor below which a ray never meets it."""

AT_ORIGIN = 0.01
"""An eye so many camera heights from the panorama's origin is at it."""


@dataclass(frozen=True, eq=False)
class View:
    """The rays of a view, in the panorama frame, around the panorama's origin.

    At (x, y) in [-1, 1], x to the right and y upwards, a ray starts at eye + x eye_x + y eye_y [m] in the
    direction ray + x ray_x + y ray_y (all (3,)). up (3,): the world's z. camera_height [m] above the floor.
    size: (width, height) [px].
    """

    eye: np.ndarray
    eye_x: np.ndarray
    eye_y: np.ndarray
    ray: np.ndarray
    ray_x: np.ndarray
    ray_y: np.ndarray
    up: np.ndarray
    camera_height: float
    size: tuple[int, int]

    @classmethod
    def from_matrices(cls, window_matrix, view_matrix, world_from_panorama, camera_height, size):
        """The View of OpenGL-like matrices (4, 4): clip_from_view and view_from_world.

        world_from_panorama (3, 3) and camera_height [m] are a calibration's. Shift, any lens and
        off-centre frustums are in the window matrix. Raises ValueError for a matrix that is no projection.

        >>> identity = np.eye(4)
        >>> looking_down = View.from_matrices(identity, identity, np.eye(3), 1.5, (100, 100))
        >>> looking_down.directions_at([50, 50]).tolist()
        [0.0, 0.0, -1.5]
        """
        window, view = np.array(window_matrix, np.float64), np.array(view_matrix, np.float64)
        if not (window[0, 0] and window[1, 1] and np.isfinite(window).all() and np.isfinite(view).all()):
            raise ValueError(f"window matrix {window.tolist()} projects nothing: its scales must not be 0")
        panorama_from_view = np.array(world_from_panorama, np.float64).T @ np.linalg.inv(view[:3, :3])
        across = panorama_from_view @ np.array([[1 / window[0, 0], 0, 0], [0, 1 / window[1, 1], 0]]).T
        world_eye = np.linalg.inv(view)[:3, 3] - (0, 0, camera_height)
        eye, none = world_eye @ np.array(world_from_panorama, np.float64), np.zeros(3)
        if window[3, 3] == 0:
            middle = np.array([window[0, 2] / window[0, 0], window[1, 2] / window[1, 1], -1])
            rays = panorama_from_view @ middle, across[:, 0], across[:, 1]
            eyes = eye, none, none
        else:
            middle = np.array([-window[0, 3] / window[0, 0], -window[1, 3] / window[1, 1], 0])
            rays = panorama_from_view @ (0, 0, -1), none, none
            eyes = eye + panorama_from_view @ middle, across[:, 0], across[:, 1]
        up = np.array(world_from_panorama, np.float64)[2]
        return cls(*eyes, *rays, up, float(camera_height), tuple(size))

    @property
    def is_perspective(self):
        """Whether rays spread from one point."""
        return bool(self.ray_x.any())

    @property
    def has_floor_in_place(self):
        """Whether the picture shows the floor where it is: from the panorama's origin, and in plans."""
        return not self.is_perspective or bool(np.linalg.norm(self.eye) <= AT_ORIGIN * self.camera_height)

    @property
    def runs_along_floor(self):
        """Whether it is an orthographic view that would show one colour of the panorama all over."""
        return not self.is_perspective and bool(abs(self.ray @ self.up) < PARALLEL)

    def rays_at(self, xy):
        """Starts [m] and directions of the rays, (..., 3) each, at (..., 2) [px] as in `directions_at`."""
        x, y = np.moveaxis(2 * np.asarray(xy, np.float64) / self.size - 1, -1, 0)[..., None]
        return self.eye + x * self.eye_x + y * self.eye_y, self.ray + x * self.ray_x + y * self.ray_y

    def directions_at(self, xy):
        """Directions (..., 3) in the panorama frame, not of unit length, that a view shows at (..., 2) [px].

        Pixels count from the lower left corner; their centres are at + 1/2.
        """
        start, ray = self.rays_at(xy)
        if self.is_perspective:
            return ray
        if self.runs_along_floor:
            return np.broadcast_to(self.ray, start.shape)
        return start - ((start @ self.up + self.camera_height) / (self.ray @ self.up))[..., None] * ray

    def pixels_of(self, directions):
        """Where (..., 2) [px] a view shows directions (..., 3) of the panorama; NaN where it does not.

        A view may show it beyond its borders. Orthographic views show what lies below the horizon, and
        nothing where they run parallel to the floor.
        """
        directions = np.asarray(directions, np.float64)
        if self.is_perspective:
            basis = np.column_stack([self.ray_x, self.ray_y, self.ray])
            x, y, ahead = np.moveaxis(directions @ np.linalg.inv(basis).T, -1, 0)
            shown = ahead > PARALLEL * np.linalg.norm(directions, axis=-1)
            x, y = (np.where(shown, v / np.where(shown, ahead, 1), np.nan) for v in (x, y))
        else:
            sinking = directions @ self.up
            shown = sinking < -PARALLEL * np.linalg.norm(directions, axis=-1)
            distance = np.where(shown, -self.camera_height / np.where(shown, sinking, -1), np.nan)
            return self.pixels_of_points(directions * distance[..., None])
        return (np.stack([x, y], axis=-1) + 1) / 2 * self.size

    def pixels_of_points(self, points):
        """Where (..., 2) [px] points (..., 3) [m], seen from the panorama's origin, are in the view.

        NaN behind the eye; in orthographic views that run along the floor, points still have their place.
        """
        points = np.asarray(points, np.float64)
        if self.is_perspective:
            return self.pixels_of(points - self.eye)
        basis = np.column_stack([self.eye_x, self.eye_y, self.ray])
        plane = (points - self.eye) @ np.linalg.inv(basis).T
        return (plane[..., :2] + 1) / 2 * self.size
