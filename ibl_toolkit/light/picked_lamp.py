"""Lamps of a light map, as an artist asks for them: the strongest, or the one at a point of the image."""

from __future__ import annotations

import numpy as np

from .. import equirectangular
from .discs import BRIGHT, LEAST_SHARE, Disc, disc_of_region, split_into_discs
from .light_map import luminance
from .regions import connected_regions

NEAR_PIXELS = 1.5
"""A point this near to a lamp [px of the map] is taken for one on it."""
CORE = 0.1
"""Pixels above this share of a lamp's highest luminance are its core: the sun without the glow around it."""
LEAST_CORE = 0.4
"""A core with less of its region's light is a hot pixel, or a gap between leaves: the region is the lamp."""


def strongest_lamps(image: np.ndarray, count: int = 1) -> tuple[Disc, ...]:
    """Return the lamps of a light map (H, W, 3) that give the most light: regions, not the brightest pixels.

    At most ``count``, at least one; the strongest first. A sun comes without its glow, which would make its
    shadows soft: as the core of its region.
    Raises ValueError where no region stands out, and for what `check_light_map` refuses.

    >>> image = np.full((64, 128, 3), 0.01, np.float32)
    >>> image[10, 10] = 900  # one hot pixel
    >>> image[20:24, 40:48] = 100
    >>> [lamp.pixels.size for lamp in strongest_lamps(image)]
    [32]
    """
    return tuple(_core(image, lamp) for lamp in _lamps(image)[:count])


def lamp_at(image: np.ndarray, uv: np.ndarray) -> Disc:
    """Return the lamp of a light map (H, W, 3) at an image point (2,), as `strongest_lamps` does.

    Raises ValueError, naming the point and the nearest lamp, where there is none; for a map without lamps as
    `strongest_lamps` does.
    """
    lamps = _lamps(image)
    height, width = image.shape[:2]
    at = equirectangular.direction_from_uv(uv)
    directions = equirectangular.pixel_directions(width, height).reshape(-1, 3)
    cosines = [float((directions[lamp.pixels] @ at).max()) for lamp in lamps]
    nearest = int(np.argmax(cosines))
    if np.arccos(min(cosines[nearest], 1)) <= NEAR_PIXELS * np.pi / height:
        return _core(image, lamps[nearest])
    u, v = equirectangular.uv_from_direction(lamps[nearest].direction)
    raise ValueError(
        f"no lamp at u {uv[0]:.3f}, v {uv[1]:.3f}: the nearest is at u {u:.3f}, v {v:.3f}; a lamp is "
        f"{BRIGHT:g} times as bright as the mean and gives {LEAST_SHARE:.1%} of the light"
    )


def _lamps(image):
    """The lamps of a map, the strongest first, at least one."""
    lamps = split_into_discs(image).discs
    if not lamps:
        raise ValueError(
            f"no lamp stands out of this map: none is {BRIGHT:g} times as bright as the mean and gives "
            f"{LEAST_SHARE:.1%} of the light"
        )
    return lamps


def _core(image, lamp):
    """The disc of a lamp's core where that holds much of its light, else the lamp."""
    brightness = luminance(image).ravel()[lamp.pixels]
    mask = np.zeros(image.shape[:2], bool)
    mask.ravel()[lamp.pixels[brightness >= CORE * brightness.max()]] = True
    cores = [disc_of_region(image, pixels) for pixels in connected_regions(mask)]
    core = max(cores, key=lambda disc: disc.irradiance.sum())
    return core if core.irradiance.sum() >= LEAST_CORE * lamp.irradiance.sum() else lamp
