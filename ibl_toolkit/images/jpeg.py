"""8-bit JPEG files of HDR images."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from .atomic import replacing
from .photo_sphere import PhotoSphere
from .png import refuse_nan, srgb_codes
from .xmp import with_photo_sphere

QUALITY = 95
MOST_PX = 65500
"""Of a side, in the encoder that is used."""


def write_jpeg(path, image: np.ndarray, *, exposure=1.0, sphere: PhotoSphere | None = None):
    """Write linear `image` (H, W, 3), times `exposure`, with the sRGB transfer, all or nothing.

    What is below 0 becomes black, what is above 1 white. sphere: what is told of the panorama (see
    `photo_sphere`).

    Raises: ValueError for NaN, and for a side beyond MOST_PX.
    """
    image = np.asarray(image, dtype=np.float32)
    refuse_nan(image, path)
    if max(image.shape[:2]) > MOST_PX:
        raise ValueError(
            f"{path}: {image.shape[1]} x {image.shape[0]} px, a JPEG's sides end at {MOST_PX} px"
        )
    codes = cv2.cvtColor(srgb_codes(image, exposure), cv2.COLOR_RGB2BGR)
    data = cv2.imencode(".jpg", codes, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1].tobytes()
    with replacing(Path(path)) as temporary:
        temporary.write_bytes(data if sphere is None else with_photo_sphere(data, sphere))
