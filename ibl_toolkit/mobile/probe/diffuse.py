"""Lights from a diffuse ball, by its shading.

The paper takes the brightest part's centroid and reflects there; on a diffuse ball the brightest normal
itself points to the light, and a maximum is where a cosine tells least of its place. All of the shading tells
more.
"""

from __future__ import annotations

import cv2
import numpy as np

from ...light.light_map import LUMINANCE
from .errors import ProbeError
from .lights import ProbeLight
from .shading import fit_shading

MOST_SAMPLES = 2500
"""More cells are averaged down: the fit's accuracy is that of the picture's outline by then."""
RIM = 0.3
"""Cosine of normal and sight below which a cell is left out: blur and outline errors tell most there."""
LEAST_FITTED = 3
"""Lights that are fitted, however few are asked for: what is left out would turn the others."""
FLAT = 0.05
"""Lights that bring less than this part of the mean luminance are no shading."""
LEAST_LIT = 0.12
"""Of the visible ball that a light should reach."""
UNCERTAIN_DEG = 3.0
MOST_CLIPPED = 0.7
"""Of the ball; of the rest, the shading is still told."""
MISFIT = 0.06
"""Residual over mean luminance beyond which the ball is not as the model says."""


def diffuse_lights(samples, count) -> tuple[list[ProbeLight], float, tuple[str, ...]]:
    """The `count` strongest lights, or fewer, that shade a diffuse ball -> lights, residual, warnings.

    residual: rms of the shading that the lights leave unexplained, over the mean luminance.

    Raises: ProbeError where the ball is black, evenly bright, or clipped for the most part.
    """
    normals, radiance, clipped = _usable(samples)
    share = np.count_nonzero(samples.clipped) / np.count_nonzero(samples.mask)
    if share > MOST_CLIPPED:
        raise ProbeError(f"{share:.0%} of the ball is saturated: no shading is left, expose shorter")
    luminance = radiance @ LUMINANCE
    mean = float(luminance.mean())
    if not mean > 0:
        raise ProbeError("the ball is black: expose longer")
    shading = fit_shading(normals, luminance / mean, max(count, LEAST_FITTED), clipped)
    lengths = np.linalg.norm(shading.vectors, axis=1)
    keep = lengths > FLAT
    if not keep.any():
        raise ProbeError(
            f"no shading on the ball: its luminance varies by {luminance.std() / mean:.1%}, light comes from "
            "everywhere alike, or from behind the ball"
        )
    directions = shading.vectors[keep] / lengths[keep][:, None]
    colours = _colours(normals, radiance, clipped, directions, shading.ambient)
    facing = normals @ directions.T > 0
    lights = [
        ProbeLight(d, c, float("nan"), float(u), int(np.count_nonzero(f)), bool((clipped & f).any()), False)
        for d, c, u, f in zip(directions, colours, shading.uncertainty_deg[keep], facing.T, strict=True)
    ]
    lights.sort(key=lambda light: -light.luminance)
    lights = lights[:count]
    return lights, shading.rms, tuple(_warnings(lights, shading, len(normals)))


def _usable(samples):
    """Normals, radiance and clipped of the cells that are not too slanted, averaged down if many."""
    views = -_cosine(samples)
    mask = samples.mask & (views > RIM)
    step = int(np.sqrt(np.count_nonzero(mask) / MOST_SAMPLES))
    if step < 2:
        return samples.normals[mask], samples.radiance[mask].astype(np.float64), samples.clipped[mask]
    return _averaged(samples, mask, step)


def _averaged(samples, mask, step):
    def mean(values):
        height, width = (length // step * step for length in mask.shape)
        return cv2.resize(
            np.ascontiguousarray(values[:height, :width], dtype=np.float64),
            (width // step, height // step),
            interpolation=cv2.INTER_AREA,
        )

    whole = mean(mask) > 1 - 1e-9
    normals = mean(np.nan_to_num(samples.normals))[whole]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return normals, mean(samples.radiance)[whole], mean(samples.clipped)[whole] > 0


def _cosine(samples):
    """Of normal and ray of sight: the ray is what is mirrored to `mirrored`, r·n = −c·n."""
    return -np.sum(samples.mirrored * samples.normals, axis=2)


def _colours(normals, radiance, clipped, directions, ambient):
    """Irradiance (k, 3) of lights of known directions, each channel by itself, none below 0."""
    around = ambient[0] + normals @ ambient[1:] if ambient[0] > 0 else np.ones(len(normals))
    columns = np.column_stack([np.maximum(normals @ directions.T, 0), around])[~clipped]
    result = np.zeros((len(directions), 3))
    for channel in range(3):
        kept = list(range(columns.shape[1]))
        while kept:
            solved = np.linalg.lstsq(columns[:, kept], radiance[~clipped, channel], rcond=None)[0]
            if solved.min() >= 0:
                break
            kept.pop(int(np.argmin(solved)))
        for index, value in zip(kept, solved, strict=True):
            if index < len(directions):
                result[index, channel] = value
    return result


def _warnings(lights, shading, cells):
    for number, light in enumerate(lights, 1):
        if light.cells < LEAST_LIT * cells:
            yield (
                f"light {number} reaches {light.cells / cells:.0%} of the visible ball, its rim: it "
                "stands behind the ball, and its direction is uncertain"
            )
        elif light.uncertainty_deg > UNCERTAIN_DEG:
            yield (
                f"light {number}: its direction is uncertain by {light.uncertainty_deg:.0f}°, others hide "
                "its shading or explain it as well"
            )
    if shading.rms > MISFIT:
        yield (
            f"the shading misses the fit by {shading.rms:.0%} of its mean: more lights, a ball that is not "
            "matt, or a shadow on it"
        )
