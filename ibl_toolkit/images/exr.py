"""OpenEXR files in and out, through the OpenEXR library, after a look at the header."""

import contextlib
import io

import numpy as np
import OpenEXR

from . import exr_header
from .atomic import replacing
from .channel_names import colour_channels
from .checking import refuse_more_than, refuse_other_shapes, row_blocks
from .errors import ImageError
from .exr_header import window_height, window_width


def read_colour(path, max_bytes):
    """The picture of an OpenEXR panorama, (H, W, 3) float32, of the size of its display window.

    What the data window leaves of the display window is black, what it has beyond is cut off.

    Raises: ImageError for a file that cannot be decoded within `max_bytes`, is not 2:1 or has no colour.
    """
    parts = refuse_unreadable(path, max_bytes)
    index, names = colour_channels(parts, path)
    window = parts[index].display_window
    refuse_other_shapes(window_width(window), window_height(window), path)
    pixels, _ = decode(path, parts, index, names)
    return in_display_window(stacked(pixels, names), parts[index])


def refuse_unreadable(path, max_bytes):
    """The header's parts, if they can be decoded within `max_bytes`; reads no pixels.

    Raises: ImageError if not an OpenEXR file, truncated, deep, or too large.
    """
    parts = exr_header.read_header(path)
    for part in parts:
        if part.deep:
            raise ImageError(f"{path}: a deep image, must be a flat one")
    decoded = sum(part.decoded_bytes for part in parts)
    canvas = max(12 * window_width(p.display_window) * window_height(p.display_window) for p in parts)
    windows = ", ".join(f"{len(p.channels)} channels, data window {p.data_window}" for p in parts)
    refuse_more_than(max_bytes, max(decoded, canvas), windows, path)
    exr_header.refuse_truncated(path)
    return parts


def decode(path, parts, index, names):
    """The channels `names` of part `index`, a dict of (h, w) arrays of the data window; and its attributes.

    Plain R, G and B of one type come as views of one (h, w, 3) array, which saves their copy.
    """
    types = {channel.name: channel.pixel_type for channel in parts[index].channels}
    interleaved = len(parts) == 1 and set(types) <= {"R", "G", "B", "Z"} and _one_type(types)
    with contextlib.redirect_stdout(io.StringIO()) as complaints:  # the library prints what it can't decode
        try:
            file = OpenEXR.File(str(path), separate_channels=not interleaved)
        except (RuntimeError, ValueError) as error:  # ValueError: text that is not UTF-8, unknown types
            raise ImageError(f"{path}: cannot be decoded: {error}") from error
    if len(file.parts) != len(parts):
        raise ImageError(f"{path}: cannot be decoded: {' '.join(complaints.getvalue().split())}")
    channels = file.parts[index].channels
    pixels = {name: channel.pixels for name, channel in channels.items() if name != "RGB"}
    if interleaved:
        rgb = channels["RGB"].pixels
        pixels.update({name: rgb[..., k] for k, name in enumerate("RGB")})
    return {name: pixels[name] for name in names}, file.parts[index].header


def in_display_window(pixels, part):
    """`pixels` (h, w, …) of the data window, put on a black canvas of the display window if they differ."""
    if part.data_window == part.display_window:
        return pixels
    left, top = (part.data_window[k] - part.display_window[k] for k in (0, 1))
    size = window_height(part.display_window), window_width(part.display_window)
    canvas = np.zeros(size + pixels.shape[2:], dtype=pixels.dtype)
    rows, rows_from = _overlap(top, pixels.shape[0], size[0])
    columns, columns_from = _overlap(left, pixels.shape[1], size[1])
    canvas[rows, columns] = pixels[rows_from, columns_from]
    return canvas


def write_exr(path, channels, attributes=None):
    """Write (H, W) arrays of float16, float32 or uint32, by channel name, losslessly and all or nothing.

    attributes: header entries by name; a float array of shape (3, 3) is stored as a matrix, an array of
    one float64 as a double.

    Raises: ValueError for arrays of other types or of different shapes.
    """
    shapes = {name: array.shape for name, array in channels.items()}
    if len(set(shapes.values())) != 1 or len(next(iter(shapes.values()))) != 2:
        raise ValueError(f"channels of shapes {shapes}: they must all be (H, W)")
    for name, array in channels.items():
        if array.dtype not in (np.float16, np.float32, np.uint32):
            raise ValueError(
                f"channel {name} is of type {array.dtype}: it must be float16, float32 or uint32"
            )
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **(attributes or {})}
    pixels = {name: np.ascontiguousarray(array) for name, array in channels.items()}
    with replacing(path) as temporary:
        OpenEXR.File(header, pixels).write(str(temporary))


def _one_type(types):
    return {"R", "G", "B"} <= set(types) and len({types[name] for name in "RGB"}) == 1


def stacked(pixels, names):
    """(h, w, 3) float32 from the three channels `names`, or thrice from one."""
    first = pixels[names[0]]
    if first.base is not None and first.base.shape == (*first.shape, 3):
        return first.base.astype(np.float32, copy=False)
    image = np.empty((*first.shape, 3), dtype=np.float32)
    for rows in row_blocks(len(image)):  # three times as fast as channel by channel: it stays in the cache
        for k in range(3):
            image[rows, :, k] = pixels[names[k % len(names)]][rows]
    return image


def _overlap(offset, length, size):
    """Slices of a canvas of `size` and of what lies on it, for something of `length` put at `offset`."""
    start, end = max(offset, 0), min(offset + length, size)
    if start >= end:
        return slice(0, 0), slice(0, 0)
    return slice(start, end), slice(start - offset, end - offset)
