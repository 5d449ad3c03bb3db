"""A mirror ball unwrapped: the panorama that it shows, with the perspective of the camera's own distance.

In the plane of the ball's axis and a mirrored ray, with the camera D radii from the ball's centre: at the
surface point whose normal stands at the angle θ from the axis, towards the camera, the camera is seen at

    γ(θ) = atan2(sin θ, D − cos θ)

behind the axis, so the ray is mirrored to the angle α = 2θ + γ. What lies R radii from the centre is met at
ψ(θ) = α − asin(sin(θ + γ) / R), and at ψ = α where R is infinite. Both grow with θ, up to the rim, where
cos θ = 1/D: so one Newton iteration per direction finds the θ that shows it. Beyond is what the ball hides
from itself: seen from its centre, a blind spot of the half angle asin(1/D), if R is infinite.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ... import equirectangular
from ...images import write_exr
from .errors import ProbeError
from .samples import in_picture

PANORAMA_FROM_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Where there is no marker: the panorama's middle is where the camera looks, its top is the picture's."""
_STEPS = 60
_CLOSE = 1e-12  # [rad]
_STRIP = 1 << 18  # directions per step
_RIM = 1e-9
_REMAP = 16384  # points: OpenCV's limit to a picture's rows is 32767


@dataclass(frozen=True, eq=False)
class Unwrapped:
    """radiance: (H, W, 3) float32, black where unknown. known: (H, W) bool, False in the blind spot."""

    radiance: np.ndarray
    known: np.ndarray


def normal_angle(psi, distance, surroundings=np.inf) -> np.ndarray:
    """Angle θ [rad] from the ball's axis of the normals that show what stands at angles psi [rad] from it.

    Angles are seen from the ball's centre, and from its side that looks at the camera. distance: of the
    camera, surroundings: of what is shown, from the centre, in radii of the ball. NaN in the blind spot.

    Raises: ProbeError where camera or surroundings are in the ball.

    >>> float(np.degrees(normal_angle(np.radians(90.0), 1e9)).round(6))
    45.0
    """
    if not distance > 1 or not surroundings > 1:
        raise ProbeError(
            f"camera {distance:.3g} and surroundings {surroundings:.3g} radii away: must be above 1"
        )
    psi = np.asarray(psi, dtype=np.float64)
    rim = np.arccos(1 / distance)
    seen = psi <= _shown(rim, distance, surroundings)[0] + _RIM
    theta = np.clip(psi / 2, 0, rim)
    low, high = np.zeros_like(theta), np.full_like(theta, rim)
    for _ in range(_STEPS):
        value, slope = _shown(theta, distance, surroundings)
        error = value - psi
        high, low = np.where(error > 0, theta, high), np.where(error > 0, low, theta)
        step = theta - error / slope
        # A step that leaves what is still possible is halved into it: the iteration cannot run away.
        step = np.where((step >= low) & (step <= high), step, (low + high) / 2)
        moved, theta = np.abs(step - theta).max(initial=0.0), step
        if moved < _CLOSE:
            break
    return np.where(seen, theta, np.nan)


def unwrap(photo, camera, ball, width, panorama_from_camera=None, surroundings=np.inf) -> Unwrapped:
    """The panorama, `width` by `width` / 2 px, that a mirror ball shows, seen from its centre.

    panorama_from_camera: (3, 3) rotation, by default PANORAMA_FROM_CAMERA. surroundings: distance from the
    ball's centre of all that is shown, in the ball's unit; infinite: far away. What the frame cuts off the
    ball is unknown, as is the blind spot.

    Raises: ProbeError for a width that is odd or below 4, and surroundings within the ball.
    """
    if width < 4 or width % 2:
        raise ProbeError(f"panorama's width {width} px must be even, 4 or more")
    turn = PANORAMA_FROM_CAMERA if panorama_from_camera is None else np.asarray(panorama_from_camera)
    fine = max(1, round(natural_width(camera, ball) / width))  # a coarser panorama than the photograph's own
    size = (width * fine, width * fine // 2)
    directions = equirectangular.pixel_directions(*size).reshape(-1, 3)
    picture = _ball_alone(photo, camera, ball)
    strips = [
        _look_up(picture, camera, ball, directions[start : start + _STRIP] @ turn, surroundings)
        for start in range(0, len(directions), _STRIP)
    ]
    radiance = np.concatenate([strip[0] for strip in strips]).reshape(size[1], size[0], 3)
    known = np.concatenate([strip[1] for strip in strips]).reshape(size[1], size[0])
    return _averaged(radiance, known, fine)


def write_unwrapped(unwrapped, path):
    """Write the panorama as OpenEXR, with an alpha of 0 where nothing is known.

    Raises: OSError where it cannot be written.
    """
    colours = {name: np.ascontiguousarray(unwrapped.radiance[..., k]) for k, name in enumerate("RGB")}
    write_exr(path, {**colours, "A": unwrapped.known.astype(np.float32)})


def natural_width(camera, ball) -> int:
    """Width [px] of the panorama whose pixels are as large as the photograph's on the side of the camera.

    A pixel in the ball's middle turns the normal by one part of its radius in pixels, and the mirrored ray by
    two.
    """
    xy = camera.pixels(ball.outline())
    radius = np.sqrt(np.prod(np.nanmax(xy, axis=0) - np.nanmin(xy, axis=0))) / 2
    return int(2 * np.ceil(np.pi * radius / 2))


def _shown(theta, distance, surroundings):
    """ψ(θ) and its derivative."""
    sine, cosine = np.sin(theta), np.cos(theta)
    gamma = np.arctan2(sine, distance - cosine)
    gamma_slope = (distance * cosine - 1) / (distance**2 - 2 * distance * cosine + 1)
    bend = np.sin(theta + gamma) / surroundings
    bend_slope = np.cos(theta + gamma) * (1 + gamma_slope) / (surroundings * np.sqrt(1 - bend**2))
    return 2 * theta + gamma - np.arcsin(bend), 2 + gamma_slope - bend_slope


def _ball_alone(photo, camera, ball):
    """The pixels on the ball (h, w, 3), those beside it as the nearest on it; and their corner [px].

    So that a look-up between pixels at the rim takes nothing from behind the ball.
    """
    samples = in_picture(photo, camera, ball)
    _, labels = cv2.distanceTransformWithLabels(
        (~samples.mask).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    value_of = np.zeros((labels.max() + 1, 3), np.float32)
    value_of[labels[samples.mask]] = samples.radiance[samples.mask]
    return value_of[labels], samples.corner


def _look_up(picture, camera, ball, directions, surroundings):
    """Radiance (n, 3), and whether it is known (n,), in directions (n, 3) of the frame `camera`."""
    cosine = np.clip(-directions @ ball.axis, -1, 1)
    side = directions + cosine[:, None] * ball.axis
    length = np.linalg.norm(side, axis=1)
    theta = normal_angle(np.arctan2(length, cosine), ball.distance / ball.radius, surroundings / ball.radius)
    side /= np.maximum(length, 1e-30)[:, None]
    normals = np.sin(theta)[:, None] * side - np.cos(theta)[:, None] * ball.axis
    xy = camera.pixels(ball.centre + ball.radius * np.nan_to_num(normals))
    known = np.isfinite(theta) & camera.is_inside(xy)
    image, corner = picture
    places = np.where(known[:, None], xy - corner - 0.5, 0).astype(np.float32)
    blocks = [
        cv2.remap(image, block[:, :1], block[:, 1:], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)[:, 0]
        for block in np.split(places, range(_REMAP, len(places), _REMAP))
    ]
    return np.where(known[:, None], np.concatenate(blocks), 0), known


def _averaged(radiance, known, fine):
    """Means of fine × fine pixels, over those that are known."""
    if fine == 1:
        return Unwrapped(radiance.astype(np.float32), known)
    height, width = known.shape
    blocks = (height // fine, fine, width // fine, fine)
    count = known.reshape(blocks).sum(axis=(1, 3))
    total = radiance.reshape(*blocks, 3).sum(axis=(1, 3))
    return Unwrapped((total / np.maximum(count, 1)[..., None]).astype(np.float32), count > 0)
