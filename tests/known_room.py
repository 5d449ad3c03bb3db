"""A place whose truth is known: points [m], a tilted camera above the origin, and what it sees of them."""

import numpy as np

from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector
from expanded_panoramas.ibl_toolkit.equirectangular import uv_from_direction

SIZE = (2048, 1024)
CAMERA_HEIGHT = 1.5
WORLD_FROM_PANORAMA = rotation_from_vector([0.10, -0.20, 0.70])
UPSIDE_DOWN = rotation_from_vector([np.pi - 0.1, 0.05, 0.3])

# The first side of RUG runs along +x, so it defines the world in which all of this is written.
RUG = np.array([[1.0, -0.8, 0.0], [2.6, -0.8, 0.0], [2.6, 0.4, 0.0], [1.0, 0.4, 0.0]])
TILE = np.array([[-1.5, 0.5, 0.0], [-0.9, 1.3, 0.0], [-1.7, 1.9, 0.0], [-2.3, 1.1, 0.0]])  # turned by 53°
SKYLIGHT = np.array([[-1.0, -1.5, 2.8], [1.2, -1.5, 2.8], [1.2, 0.5, 2.8], [-1.0, 0.5, 2.8]])
WINDOW = np.array([[3.0, -1.0, 0.9], [3.0, 0.8, 0.9], [3.0, 0.8, 2.1], [3.0, -1.0, 2.1]])
LINES_X = np.array([[[0.5, 1.0, 0.0], [2.5, 1.0, 0.0]], [[-2.0, -1.2, 0.0], [1.0, -1.2, 0.0]]])
LINES_Y = np.array([[[1.5, -1.0, 0.0], [1.5, 1.5, 0.0]], [[-1.0, -2.0, 0.0], [-1.0, 1.0, 0.0]]])
CORNERS = np.array([[[3.0, 2.0, 0.2], [3.0, 2.0, 2.5]], [[-2.0, 2.0, 2.6], [-2.0, 2.0, 0.1]]])


def turned(points, azimuth):
    """Points (..., 3) turned about the vertical [rad]."""
    return np.asarray(points) @ rotation_from_vector([0.0, 0.0, azimuth]).T


def seen(points, world_from_panorama=WORLD_FROM_PANORAMA, camera_height=CAMERA_HEIGHT):
    """The picks (..., 2) of points (..., 3) of the world [m]."""
    rays = np.asarray(points, dtype=float) - [0.0, 0.0, camera_height]
    return uv_from_direction(rays @ world_from_panorama)


def clicked(uv, rng, pixels=0.5, size=SIZE):
    """Picks with a normal error of so many pixels, sideways and up or down."""
    noisy = uv + rng.normal(size=np.shape(uv)) * pixels / np.array(size)
    noisy[..., 0] %= 1.0
    return noisy


def angle_deg(a, b):
    """The angle between two unit vectors [deg], also for tiny ones."""
    return float(np.degrees(2.0 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))))
