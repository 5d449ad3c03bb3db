"""8-bit PNG files of HDR images."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np

from .atomic import replacing
from .checking import refuse_more_than
from .errors import ImageError
from .photo_sphere import PhotoSphere
from .xmp import with_photo_sphere

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)  # Rec. 709
_MID_GREY = 0.18
_START = b"\x89PNG\r\n\x1a\n"
_ABOUT = 512  # rows that a median needs to be good enough


def write_png(path, image, *, exposure=1.0, sphere: PhotoSphere | None = None):
    """Write linear `image` (H, W, 3) or (H, W), times `exposure`, with the sRGB transfer, all or nothing.

    What is below 0 becomes black, what is above 1 white. sphere: what is told of the panorama that the image
    is (see `photo_sphere`).

    Raises: ValueError for NaN, which no grey stands for.
    """
    image = np.asarray(image, dtype=np.float32)
    refuse_nan(image, path)
    codes = srgb_codes(image, exposure)
    if codes.ndim == 3:
        codes = cv2.cvtColor(codes, cv2.COLOR_RGB2BGR)
    data = cv2.imencode(".png", codes)[1].tobytes()
    with replacing(Path(path)) as temporary:
        temporary.write_bytes(data if sphere is None else with_photo_sphere(data, sphere))


def refuse_nan(image, path):
    """Raise ValueError for NaN in an image that is to be written to `path`."""
    unknown = np.count_nonzero(np.isnan(image))
    if unknown:
        raise ValueError(f"{path}: {unknown} values of the image are NaN, they must be numbers")


def srgb_codes(image, exposure):
    """8-bit sRGB values, uint8, of linear ones times `exposure`.

    >>> srgb_codes(np.array([0.0, 0.09, 2.0]), 2.0).tolist()
    [0, 118, 255]
    """
    return np.round(srgb_from_linear(image * np.float32(exposure)) * 255).astype(np.uint8)


def read_png(path, *, grey=False, max_bytes):
    """The values of a PNG file as they are encoded, from 0 to 1: (H, W, 3) float32, or `grey` (H, W).

    Transparency is left out, and so are colour profiles.

    Raises: ImageError for what is no whole PNG file, or is larger than `max_bytes` as float32; OSError when
    it cannot be opened.
    """
    file = Path(path).read_bytes()
    if file[:8] != _START or len(file) < 24:
        raise ImageError(f"{path}: not a PNG file: it starts with {file[:8]!r}")
    width, height = struct.unpack(">2I", file[16:24])
    refuse_more_than(max_bytes, 12 * width * height, f"{width} x {height} px", path)
    _refuse_damaged_chunks(file, path)
    mode = cv2.IMREAD_GRAYSCALE if grey else cv2.IMREAD_COLOR
    try:
        encoded = cv2.imdecode(np.frombuffer(file, np.uint8), mode | cv2.IMREAD_ANYDEPTH)
    except cv2.error as error:  # a size beyond OpenCV's own limit
        raise ImageError(f"{path}: cannot be decoded: {error.err}") from error
    if encoded is None:
        raise ImageError(f"{path}: cannot be decoded: its PNG data are damaged")
    if not grey:
        encoded = cv2.cvtColor(encoded, cv2.COLOR_BGR2RGB)
    return encoded / np.float32(np.iinfo(encoded.dtype).max)


def srgb_from_linear(linear):
    """sRGB values in [0, 1] of linear ones, which are clipped to [0, 1].

    Source: IEC 61966-2-1.

    >>> srgb_from_linear(np.array([-1.0, 0.0, 0.0031308, 0.18, 1.0, np.inf])).round(4)
    array([0.    , 0.    , 0.0404, 0.4614, 1.    , 1.    ])
    """
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _refuse_damaged_chunks(file, path):
    """The decoder makes up what a truncated file lacks, and takes the memory that a chunk's length asks for.

    Source: ISO/IEC 15948, section 5.3: a length, a name, the data, and a check of name and data.
    """
    at, name = len(_START), b""
    while name != b"IEND":
        if at + 12 > len(file):
            raise ImageError(f"{path}: truncated: {len(file)} bytes, without an end")
        length, name = struct.unpack(">I4s", file[at : at + 8])
        end = at + 12 + length
        if end > len(file):
            raise ImageError(f"{path}: truncated or damaged: {len(file)} bytes, must be {end} or more")
        if zlib.crc32(file[at + 4 : end - 4]) != struct.unpack(">I", file[end - 4 : end])[0]:
            raise ImageError(f"{path}: damaged: the check of its chunk at byte {at} fails")
        at = end


def linear_from_srgb(encoded):
    """Linear values in [0, 1] of sRGB ones.

    >>> linear_from_srgb(srgb_from_linear(np.array([0.0, 0.002, 0.18, 1.0]))).round(12)
    array([0.   , 0.002, 0.18 , 1.   ])
    """
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


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
