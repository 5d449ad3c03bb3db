"""What an artist should know about the lights of a map: clipped, hot, wide or without depth."""

import numpy as np

from .. import equirectangular
from .choice import percent
from .clipping import find_clipping
from .light_map import LUMINANCE, irradiance, luminance

HOT_PIXEL_SHARE = 0.02
HOT_PIXEL_CONTRAST = 100.0
"""A pixel that holds this part of the map's light and is this many times as bright as each of its neighbours:
no lens draws a lamp so."""
WIDE = np.radians(30)
"""Shadows of a light whose region is a disc of this radius, or more, differ visibly from the map's [rad]."""


def warnings_of(image, samples, positions=None):
    """One sentence each, a tuple: of the map (H, W, 3), its lights, and their positions (n, 3) or None.

    >>> from .samples import samples_from_sites
    >>> image = np.ones((16, 32, 3), np.float32)
    >>> print(*warnings_of(image, samples_from_sites(image, [[0, 0, 1], [0, 0, -1]])))
    2 of 2 lights stand for a region wider than 30° around its middle: take more, or a smaller threshold
    """
    found = [_of_wide_regions(samples)]
    if positions is not None:
        found.append(_of_missing_depth(positions))
    return warnings_of_map(image) + tuple(text for text in found if text)


def warnings_of_map(image):
    """What is suspicious in a map (H, W, 3) itself, a tuple of sentences: a clipped lamp, a hot pixel."""
    return tuple(text for text in (_of_clipping(image), _of_hot_pixel(image)) if text)


def _of_clipping(image):
    found = find_clipping(image)
    if not found.is_clipped:
        return None
    u, v = equirectangular.uv_from_direction(found.direction)
    return (
        f"the light at u {u:.3f}, v {v:.3f} looks clipped: {np.count_nonzero(found.mask)} pixels "
        f"({np.degrees(2 * np.sqrt(found.solid_angle / np.pi)):.2g}° across) share the highest value, "
        f"{LUMINANCE @ found.level:.4g}; unless it is one flat lamp, its light is missing and can be "
        "restored from its irradiance or from a shadow"
    )


def _of_hot_pixel(image):
    brightness = luminance(image)
    height, width = brightness.shape
    row, column = np.unravel_index(int(brightness.argmax()), brightness.shape)
    solid_angle = equirectangular.row_solid_angles(width, height)[row]
    share = brightness[row, column] * solid_angle / (LUMINANCE @ irradiance(image))
    rows = np.clip([row - 1, row, row + 1], 0, height - 1)
    around = brightness[np.ix_(rows, np.arange(column - 1, column + 2) % width)]
    around[rows == row, 1] = 0
    if share < HOT_PIXEL_SHARE or brightness[row, column] < HOT_PIXEL_CONTRAST * around.max():
        return None
    return (
        f"pixel ({column}, {row}) holds {percent(share)} of the light and its neighbours next to none: "
        "a hot pixel of the sensor, or a lamp too small for this resolution"
    )


def _of_wide_regions(samples):
    radii = np.arccos(np.clip(1 - samples.solid_angles / (2 * np.pi), -1, 1))
    count = np.count_nonzero(radii > WIDE)
    if not count:
        return None
    return (
        f"{count} of {len(samples)} lights stand for a region wider than {np.degrees(WIDE):.0f}° around its "
        "middle: take more, or a smaller threshold"
    )


def _of_missing_depth(positions):
    count = np.count_nonzero(np.isnan(positions[:, 0]))
    if not count:
        return None
    return f"{count} of {len(positions)} lights have no depth: they have a direction, but no position"
