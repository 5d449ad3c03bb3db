"""Photographs of a ball with known lights, traced ray by ray: exact mirrors, exact shading, marker on a desk.

The light comes from the lamps (discs at infinity) and a smooth room; no light is computed between ball and
desk.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from expanded_panoramas.ibl_toolkit.mobile.probe.ball import Ball, reflected
from expanded_panoramas.ibl_toolkit.mobile.probe.photo import Photo

_STRIP = 1 << 19


@dataclass(frozen=True, eq=False)
class Lamp:
    """A disc at infinity: direction (3,), frame `camera`, radius [°], radiance (3,)."""

    direction: np.ndarray
    radius_deg: float = 4.0
    radiance: tuple = (60.0, 60.0, 60.0)

    @property
    def irradiance(self):
        return np.pi * np.sin(np.radians(self.radius_deg)) ** 2 * np.array(self.radiance)


@dataclass(frozen=True, eq=False)
class Desk:
    """A plane with a marker in its middle: camera_from_marker (3, 3), origin (3,) [m], side [m], id."""

    camera_from_marker: np.ndarray
    origin: np.ndarray
    side: float = 0.1
    ids: tuple = (7,)
    places: tuple = ((0.0, 0.0),)
    half_size: float = 0.6

    def to_camera(self, point):
        return self.camera_from_marker @ np.asarray(point) + self.origin


def unit(vector):
    vector = np.asarray(vector, dtype=np.float64)
    return vector / np.linalg.norm(vector)


def room(directions):
    """Radiance (..., 3) of a smooth room: light above, a warm side, some structure."""
    x, y, z = np.moveaxis(directions, -1, 0)
    waves = 0.05 * np.sin(9 * x + 4 * z) * np.cos(7 * y)
    base = 0.35 - 0.2 * y + waves
    return np.stack([base + 0.08 * x, base, base - 0.06 * x], axis=-1)


def even_room(directions, radiance=0.3):
    return np.full(directions.shape, radiance)


def surroundings(directions, lamps, environment=room):
    """Radiance (..., 3) from unit directions."""
    radiance = environment(directions)
    for lamp in lamps:
        inside = directions @ unit(lamp.direction) > np.cos(np.radians(lamp.radius_deg))
        radiance = np.where(inside[..., None], np.array(lamp.radiance), radiance)
    return radiance


def photograph(
    camera,
    ball,
    lamps,
    *,
    kind="mirror",
    environment=room,
    desk=None,
    reflectance=(0.75, 0.72, 0.7),
    ambient=0.1,
    fine=4,
):
    """Radiance (H, W, 3), float32, fine × fine rays per pixel. ball None: without one."""
    rows, columns = camera.height * fine, camera.width * fine
    image = np.zeros((camera.height, camera.width, 3), np.float32)
    step = max(fine, _STRIP // columns // fine * fine)
    x = (np.arange(columns) + 0.5) / fine
    for start in range(0, rows, step):
        y = (np.arange(start, min(start + step, rows)) + 0.5) / fine
        xy = np.stack(np.meshgrid(x, y), axis=-1)
        radiance = _traced(camera.rays(xy), ball, lamps, kind, environment, desk, reflectance, ambient)
        blocks = radiance.reshape(len(y) // fine, fine, camera.width, fine, 3)
        image[start // fine : start // fine + len(y) // fine] = blocks.mean(axis=(1, 3))
    return image


def _traced(rays, ball, lamps, kind, environment, desk, reflectance, ambient):
    radiance = _seen(np.zeros(3), rays, lamps, environment, desk)
    if ball is None:
        return radiance
    normals = ball.normals(rays)
    on_ball = np.isfinite(normals[..., 0])
    hit = normals[on_ball]
    if kind == "mirror":
        points = ball.centre + ball.radius * hit
        shown = _seen(points, reflected(rays[on_ball], hit), lamps, environment, desk)
        radiance[on_ball] = shown * reflectance
    else:
        light = np.full((len(hit), 3), float(ambient))
        for lamp in lamps:
            light += np.maximum(hit @ unit(lamp.direction), 0)[:, None] * lamp.irradiance / np.pi
        radiance[on_ball] = light * reflectance
    return radiance


def _seen(points, rays, lamps, environment, desk):
    """Radiance along rays from points: the desk, or what is at infinity."""
    radiance = surroundings(rays, lamps, environment)
    if desk is None:
        return radiance
    start = (np.asarray(points) - desk.origin) @ desk.camera_from_marker
    direction = rays @ desk.camera_from_marker
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = -start[..., 2] / direction[..., 2]
        place = (start + depth[..., None] * direction)[..., :2]
        on_desk = (depth > 1e-9) & (np.abs(place) < desk.half_size).all(axis=-1)
    radiance[on_desk] = _desk_radiance(desk, place[on_desk])
    return radiance


def _desk_radiance(desk, place):
    radiance = np.full((len(place), 3), 0.28)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    for number, middle in zip(desk.ids, desk.places, strict=True):
        bits = cv2.aruco.generateImageMarker(dictionary, number, 6) > 0
        cell = (place - middle) / desk.side * 6 + 3
        white = (np.abs(cell - 3) < 4.2).all(axis=1)
        radiance[white] = 0.8
        inside = (np.abs(cell - 3) < 3).all(axis=1)
        column, row = cell[inside].astype(int).clip(0, 5).T
        radiance[np.flatnonzero(inside)] = np.where(bits[5 - row, column], 0.8, 0.02)[:, None]
    return radiance


def degraded(image, *, blur_px=0.0, noise=0.0, seed=0):
    """With a Gaussian blur [px] and noise: a part of the median, growing with the root of the signal."""
    if blur_px:
        image = cv2.GaussianBlur(image, (0, 0), blur_px)
    if noise:
        level = float(np.median(image))
        sigma = noise * np.sqrt(level * np.maximum(image, level))
        image = image + np.random.default_rng(seed).normal(size=image.shape) * sigma
    return np.maximum(image, 0).astype(np.float32)


def codes(image, exposure=1.0):
    """sRGB values from 0 to 1, in steps of 1/255."""
    from expanded_panoramas.ibl_toolkit.images.png import srgb_codes

    return srgb_codes(image, exposure) / np.float32(255)


def hdr(image):
    return Photo.from_radiance(image)


def ldr(image, exposure=1.0):
    return Photo.from_codes(codes(image, exposure))


def desk_before(camera_height=0.5, away=0.6, **how):
    """A desk seen from above at a slant; the marker's y points away from the camera."""
    eye = np.array([0.08, -away, camera_height])
    forward = unit(np.array([0.03, 0.04, 0.03]) - eye)
    right = unit(np.cross(forward, (0, 0, 1)))
    camera_from_marker = np.stack([right, np.cross(forward, right), forward])
    return Desk(camera_from_marker, -camera_from_marker @ eye, **how)


def angle_deg(one, other):
    one, other = unit(one), unit(other)
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other)))


def ball_of_pixels(camera, diameter_px, aside=(0.0, 0.0), radius=0.05):
    """A ball whose picture is about so wide, in the direction `aside` (tangents) of the picture's middle."""
    angular = np.arctan(diameter_px / 2 / camera.focal[0])
    return Ball(unit([*aside, 1.0]) * radius / np.sin(angular), radius)
