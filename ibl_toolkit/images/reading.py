"""A captured HDR panorama, from any file that holds one, or the reason why it doesn't."""

from pathlib import Path

import numpy as np

from . import exr, exr_header, radiance_hdr
from .checking import refuse_impossible_radiance
from .errors import ImageError

DEFAULT_MAX_BYTES = 4 * 2**30


def read_panorama(path, *, max_bytes=DEFAULT_MAX_BYTES):
    """An equirectangular HDR image, (H, W, 3) float32, linear, scene-referred; OpenEXR or Radiance .hdr.

    Values below zero by no more than rounding become 0.  Chromaticities in the header are not applied,
    as in Blender: the values are taken as linear Rec. 709.

    max_bytes: limit to the decoded size, judged by the header before anything is decoded.

    Raises: ImageError, naming file and value: not an image of these formats, truncated, without colour
    channels, too large, not 2:1, NaN or infinite radiance, negative radiance beyond rounding.
    FileNotFoundError and other OSErrors for a file that cannot be opened.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     exr.write_exr(f"{folder}/grey.exr", {"Y": np.ones((4, 8), dtype=np.float16)})
    ...     read_panorama(f"{folder}/grey.exr").shape
    (4, 8, 3)
    """
    path = Path(path)
    with open(path, "rb") as file:
        start = file.read(10)
    if start.startswith(exr_header.MAGIC):
        image = exr.read_colour(path, max_bytes)
    elif start.startswith((b"#?RADIANCE", b"#?RGBE")):
        image = radiance_hdr.read_colour(path, max_bytes)
    else:
        raise ImageError(f"{path}: neither OpenEXR nor Radiance .hdr: it starts with {start!r}")
    if refuse_impossible_radiance(image, path) < 0:
        np.maximum(image, 0, out=image)
    return image
