"""What a light map holds: checks at the edge, luminance, power per pixel, irradiance over a region.

Power here is radiance integrated over solid angle: the area deformation of the equirectangular format is in
it, exactly per pixel. Sums run in float64, row by row, so that they close within 1e-6 at any size.

Source: thesis section 3.1.1 and appendix A.2.1, eq. A.8-A.10, with Rec. 709's own weights (A.2.1 prints the
rounded 0.2125, 0.7154, 0.0721) and the exact solid angle of a pixel for sin(θ) at its centre.
"""

import cv2
import numpy as np

from .. import equirectangular

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Rec. 709 weights of linear R, G, B."""
_LUMINANCE_ROW = LUMINANCE.astype(np.float32)[None]
STRIP = 16
"""Rows per step: the temporaries of a step then stay in the cache, and no second image is in memory."""


def check_light_map(image):
    """The image (H, W, 3) as float32, if it is a light map: finite, no negative radiance, some light.

    Raises: ValueError for another shape, an odd width (no column would lie opposite to a column), values
    that are not finite or negative, and a map without any light; it says how many values are wrong.

    >>> check_light_map(np.ones((2, 4, 3))).dtype
    dtype('float32')
    >>> check_light_map(np.zeros((2, 4, 3)))
    Traceback (most recent call last):
    ValueError: the light map is black: all of its 2 × 4 pixels are 0; expected some light
    """
    shape = np.shape(image)
    if len(shape) != 3 or shape[2] != 3 or 0 in shape or shape[1] % 2:
        raise ValueError(f"the light map has shape {shape}; expected (H, W, 3) with an even width")
    with np.errstate(over="ignore"):
        image = np.ascontiguousarray(image, dtype=np.float32)
    least, greatest = image.min(), image.max()  # NaN if one of the values is
    if not (least >= 0 and np.isfinite(greatest)):
        _refuse_values(image)
    if greatest == 0:
        height, width = shape[:2]
        raise ValueError(
            f"the light map is black: all of its {height} × {width} pixels are 0; expected some light"
        )
    return image


def check_mask(mask, image):
    """The mask (H, W) as bool, or None for the whole map; ValueError for a shape that is not the image's."""
    if mask is None:
        return None
    if np.shape(mask) != image.shape[:2]:
        raise ValueError(f"the mask has shape {np.shape(mask)}; expected the light map's {image.shape[:2]}")
    return np.ascontiguousarray(mask, dtype=bool)


def check_count(count):
    """The number of samples as an int; ValueError unless it is a whole number of at least 1."""
    if isinstance(count, bool) or int(count) != count or count < 1:
        raise ValueError(f"count is {count}; expected a whole number of samples, at least 1")
    return int(count)


def luminance(image):
    """Rec. 709 luminance (H, W), float32, of an image (H, W, 3).

    >>> luminance(np.ones((2, 4, 3), np.float32))[0, 0].round(6)
    1.0
    """
    image = np.ascontiguousarray(image, dtype=np.float32)
    result = np.empty(image.shape[:2], np.float32)
    cv2.transform(image, _LUMINANCE_ROW, dst=result)
    return result


def luminous_power(image, mask=None):
    """Luminance times solid angle [sr] per pixel, (H, W) float32; 0 outside the mask (H, W).

    Raises: ValueError if no light is inside the mask.

    >>> luminous_power(np.ones((64, 128, 3), np.float32)).sum(dtype=float).round(4)  # 4π
    12.5664
    """
    height, width = image.shape[:2]
    solid_angles = equirectangular.row_solid_angles(width, height)
    power = np.empty((height, width), np.float32)
    for rows in strips(height):
        power[rows] = pixel_power(image[rows], solid_angles[rows], None if mask is None else mask[rows])
    if not power.any():
        raise ValueError("no light is in the chosen part of the map: its luminance is 0; expected some")
    return power


def pixel_power(image, solid_angles, mask=None):
    """As `luminous_power`, of a piece (h, w, 3) of a map with the solid angles (h,) of its rows' pixels."""
    power = luminance(image)
    power *= solid_angles.astype(np.float32)[:, None]
    if mask is not None:
        power *= mask
    return power


def irradiance(image, mask=None):
    """Radiance integrated over solid angle, (3,) RGB: of the whole image (H, W, 3) or inside the mask (H, W).

    >>> (irradiance(np.ones((4, 8, 3), np.float32)) / np.pi).round(12)
    array([4., 4., 4.])
    """
    height, width = image.shape[:2]
    solid_angles = equirectangular.row_solid_angles(width, height)
    total = np.zeros(3)
    for rows in strips(height):
        strip = np.ascontiguousarray(image[rows], dtype=np.float32)
        if mask is not None:
            strip = np.where(mask[rows][..., None], strip, np.float32(0))
        sums = cv2.reduce(strip, 1, cv2.REDUCE_SUM, dtype=cv2.CV_64F)
        total += solid_angles[rows] @ sums.reshape(-1, 3)
    return total


def strips(height, step=STRIP):
    """Slices of rows that cover 0 … height."""
    return (slice(start, min(start + step, height)) for start in range(0, height, step))


def _refuse_values(image):
    not_finite = np.count_nonzero(~np.isfinite(image))
    if not_finite:
        raise ValueError(
            f"the light map has {not_finite} values that are not finite (NaN or infinite); "
            "expected finite radiance"
        )
    negative = np.count_nonzero(image < 0)
    raise ValueError(
        f"the light map has {negative} values of negative radiance, the least {image.min():g}; "
        "expected none below 0"
    )
