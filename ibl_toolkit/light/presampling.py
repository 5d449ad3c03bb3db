"""Pre-sampling maps: a light map as its samples, their regions, and an environment of the regions' means.

The environment needs far fewer pixels than the map, for it holds no more than the samples do.

Source: thesis, section 3.1.3: positions, an equirectangular image of the partition, energies.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .. import equirectangular
from ..images import DEFAULT_MAX_BYTES, ImageError, exr, exr_header, write_exr
from ..images.checking import refuse_impossible_radiance, refuse_other_shapes
from .samples import LightSamples

SAMPLES = "panorama.lightSamples"
"""Header attribute: JSON {"direction": [[x, y, z], …], "irradiance": [[r, g, b], …], "solid_angle": […]}."""
REGION = "region"
"""Channel of unsigned integers: 1 + the number of the sample that a pixel belongs to, 0 outside them all."""
_UNIT = 1e-6
_WHOLE_SPHERE = 4 * np.pi * (1 + 1e-6)


@dataclass(frozen=True)
class PresamplingMap:
    """A light map as samples; both images are of one size, which may be less than the map's."""

    samples: LightSamples
    """With the irradiance and the solid angles that the regions have in the map itself."""
    environment: np.ndarray
    """(h, w, 3) float32: the regions' mean radiance, averaged over each pixel; 0 outside all regions."""

    @classmethod
    def from_samples(cls, samples, width=None):
        """The pre-sampling map of LightSamples, `width` pixels wide, or as wide as their partition.

        Each region's irradiance is the environment's integral over it, but for pixels on its border, and that
        of the whole is kept within 1e-6 at any width.

        Raises: ValueError unless `width` divides the partition's width, and its height by the same.

        >>> from .samples import samples_from_sites
        >>> image = np.random.default_rng(1).random((16, 32, 3), dtype=np.float32)
        >>> samples = samples_from_sites(image, [[1, 0, 0], [-1, 1, 0], [0, 0, 1]])
        >>> PresamplingMap.from_samples(samples, 8).environment.shape
        (4, 8, 3)
        """
        step = _step(samples.partition.shape, width)
        middle = samples.partition[step // 2 :: step, step // 2 :: step]
        return cls(replace(samples, partition=middle.copy()), _averaged(samples, step))


def write_presampling(path, presampling):
    """Write a PresamplingMap as one OpenEXR file, all or nothing.

    R, G and B (32-bit float) are the environment, so that it is a panorama for any program; `region` is the
    partition and the header holds the samples.

    Raises: ImageError unless it is 2:1.
    """
    samples, path = presampling.samples, Path(path)
    height, width = samples.partition.shape
    refuse_other_shapes(width, height, path)
    text = json.dumps(
        {
            "direction": samples.directions.tolist(),
            "irradiance": samples.irradiance.tolist(),
            "solid_angle": samples.solid_angles.tolist(),
        }
    )
    channels = {name: presampling.environment[..., k] for k, name in enumerate("RGB")}
    channels[REGION] = (samples.partition + 1).astype(np.uint32)
    write_exr(path, channels, {SAMPLES: text})


def read_presampling(path, *, max_bytes=DEFAULT_MAX_BYTES):
    """The PresamplingMap in a file as `write_presampling` makes it.

    Raises: ImageError, naming file and value, for a file that cannot be decoded within `max_bytes`, is not
    2:1, lacks a channel or the samples, or whose samples, regions or radiance are impossible. OSError for one
    that cannot be opened.
    """
    path = Path(path)
    parts = exr.refuse_unreadable(path, max_bytes)
    part = parts[0]
    names = "R", "G", "B", REGION
    found = {(c.name, c.pixel_type) for c in part.channels if c.sampling == (1, 1)}
    if not found >= {*((name, exr_header.FLOAT) for name in "RGB"), (REGION, exr_header.UINT)}:
        raise ImageError(f"{path}: a pre-sampling map has 32-bit floats R G B and unsigned integers {REGION}")
    window = part.data_window
    if window != part.display_window:
        raise ImageError(f"{path}: data window {window} must be display window {part.display_window}")
    refuse_other_shapes(exr_header.window_width(window), exr_header.window_height(window), path)
    pixels, attributes = exr.decode(path, parts, 0, names)
    regions = pixels.pop(REGION)
    environment = exr.stacked(pixels, "RGB")
    refuse_impossible_radiance(environment, path)
    samples = _samples(attributes.get(SAMPLES), regions, path)
    return PresamplingMap(samples, environment)


def _step(shape, width):
    height, full = shape
    width = full if width is None else width
    if width < 1 or full % width or height % (full // width):
        raise ValueError(f"width is {width}: must divide the map's width, {full}, and its height, {height}")
    return full // width


def _averaged(samples, step):
    """The regions' mean radiance, averaged over blocks of step × step pixels: (H/step, W/step, 3) float32."""
    height, width = samples.partition.shape
    means = np.zeros((len(samples) + 1, 3))  # the last is found by the pixels outside, -1
    means[:-1] = samples.irradiance / samples.solid_angles[:, None]
    solid_angles = equirectangular.row_solid_angles(width, height)
    result = np.empty((height // step, width // step, 3), np.float32)
    for row in range(height // step):
        rows = slice(row * step, (row + 1) * step)
        weights = solid_angles[rows] / (solid_angles[rows].sum() * step)
        shown = means[samples.partition[rows]].reshape(step, width // step, step, 3)
        result[row] = np.einsum("r,rcsk->ck", weights, shown)
    return result


def _samples(text, regions, path):
    try:
        fields = json.loads(text)
        directions, irradiance, solid_angles = (
            np.array(fields[key], np.float64) for key in ("direction", "irradiance", "solid_angle")
        )
    except (TypeError, ValueError, KeyError, OverflowError, RecursionError) as error:
        raise ImageError(f"{path}: attribute {SAMPLES} holds no list of samples: {error!r}") from error
    count = len(solid_angles) if solid_angles.ndim == 1 else 0
    if not count or directions.shape != (count, 3) or irradiance.shape != (count, 3):
        raise ImageError(
            f"{path}: attribute {SAMPLES} has directions {directions.shape}, irradiance {irradiance.shape} "
            f"and solid angles {solid_angles.shape}; must be (n, 3), (n, 3) and (n,)"
        )
    for what, is_right in (
        ("directions of length 1", abs(np.linalg.norm(directions, axis=1) - 1) <= _UNIT),
        ("finite irradiance from 0", ((irradiance >= 0) & np.isfinite(irradiance)).all(axis=1)),
        ("solid angles above 0", (solid_angles > 0) & (solid_angles <= _WHOLE_SPHERE)),
    ):
        if not is_right.all():
            first = int(np.argmin(is_right))
            raise ImageError(f"{path}: attribute {SAMPLES}: sample {first} is impossible: must have {what}")
    if regions.max() > count:
        raise ImageError(f"{path}: region {regions.max()} has no sample: there are {count}")
    uv = equirectangular.uv_from_direction(directions)
    return LightSamples(uv, directions, irradiance, solid_angles, regions.astype(np.int32) - 1)
