"""The quiet map that is left when the lamps are out of a light map, and how quiet it is.

Diffuse light does not see detail, so the rest of a map may be far smaller than the map: what is too small to
become a light of its own is spread, its power kept, and makes no white dots (a pre-sampling map on a regular
grid; thesis, sections 3.1.3 and 3.2).
"""

from __future__ import annotations

import cv2
import numpy as np

from .. import equirectangular
from .light_map import luminance

WIDTH = 128
"""Of the quiet map [px]: 2.8°, far below what a diffuse surface resolves."""


def quiet_map(image: np.ndarray, lamps: np.ndarray, *, behind_lamps: bool) -> np.ndarray:
    """Return the map (h, w, 3), at most WIDTH pixels wide, without the pixels of a mask (H, W).

    behind_lamps: the lamps stand before the surface and hide those pixels, so that each pixel of the quiet
    map is the mean of what they leave of it. Otherwise the pixels are black, and the map's power is what the
    others hold; it is kept within float32 rounding either way.

    >>> image = np.ones((128, 256, 3), np.float32)
    >>> lamps = np.zeros((128, 256), bool)
    >>> lamps[64, :64] = True
    >>> [round(float(quiet_map(image, lamps, behind_lamps=b)[32, 0, 0]), 2) for b in (True, False)]
    [1.0, 0.5]
    """
    height, width = lamps.shape
    solid_angles = np.broadcast_to(equirectangular.row_solid_angles(width, height)[:, None], lamps.shape)
    left = np.where(lamps, 0, solid_angles)
    size = (min(WIDTH, width), min(WIDTH, width) * height // width)
    power = cv2.resize(image * left[..., None], size, interpolation=cv2.INTER_AREA)
    if behind_lamps:
        power, area = _spread_into_holes(power, cv2.resize(left, size, interpolation=cv2.INTER_AREA))
    else:
        area = equirectangular.row_solid_angles(*size)[:, None] * (size[0] * size[1] / lamps.size)
    return (power / area[..., None]).astype(np.float32)


def _spread_into_holes(power, area):
    """Give pixels without area what is around them: a lamp hides them, yet look-ups beside it reach them."""
    kernel = np.full((3, 3), 1 / 9)  # cv2.blur would leave traces in its running sums
    while (holes := area <= 0).any():
        around = cv2.filter2D(power, -1, kernel), cv2.filter2D(area, -1, kernel)
        if not around[1].any():
            return power, np.ones_like(area)  # the lamps cover everything
        power, area = np.where(holes[..., None], around[0], power), np.where(holes, around[1], area)
    return power, area


def noise(residual: np.ndarray, image: np.ndarray) -> float:
    """Return how noisy a residual map (h, w, 3) is to random rays, against its whole map's light.

        4π ∫ L_residual² dω / (∫ L_map dω)²

    the second moment of light gathered by one ray in a uniformly random direction; 1 for a constant map that
    is its own residual, 0 where nothing is left.

    >>> constant = np.ones((16, 32, 3), np.float32)
    >>> round(noise(constant, constant), 6), noise(0 * constant, constant)
    (1.0, 0.0)
    """
    second_moment = _integral(luminance(residual).astype(float) ** 2)
    return float(4 * np.pi * second_moment / _integral(luminance(image).astype(float)) ** 2)


def _integral(values):
    """∫ over the sphere of values (H, W)."""
    height, width = values.shape
    return values.sum(axis=1) @ equirectangular.row_solid_angles(width, height)
