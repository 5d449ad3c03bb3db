"""Radiance .hdr files in, through OpenCV, after a look at the header."""

import re

import cv2
import numpy as np

from .checking import refuse_more_than, refuse_other_shapes, row_blocks
from .errors import ImageError
from .quiet_opencv import quiet_opencv

_HEADER_BYTES = 1 << 16
_FORMAT = b"32-bit_rle_rgbe"
_SIZE = re.compile(rb"-Y +(\d{1,9}) +\+X +(\d{1,9}) *")


def read_size(path):
    """Width and height [px] by the header.

    Raises: ImageError if the file ends within it, or is turned or coded in a way that is not read.
    """
    with open(path, "rb") as file:
        head, separator, rest = file.read(_HEADER_BYTES).partition(b"\n\n")
    if not separator:
        raise ImageError(f"{path}: truncated within its header")
    formats = re.findall(rb"(?m)^FORMAT=(\S*)", head)
    if formats != [_FORMAT]:
        raise ImageError(
            f"{path}: FORMAT is {[f.decode('latin-1') for f in formats]}, must be {_FORMAT.decode()}"
        )
    line = rest.split(b"\n", 1)[0]
    size = _SIZE.fullmatch(line)
    if not size:
        raise ImageError(f"{path}: size line {line[:60]!r}, must be of the form '-Y height +X width'")
    height, width = (int(number) for number in size.groups())
    return width, height


def read_colour(path, max_bytes):
    """(H, W, 3) float32.  The file's EXPOSURE, if any, is not divided out, as in Blender.

    Raises: ImageError for a file that cannot be decoded within `max_bytes`, or is not 2:1.
    """
    width, height = read_size(path)
    refuse_more_than(max_bytes, 12 * width * height, f"{width} x {height} px", path)
    refuse_other_shapes(width, height, path)
    # Not cv2.imread: on Windows it cannot open names beyond the code page.
    with quiet_opencv():
        image = cv2.imdecode(np.fromfile(path, dtype=np.uint8), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR)
    if image is None:
        raise ImageError(f"{path}: truncated or damaged: its scanlines cannot be decoded")
    for rows in row_blocks(height):  # in one go, OpenCV would make a copy
        image[rows] = image[rows, :, ::-1].copy()
    return image
