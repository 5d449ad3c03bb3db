"""Previews: 8-bit PNG files of HDR images."""

from pathlib import Path

import cv2
import numpy as np

from .atomic import replacing

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)  # Rec. 709
_MID_GREY = 0.18
_ABOUT = 512  # rows that a median needs to be good enough


def write_png(path, image, *, exposure=1.0):
    """Write linear `image` (H, W, 3) or (H, W), times `exposure`, with the sRGB transfer, all or nothing.

    What is below 0 becomes black, what is above 1 white.

    Raises: ValueError for NaN, which no grey stands for.
    """
    image = np.asarray(image, dtype=np.float32)
    unknown = np.count_nonzero(np.isnan(image))
    if unknown:
        raise ValueError(f"{path}: {unknown} values of the image are NaN, they must be numbers")
    encoded = np.round(srgb_from_linear(image * np.float32(exposure)) * 255).astype(np.uint8)
    if encoded.ndim == 3:
        encoded = cv2.cvtColor(encoded, cv2.COLOR_RGB2BGR)
    _, file = cv2.imencode(".png", encoded)
    with replacing(Path(path)) as temporary:
        file.tofile(temporary)


def srgb_from_linear(linear):
    """sRGB values in [0, 1] of linear ones, which are clipped to [0, 1].

    Source: IEC 61966-2-1.

    >>> srgb_from_linear(np.array([-1.0, 0.0, 0.0031308, 0.18, 1.0, np.inf])).round(4)
    array([0.    , 0.    , 0.0404, 0.4614, 1.    , 1.    ])
    """
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def exposure_for(image):
    """Factor that brings the median luminance of `image` (H, W, 3) to mid grey, 0.18.

    The median, so that a sun or a lamp does not count; of what is lit, so that a black surround doesn't
    either.  An image without light has 1.

    >>> round(exposure_for(np.full((4, 8, 3), 0.36, dtype=np.float32)), 6)
    0.5
    """
    step = max(1, len(image) // _ABOUT)
    luminance = np.asarray(image)[::step, ::step] @ _LUMINANCE
    lit = luminance[(luminance > 0) & np.isfinite(luminance)]
    return float(_MID_GREY / np.median(lit)) if lit.size else 1.0
