"""The outline of a ball in the picture, as the cone of rays that touch it, measured to a part of a pixel.

Across an expected outline, the places are found where brightness changes most; the cone through them is
fitted with Tukey's weights, a few times over.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .ball import Ball, ball_from_rays
from .edges import EdgePicture, steepest
from .errors import ProbeError

NEAR = 1.6
"""Distance from an outline [px] up to which an edge counts for it."""
_TUKEY = 4.685
_MAD = 1.4826
_PASSES = 6
_SIZES = 5
_SHARP = 0.7  # px from the outline within which an edge is its own
_LEAST = 0.2  # of the outline that must show an edge of any kind


@dataclass(frozen=True, eq=False)
class Outline:
    """ball: of radius 1, whose outline it is. coverage: share of the outline where it was seen.

    residual_px: rms distance of the points (n, 2) [px] of the picture from the outline.
    """

    ball: Ball
    coverage: float
    residual_px: float
    points: np.ndarray


def outline_from_points(camera, points) -> Outline:
    """The outline through picture points (n ≥ 3, 2) [px].

    Raises: ProbeError for too few points, and where no ball has such an outline.
    """
    points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    ball = ball_from_rays(camera.rays(points))
    distances = distances_px(camera, ball, points)
    return Outline(ball, 1.0, float(np.sqrt(np.mean(distances**2))), points)


def measure_outline(luminance, camera, ball, reach_px=None) -> Outline | None:
    """The outline near that of `ball`, measured across in linear luminance (H, W) float32, about 1 at white.

    None where too little of it is seen. reach_px: how far from it brightness is looked at, first; by default
    6 % of the radius, at least 2.5 px. In the end the outermost edge counts: a mirror has edges of its own.
    Where the ball is as bright as what is behind it, shading inside is the nearest edge; so several sizes are
    begun with, and the outline on the sharpest edges is taken.
    """
    picture, radius = EdgePicture(luminance), radius_px(camera, ball)
    reach = reach_px or max(2.5, 0.06 * radius)
    found = []
    for more in np.linspace(-reach, reach, _SIZES):
        start = _resized(ball, 1 + more / radius)
        fitted = _converged(picture, camera, start, reach) if start is not None else None
        if fitted is not None:
            found.append(fitted)
    if not found:
        return None
    cap = max(float(np.median(slopes)) for _, slopes in found)
    return max(found, key=lambda pair: np.minimum(pair[1], cap).mean())[0]


def _converged(picture, camera, ball, reach):
    """The outline from one start, and the slopes (n,) across it, 0 where it shows no edge; None if none."""
    count = int(np.clip(2 * np.pi * radius_px(camera, ball), 90, 720))
    for step in range(_PASSES):
        xy, outward = outline_pixels(camera, ball, count)
        points, slopes, found = steepest(picture, xy, outward, reach, outermost=step >= 2)
        fitted = (
            _fitted(camera, points[found], slopes[found])
            if np.count_nonzero(found) >= _LEAST * count
            else None
        )
        if fitted is None:
            return None
        ball, distances = fitted
        reach = max(reach / 2, 1.5) if step else reach
    near = np.abs(distances) < max(_TUKEY * _MAD * np.median(np.abs(distances)), 0.2)
    coverage = np.count_nonzero(np.abs(distances) < NEAR) / count
    residual = float(np.sqrt(np.mean(distances[near] ** 2)))
    on_it = np.where(np.abs(distances) < _SHARP, slopes[found], 0)
    on_it = np.concatenate([on_it, np.zeros(count - len(on_it))])
    return Outline(ball, float(coverage), residual, points[found][near]), on_it


def _resized(ball, factor):
    """A ball in the same direction whose angular radius is a factor times as large; None if none."""
    angle = ball.angular_radius * factor
    if not 0 < angle < 1.4:
        return None
    return Ball(ball.axis / np.sin(angle), 1.0)


def _fitted(camera, points, slopes):
    """The ball whose outline passes points (n, 2) [px], and their distances (n,) [px] from it; or None."""
    rays = camera.rays(points)
    clear = np.minimum(slopes / np.median(slopes), 1)
    weights = clear
    for _ in range(5):
        try:
            ball = ball_from_rays(rays, weights)
        except ProbeError:
            return None
        distances = distances_px(camera, ball, points)
        scale = max(_MAD * np.median(np.abs(distances)), 0.05)
        weights = clear * np.maximum(1 - np.square(distances / (_TUKEY * scale)), 0)
    return ball, distances


def outline_pixels(camera, ball, count) -> tuple[np.ndarray, np.ndarray]:
    """Points (count, 2) [px] of a ball's outline and the outward normals (count, 2) of the picture there."""
    xy = camera.pixels(ball.outline(count))
    xy = np.nan_to_num(xy, nan=-1e6)
    tangent = np.roll(xy, -1, axis=0) - np.roll(xy, 1, axis=0)
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    outward = np.sign(np.sum(normal * (xy - xy.mean(axis=0)), axis=1, keepdims=True))
    return xy, normal * outward


def distances_px(camera, ball, points):
    """Signed distances (n,) [px] of picture points from a ball's outline, to first order outside of it."""
    rays = camera.rays(points)
    angle = np.arccos(np.clip(rays @ ball.axis, -1, 1)) - ball.angular_radius
    towards = ball.axis - (rays @ ball.axis)[:, None] * rays
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-12)
    step = 1e-4
    scale = np.linalg.norm(camera.pixels(rays + step * towards) - points, axis=1) / step
    return angle * scale


def radius_px(camera, ball) -> float:
    """Mean radius of a ball's picture [px], without distortion."""
    (fx, fy), cosine = camera.focal, ball.centre[2] / ball.distance
    return float(np.sqrt(fx * fy) * np.tan(ball.angular_radius) / max(cosine, 0.05) ** 1.5)
