"""A photograph of a probe, from any picture file: linear radiance, and which of its pixels are clipped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ...images import exr, exr_header
from ...images.channel_names import colour_channels
from ...images.checking import refuse_impossible_radiance, refuse_more_than
from ...images.errors import ImageError
from ...images.png import linear_from_srgb, srgb_codes
from ...images.quiet_opencv import quiet_opencv
from ...images.radiance_hdr import read_size
from ...light.light_map import LUMINANCE

MAX_BYTES = 2**31
CLIPPED_CODE = 253 / 255
"""Encoded values from here on count as clipped: a JPEG leaves 253 and 254 on a plateau of 255."""
PLATEAU = 1e-3
"""HDR values within this part of the highest one count as equal to it."""
PLATEAU_PIXELS = 4
"""So many pixels at the highest value of an HDR photograph are not chance."""
_MID_GREY = 0.18


@dataclass(frozen=True, eq=False)
class Photo:
    """image: (H, W, 3) float32, linear. clipped: (H, W) bool, where a channel has the highest value there is.

    is_hdr: whether the file holds radiance; then `clipped` is a suspicion, as a lamp of one radiance looks
    so.
    """

    image: np.ndarray
    clipped: np.ndarray
    is_hdr: bool

    @classmethod
    def from_codes(cls, encoded) -> Photo:
        """Of sRGB values (H, W, 3) from 0 to 1."""
        encoded = np.asarray(encoded, dtype=np.float32)
        return cls(linear_from_srgb(encoded).astype(np.float32), (encoded >= CLIPPED_CODE).any(axis=2), False)

    @classmethod
    def from_radiance(cls, image) -> Photo:
        """Of linear values (H, W, 3) of any range.

        Raises: ImageError for NaN, infinite and negative values.
        """
        image = np.array(image, dtype=np.float32)
        if refuse_impossible_radiance(image, "photograph") < 0:
            np.maximum(image, 0, out=image)
        plateau = image.max(axis=2) >= (1 - PLATEAU) * image.max()
        if image.max() <= 0 or np.count_nonzero(plateau) < PLATEAU_PIXELS:
            plateau = np.zeros_like(plateau)
        return cls(image, plateau, True)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return self.image.shape[1], self.image.shape[0]

    @property
    def luminance(self) -> np.ndarray:
        """(H, W) float32."""
        return self.image @ LUMINANCE.astype(np.float32)

    @property
    def white_at_one(self) -> np.ndarray:
        """(H, W) float32 linear luminance; of an HDR photograph the median of the lit pixels is mid grey.

        No brighter than 1, so that a lamp is no edge a thousand times as steep as the others.
        """
        luminance = self.luminance
        lit = luminance[luminance > 0]
        exposure = _MID_GREY / np.median(lit) if self.is_hdr and lit.size else 1.0
        return np.minimum(luminance * np.float32(exposure), np.float32(1))

    @property
    def grey(self) -> np.ndarray:
        """(H, W) uint8 sRGB, to look for edges and markers in."""
        return srgb_codes(self.white_at_one, 1.0)


def read_photo(path) -> Photo:
    """A photograph or video frame: OpenEXR and Radiance .hdr (linear), or what OpenCV reads (as sRGB).

    A JPEG is turned as its EXIF says; 16-bit PNG and TIFF count as sRGB too. Transparency is left out.

    Raises: ImageError, naming the file, for what is no picture, is damaged, holds NaN or infinite radiance,
    or needs more than MAX_BYTES; OSError when it cannot be opened.
    """
    path = Path(path)
    data = path.read_bytes()
    if data.startswith(exr_header.MAGIC):
        return _of_radiance(_read_exr(path), path)
    if data.startswith((b"#?RADIANCE", b"#?RGBE")):
        width, height = read_size(path)
        refuse_more_than(MAX_BYTES, 12 * width * height, f"{width} x {height} px", path)
        return _of_radiance(_decoded(data, path).astype(np.float32), path)
    decoded = _decoded(data, path)
    if decoded.dtype == np.float32:  # a TIFF of floats
        return _of_radiance(decoded, path)
    if decoded.dtype not in (np.uint8, np.uint16):
        raise ImageError(f"{path}: pixels of type {decoded.dtype}, must be of 8 or 16 bits, or floats")
    return Photo.from_codes(decoded / np.float32(np.iinfo(decoded.dtype).max))


def _of_radiance(image, path):
    try:
        return Photo.from_radiance(image)
    except ImageError as error:
        raise ImageError(f"{path}: {error}") from error


def _read_exr(path):
    parts = exr.refuse_unreadable(path, MAX_BYTES)
    index, names = colour_channels(parts, path)
    pixels, _ = exr.decode(path, parts, index, names)
    return exr.in_display_window(exr.stacked(pixels, names), parts[index])


def _decoded(data, path):
    try:
        with quiet_opencv():
            image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR)
    except cv2.error as error:  # a size beyond OpenCV's own limit
        raise ImageError(f"{path}: cannot be decoded: {error.err}") from error
    if image is None:
        raise ImageError(f"{path}: not a picture that can be read: it starts with {data[:10]!r}")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
