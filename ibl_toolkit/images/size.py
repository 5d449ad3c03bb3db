"""The size of a panorama, from its file's header alone."""

from pathlib import Path

from . import exr_header, radiance_hdr
from .channel_names import colour_channels
from .checking import refuse_other_shapes
from .errors import ImageError


def panorama_size(path):
    """Width and height [px] of the equirectangular image that `read_panorama` would return; reads no pixels.

    Raises: ImageError, naming file and value, for what the header shows to be no panorama; OSError for a
    file that cannot be opened.

    >>> import tempfile
    >>> import numpy as np
    >>> from .exr import write_exr
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_exr(f"{folder}/grey.exr", {"Y": np.ones((4, 8), dtype=np.float16)})
    ...     panorama_size(f"{folder}/grey.exr")
    (8, 4)
    """
    path = Path(path)
    with open(path, "rb") as file:
        start = file.read(10)
    if start.startswith(exr_header.MAGIC):
        parts = exr_header.read_header(path)
        window = parts[colour_channels(parts, path)[0]].display_window
        size = exr_header.window_width(window), exr_header.window_height(window)
    elif start.startswith((b"#?RADIANCE", b"#?RGBE")):
        size = radiance_hdr.read_size(path)
    else:
        raise ImageError(f"{path}: neither OpenEXR nor Radiance .hdr: it starts with {start!r}")
    refuse_other_shapes(*size, path)
    return size
