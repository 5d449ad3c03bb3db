"""What a photograph shows on a ball, in the picture's own pixels or on a grid of the ball's surface."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ...equirectangular import direction_from_uv
from ...light.light_map import LUMINANCE
from .ball import across, reflected
from .errors import ProbeError

SPHERE_SIZE = 128
"""Cells of the ball's own domain along u and along v, over the half that faces the camera."""
LEAST_VISIBLE = 0.5
"""Of the outline in the frame; below, a ball is not used."""
LEAST_PIXELS = 40
"""A ball that covers fewer tells nothing."""
_SIDEWAYS = 0.05  # cosine of normal and sight below which a cell of the ball's own domain is too slanted


@dataclass(frozen=True, eq=False)
class BallSamples:
    """Arrays over a domain of (h, w) cells; what is outside of `mask` has no meaning.

    radiance (h, w, 3) and luminance (h, w), linear. clipped (h, w) bool. normals (h, w, 3) of the ball, and
    mirrored (h, w, 3), the directions that a mirror ball shows: unit vectors in the frame `camera`.
    solid_angle: (h, w) [sr] that the cell's mirrored directions span. corner: (2,) [px] of the cells' first
    corner in the picture, or None on the ball's own domain.
    """

    radiance: np.ndarray
    luminance: np.ndarray
    clipped: np.ndarray
    normals: np.ndarray
    mirrored: np.ndarray
    solid_angle: np.ndarray
    mask: np.ndarray
    corner: tuple[int, int] | None


def in_picture(photo, camera, ball) -> BallSamples:
    """The pixels that lie wholly on a ball, from the domain of the image.

    Raises: ProbeError for a ball beside the frame, or one too small.

    Source: Realistic Shadows for Mobile Augmented Reality, section III.A, "Domínio da imagem", where the ray
    through a pixel takes the place of the depth buffer.
    """
    left, top, right, bottom = _box(camera, ball)
    corners = np.stack(np.meshgrid(np.arange(left, right + 1), np.arange(top, bottom + 1)), axis=-1)
    corner_rays = camera.rays(corners)
    corner_normals = ball.normals(corner_rays)
    whole = np.isfinite(corner_normals[..., 0])
    mask = whole[:-1, :-1] & whole[1:, :-1] & whole[:-1, 1:] & whole[1:, 1:]
    if np.count_nonzero(mask) < LEAST_PIXELS:
        raise ProbeError(
            f"the ball covers {np.count_nonzero(mask)} px of the photograph, {LEAST_PIXELS} are needed"
        )
    rays = camera.rays(corners[:-1, :-1] + 0.5)
    normals = ball.normals(rays)
    pixels = np.s_[top:bottom, left:right]
    return BallSamples(
        radiance=photo.image[pixels],
        luminance=photo.image[pixels] @ LUMINANCE.astype(np.float32),
        clipped=photo.clipped[pixels] & mask,
        normals=normals,
        mirrored=reflected(rays, normals),
        solid_angle=_areas(reflected(corner_rays, corner_normals)),
        mask=mask,
        corner=(left, top),
    )


def on_ball(photo, camera, ball, size=SPHERE_SIZE) -> BallSamples:
    """The ball's own (u, v) domain: `size` by `size` cells over the half of it that faces the camera.

    u and v as in an equirectangular panorama round the ball whose middle looks at the camera, so that what is
    seen touches neither its seam nor, but for the rim, its poles. The cost is that of `size`, whatever the
    photograph's. Cells between pixels are interpolated.

    Raises: ProbeError as `in_picture`.

    Source: the same section, "Domínio da esfera".
    """
    _box(camera, ball)
    normals, points = _grid(ball, (np.arange(size) + 0.5) / size)
    _, corner_points = _grid(ball, np.arange(size + 1) / size)
    xy = camera.pixels(points)
    rays = points / np.linalg.norm(points, axis=2, keepdims=True)
    facing = -np.sum(rays * normals, axis=2) > _SIDEWAYS
    mask = facing & camera.is_inside(xy)
    radiance = _interpolated(photo.image, xy)
    corner_rays = corner_points / np.linalg.norm(corner_points, axis=2, keepdims=True)
    corner_normals = (corner_points - ball.centre) / ball.radius
    return BallSamples(
        radiance=radiance,
        luminance=radiance @ LUMINANCE.astype(np.float32),
        clipped=(_interpolated(photo.clipped.astype(np.float32), xy) > 0.5) & mask,
        normals=normals,
        mirrored=reflected(rays, normals),
        solid_angle=_areas(reflected(corner_rays, corner_normals)),
        mask=mask,
        corner=None,
    )


def normal_of_uv(ball, uv) -> np.ndarray:
    """Unit normals (..., 3), frame `camera`, of points (..., 2) of the ball's own domain, both in [0, 1].

    >>> from .ball import Ball
    >>> normal_of_uv(Ball(np.array([0.0, 0.0, 5.0]), 1.0), [0.5, 0.5]).round(9) + 0.0
    array([ 0.,  0., -1.])
    """
    uv = np.asarray(uv, dtype=np.float64)
    local = direction_from_uv(np.stack([0.25 + uv[..., 0] / 2, uv[..., 1]], axis=-1))
    side, up = across(-ball.axis)
    return local @ np.stack([-ball.axis, side, up])


def visible_share(camera, ball) -> float:
    """Of the ball's outline, in the frame."""
    return float(np.mean(camera.is_inside(camera.pixels(ball.outline()))))


def _box(camera, ball):
    """left, top, right, bottom [px] of the whole pixels that hold the ball, within the frame."""
    visible = visible_share(camera, ball)
    if visible < LEAST_VISIBLE:
        raise ProbeError(
            f"the frame cuts the ball: {visible:.0%} of its outline is in the photograph, "
            f"{LEAST_VISIBLE:.0%} or more are needed"
        )
    xy = camera.pixels(ball.outline())
    least, most = np.floor(np.nanmin(xy, axis=0)), np.ceil(np.nanmax(xy, axis=0))
    left, top = np.clip(least, 0, (camera.width, camera.height)).astype(int)
    right, bottom = np.clip(most, 0, (camera.width, camera.height)).astype(int)
    return int(left), int(top), int(right), int(bottom)


def _grid(ball, positions):
    normals = normal_of_uv(ball, np.stack(np.meshgrid(positions, positions), axis=-1))
    return normals, ball.centre + ball.radius * normals


def _interpolated(image, xy):
    x, y = np.moveaxis(np.nan_to_num(xy, nan=-1.0).astype(np.float32) - 0.5, -1, 0)
    return cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def _areas(directions):
    """Solid angles (h, w) of the quadrangles between unit directions (h + 1, w + 1, 3); 0 for NaN."""
    one = directions[1:, 1:] - directions[:-1, :-1]
    other = directions[1:, :-1] - directions[:-1, 1:]
    return np.nan_to_num(np.linalg.norm(np.cross(one, other), axis=2) / 2)
