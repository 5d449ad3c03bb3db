"""Small OpenEXR files for the tests: every storage that the readers must take, and damaged ones."""

import struct

import numpy as np
import OpenEXR


def picture(height=8, seed=0, dtype=np.float32):
    """Random radiance (H, 2H, 3) that half floats hold exactly."""
    rng = np.random.default_rng(seed)
    return rng.random((height, 2 * height, 3)).astype(np.float16).astype(dtype)


def channels(image, names="RGB"):
    return {name: np.ascontiguousarray(image[..., k % 3]) for k, name in enumerate(names)}


def write(path, pixels, *, tiles=None, compression=OpenEXR.ZIP_COMPRESSION, **attributes):
    OpenEXR.File({**header(tiles, compression), **attributes}, pixels).write(str(path))
    return path


def write_parts(path, named_parts, tiles=None):
    parts = [
        OpenEXR.Part(header(tiles, OpenEXR.ZIP_COMPRESSION), pixels, name)
        for name, pixels in named_parts.items()
    ]
    OpenEXR.File(parts).write(str(path))
    return path


def header(tiles, compression):
    if tiles is None:
        return {"type": OpenEXR.scanlineimage, "compression": compression}
    description = OpenEXR.TileDescription()
    description.xSize, description.ySize = tiles
    return {"type": OpenEXR.tiledimage, "compression": compression, "tiles": description}


def window(left, top, right, bottom):
    return np.array([left, top], dtype=np.int32), np.array([right, bottom], dtype=np.int32)


def patch_window(path, name, values):
    """Overwrite a box2i attribute of a written file."""
    data = bytearray(path.read_bytes())
    at = data.index(name.encode() + b"\0box2i\0") + len(name) + 7 + 4
    data[at : at + 16] = struct.pack("<4i", *values)
    path.write_bytes(data)
