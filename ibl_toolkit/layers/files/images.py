"""One attribute of a layer as an image file: OpenEXR, or PNG for masks and 8-bit colours.

| attribute | channels | storage |
|---|---|---|
| radiance, diffuse light, emission | R G B | half, 32-bit float beyond 65504; or 8-bit PNG, sRGB |
| depth | Z | 32-bit float |
| normals | X Y Z | half |
| reflectivity | Y | half |
| material index | material | 32-bit whole numbers |
| mask | – | 8-bit PNG, white in the domain |
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...images import ImageError, PhotoSphere, exr, exr_header, write_exr, write_png
from ...images.png import linear_from_srgb, read_png
from ..panorama import CHANNELS

COLOURS = ("radiance", "diffuse light", "emission")
_NAMES = {"depth": "Z", "normals": "XYZ", "reflectivity": "Y", "material index": ("material",)}
_HALF_MAX = float(np.finfo(np.float16).max)


def suffix_of(attribute: str, ldr: bool) -> str:
    """The file's suffix, ".exr" or ".png"; ldr: colours are 8-bit."""
    return ".png" if attribute == "mask" or (ldr and attribute in COLOURS) else ".exr"


def write_image(
    path, attribute: str, values: np.ndarray, exposure: float = 1.0, sphere: PhotoSphere | None = None
):
    """Write an array (h, w) or (h, w, 3), all or nothing; PNG colours are multiplied with `exposure`.

    sphere: what a PNG file tells viewers of the panorama that it is.
    """
    if Path(path).suffix == ".png":
        write_png(path, values, exposure=1.0 if attribute == "mask" else exposure, sphere=sphere)
        return
    kind = _type(attribute, values)
    planes = values[..., None] if values.ndim == 2 else values
    names = _NAMES.get(attribute, "RGB")
    write_exr(path, {name: planes[..., k].astype(kind) for k, name in enumerate(names)})


def read_image(path, attribute: str, exposure: float, max_bytes: int) -> np.ndarray:
    """The array (h, w) or (h, w, 3) of an attribute: float32, bool for the mask, uint32 for indices.

    Raises: ImageError for a file that is neither OpenEXR nor (for colours and masks) PNG, that is damaged,
    larger than `max_bytes` decoded, without the channels, or with a depth of less than 32 bits. OSError when
    it cannot be opened.
    """
    with open(path, "rb") as file:
        is_exr = file.read(len(exr_header.MAGIC)) == exr_header.MAGIC
    if is_exr and attribute != "mask":
        return _read_exr(path, attribute, max_bytes)
    if attribute != "mask" and attribute not in COLOURS:
        raise ImageError(f"{path}: {attribute} must be an OpenEXR file")
    if attribute == "mask":
        return read_png(path, grey=True, max_bytes=max_bytes) >= 0.5
    return linear_from_srgb(read_png(path, max_bytes=max_bytes)) / np.float32(exposure)


def _type(attribute, values):
    if attribute == "material index":
        return np.uint32
    if attribute == "depth" or np.abs(values).max() > _HALF_MAX:
        return np.float32
    return np.float16


def _read_exr(path, attribute, max_bytes):
    parts = exr.refuse_unreadable(path, max_bytes)
    part, wanted = parts[0], tuple(_NAMES.get(attribute, "RGB"))
    if part.data_window != part.display_window:
        raise ImageError(
            f"{path}: data window {part.data_window} must be display window {part.display_window}"
        )
    channels = {channel.name: channel for channel in part.channels if channel.sampling == (1, 1)}
    kinds = {
        "depth": (exr_header.FLOAT,),
        "material index": (exr_header.UINT,),
    }.get(attribute, (exr_header.HALF, exr_header.FLOAT))
    if not all(name in channels and channels[name].pixel_type in kinds for name in wanted):
        right = {"depth": " of 32-bit floats", "material index": " of whole numbers"}.get(attribute, "")
        found = ", ".join(channel.name for channel in part.channels)
        raise ImageError(f"{path}: {attribute} needs channels {' '.join(wanted)}{right}, found {found}")
    pixels, _ = exr.decode(path, parts, 0, wanted)
    if attribute == "material index":
        return pixels[wanted[0]]
    if CHANNELS[attribute] == 1:
        return np.ascontiguousarray(pixels[wanted[0]], dtype=np.float32)
    return exr.stacked(pixels, wanted)
