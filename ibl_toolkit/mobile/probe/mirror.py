"""Lights from a mirror ball."""

from __future__ import annotations

import numpy as np

from ...light.light_map import LUMINANCE
from .ball import reflected
from .components import CONTRAST, bright_parts
from .errors import ProbeError
from .lights import ProbeLight
from .samples import normal_of_uv

LARGEST_CLIPPED = 0.5
"""Of the ball: where more is clipped, no highlight is told from another."""


def mirror_lights(samples, count) -> list[ProbeLight]:
    """The `count` strongest lights, or fewer, that a mirror ball shows, by the luminance of their irradiance.

    A light's direction is the mean of the directions that its cells mirror, by their light above what is
    around it times the solid angle that they mirror. (The paper reflects at the centroid of the cells, see
    `reflected_centroid`: near the rim, where a pixel mirrors ever more, that lies off the light's middle.)

    Raises: ProbeError where nothing stands out, or half of the ball is clipped.
    """
    clipped = np.count_nonzero(samples.clipped) / np.count_nonzero(samples.mask)
    if clipped > LARGEST_CLIPPED:
        raise ProbeError(f"{clipped:.0%} of the ball is saturated: no light stands out, expose shorter")
    parts = bright_parts(samples)
    if not parts:
        luminance = samples.luminance[samples.mask]
        contrast = luminance.max() / max(np.median(luminance), 1e-30)
        raise ProbeError(
            f"no highlight on the ball: its brightest pixel has {contrast:.1f} times the median's luminance, "
            f"a light has {CONTRAST:.0f} times or more"
        )
    lights = [_light(samples, part) for part in parts]
    return sorted(lights, key=lambda light: -light.luminance)[:count]


def reflected_centroid(ball, camera, samples, mask) -> np.ndarray:
    """(3,) the direction that the centroid of some cells mirrors, as the paper takes it; frame `camera`.

    In the image it is the mean pixel, on the ball's own domain the mean (u, v).

    Source: Realistic Shadows for Mobile Augmented Reality, section III.A, with the reflection as in
    `reflected`.
    """
    rows, columns = np.nonzero(mask)
    mean = np.array([columns.mean(), rows.mean()]) + 0.5
    if samples.corner is None:
        normal = normal_of_uv(ball, mean / samples.mask.shape[0])
        point = ball.centre + ball.radius * normal
        return reflected(point / np.linalg.norm(point), normal)
    ray = camera.rays(mean + samples.corner)
    return reflected(ray, ball.normals(ray))


def _light(samples, part):
    light = np.maximum(samples.radiance[part.skirt] - part.behind, 0)
    weights = light * samples.solid_angle[part.skirt][:, None]
    luminous = weights @ LUMINANCE
    total = luminous @ samples.mirrored[part.skirt]
    solid_angle = min(float(samples.solid_angle[part.mask].sum()), 4 * np.pi)
    return ProbeLight(
        direction=total / np.linalg.norm(total),
        irradiance=weights.sum(axis=0, dtype=np.float64),
        diameter_deg=float(np.degrees(2 * np.arccos(1 - solid_angle / (2 * np.pi)))),
        uncertainty_deg=float(np.degrees(np.sqrt(np.median(samples.solid_angle[part.mask])) / 2)),
        cells=int(np.count_nonzero(part.mask)),
        is_clipped=part.is_clipped,
        is_cut=part.is_cut,
    )
