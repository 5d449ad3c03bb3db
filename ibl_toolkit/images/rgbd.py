"""RGB-D panoramas: an equirectangular image with the depth of every pixel, and where it was captured."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import exr, exr_header
from .channel_names import channel_named, colour_channels
from .checking import refuse_impossible_radiance, refuse_other_shapes
from .errors import ImageError
from .reading import DEFAULT_MAX_BYTES

WORLD_FROM_PANORAMA = "panorama.worldFromPanorama"
CAMERA_HEIGHT = "panorama.cameraHeight"
_HALF_MAX = float(np.finfo(np.float16).max)
_ORTHONORMAL = 1e-5  # a matrix of single floats is no better


@dataclass(frozen=True)
class RGBD:
    """A panorama with depth.

    image: (H, W, 3) float32 radiance; depth: (H, W) float32, along the ray [m], +inf where there is none;
    world_from_panorama: (3, 3) rotation; camera_height [m] above the floor.
    """

    image: np.ndarray
    depth: np.ndarray
    world_from_panorama: np.ndarray
    camera_height: float


def read_rgbd(path, *, max_bytes=DEFAULT_MAX_BYTES, frame_needed=True):
    """The RGB-D panorama in an OpenEXR file as `write_rgbd` makes it: R G B, 32-bit Z, two attributes.

    frame_needed: whether both attributes must be there; if not, and neither is, the panorama is taken as
    level, with its origin at (0, 0, 0).

    Raises: ImageError as `read_panorama` does; without depth, of less than 32 bits, or a depth that is
    NaN or not above 0; without the attributes, or with ones that are no rotation and no height.
    """
    path = Path(path)
    parts = exr.refuse_unreadable(path, max_bytes)
    index, names = colour_channels(parts, path)
    part = parts[index]
    z = channel_named(part, "Z")
    if z is None or z.pixel_type != exr_header.FLOAT or z.sampling != (1, 1):
        found = ", ".join(channel.name for channel in part.channels)
        raise ImageError(f"{path}: a 32-bit float channel Z is needed for the depth, found {found}")
    if part.data_window != part.display_window:
        raise ImageError(
            f"{path}: data window {part.data_window} must be display window {part.display_window}"
        )
    width, height = (f(part.data_window) for f in (exr_header.window_width, exr_header.window_height))
    refuse_other_shapes(width, height, path)
    pixels, attributes = exr.decode(path, parts, index, (*names, z.name))
    depth = np.ascontiguousarray(pixels.pop(z.name))
    matrix, camera_height = np.eye(3), 0.0
    has_frame = frame_needed or not {WORLD_FROM_PANORAMA, CAMERA_HEIGHT}.isdisjoint(attributes)
    if has_frame:
        matrix = _numbers(attributes, WORLD_FROM_PANORAMA, 9, path).reshape(3, 3)
        camera_height = float(_numbers(attributes, CAMERA_HEIGHT, 1, path)[0])
    rgbd = RGBD(exr.stacked(pixels, names), depth, matrix, camera_height)
    if refuse_impossible_radiance(rgbd.image, path) < 0:
        np.maximum(rgbd.image, 0, out=rgbd.image)
    _refuse_impossible(rgbd, path, has_frame)
    return rgbd


def is_rgbd(path):
    """Whether a file's header tells of an RGB-D panorama: channel Z and both attributes; reads no pixels.

    Raises: ImageError for a damaged OpenEXR header; OSError for a file that cannot be opened.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     exr.write_exr(f"{folder}/grey.exr", {"Y": np.ones((4, 8), dtype=np.float16)})
    ...     is_rgbd(f"{folder}/grey.exr")
    False
    """
    with open(path, "rb") as file:
        if file.read(len(exr_header.MAGIC)) != exr_header.MAGIC:
            return False
    needed = {WORLD_FROM_PANORAMA, CAMERA_HEIGHT}
    parts = exr_header.read_header(path)
    return any(channel_named(part, "Z") and needed <= part.attributes.keys() for part in parts)


def write_rgbd(path, rgbd, half=None):
    """Write an RGB-D panorama, all or nothing: R G B in half or float, Z in 32-bit float.

    half: store the colour as half floats (True), as 32-bit floats (False), or (None) as half floats if
    its largest radiance lets it, 65504, and as 32-bit floats otherwise.

    Raises: ImageError for what `read_rgbd` would refuse, and if `half` is asked of larger radiance.
    """
    path = Path(path)
    height, width = rgbd.depth.shape
    if rgbd.image.shape != (height, width, 3):
        raise ImageError(f"{path}: image {rgbd.image.shape} and depth {rgbd.depth.shape} must be of one size")
    refuse_other_shapes(width, height, path)
    refuse_impossible_radiance(rgbd.image, path)
    _refuse_impossible(rgbd, path)
    largest = float(rgbd.image.max())
    if half and largest > _HALF_MAX:
        raise ImageError(f"{path}: radiance up to {largest:.6g} does not fit half floats, which end at 65504")
    colour_type = np.float16 if half or (half is None and largest <= _HALF_MAX) else np.float32
    channels = {name: np.maximum(rgbd.image[..., k], 0).astype(colour_type) for k, name in enumerate("RGB")}
    channels["Z"] = rgbd.depth.astype(np.float32)
    attributes = {
        WORLD_FROM_PANORAMA: np.array(rgbd.world_from_panorama, dtype=np.float64),
        CAMERA_HEIGHT: np.array([rgbd.camera_height], dtype=np.float64),
    }
    exr.write_exr(path, channels, attributes)


def _numbers(attributes, name, count, path):
    if name not in attributes:
        raise ImageError(f"{path}: attribute {name} is missing, so its frame is not known")
    try:
        numbers = np.asarray(attributes[name], dtype=np.float64).ravel()
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if len(numbers) != count:
        raise ImageError(f"{path}: attribute {name} is {attributes[name]!r}, must be {count} floats")
    return numbers


def _refuse_impossible(rgbd, path, has_frame=True):
    bad = ~(rgbd.depth > 0)  # NaN included
    if bad.any():
        row, column = (int(k) for k in np.argwhere(bad)[0])
        raise ImageError(
            f"{path}: {np.count_nonzero(bad)} depths are NaN or not above 0, the first at ({column}, {row}): "
            f"{rgbd.depth[row, column]}; +inf means none"
        )
    matrix = np.asarray(rgbd.world_from_panorama, dtype=np.float64)
    is_rotation = matrix.shape == (3, 3) and np.allclose(matrix @ matrix.T, np.eye(3), atol=_ORTHONORMAL)
    if not is_rotation or np.linalg.det(matrix) < 0:
        raise ImageError(f"{path}: world_from_panorama {matrix.tolist()} must be a (3, 3) rotation")
    if has_frame and not (np.isfinite(rgbd.camera_height) and rgbd.camera_height > 0):
        raise ImageError(f"{path}: camera_height {rgbd.camera_height} m must be finite and above 0")
