"""Rooms of known shape, seen from a known pose, as picks; written without the package's own mapping."""

import math

import numpy as np

from expanded_panoramas.ibl_toolkit.calibration import Calibration, CalibrationPicks
from expanded_panoramas.ibl_toolkit.panorama_set import PanoramaSet, Shape

EXACT = 1e-9  # [m] reconstruction from exact picks


def rotation(yaw_deg=0.0, pitch_deg=0.0, roll_deg=0.0):
    """world_from_panorama from three turns about z, y and x."""
    (cz, sz), (cy, sy), (cx, sx) = (
        (math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (yaw_deg, pitch_deg, roll_deg)
    )
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    return about_z @ about_y @ about_x


POSES = {
    "level": (np.eye(3), 1.5),
    "seam": (rotation(yaw_deg=173.0), 1.5),
    "tilted": (rotation(31.0, 12.0, -8.0), 1.63),
    "upside_down": (rotation(-60.0, 3.0, 178.0), 0.9),
    "lying": (rotation(20.0, 90.0, 5.0), 2.2),
}


def calibration(pose):
    matrix, height = pose
    return Calibration(matrix, height, 0.0, 0.0, 0.0, 0.0, 1.0, ())


def pick(pose, x, y, z=0.0):
    """The pick (u, v) of a point of the world: azimuth and elevation in the panorama's frame."""
    matrix, height = pose
    ahead, left, up = np.linalg.inv(matrix) @ (x, y, z - height)
    distance = math.sqrt(ahead * ahead + left * left + up * up)
    u = (0.5 - math.atan2(left, ahead) / math.tau) % 1.0
    return u, math.acos(up / distance) / math.pi


def picks(pose, points):
    return np.array([pick(pose, *point) for point in points])


def room(*shapes):
    return PanoramaSet("room.exr", CalibrationPicks(camera_height=1.5), shapes)


def shape(name, kind, pose, points, **more):
    return Shape(name, kind, picks(pose, points), **more)
