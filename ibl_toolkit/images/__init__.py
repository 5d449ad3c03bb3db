"""HDR panoramas, RGB-D panoramas and previews: in from files and out to files."""

from .atomic import replacing
from .errors import ImageError
from .exr import write_exr
from .png import exposure_for, write_png
from .reading import DEFAULT_MAX_BYTES, read_panorama
from .rgbd import RGBD, is_rgbd, read_rgbd, write_rgbd
from .size import panorama_size

__all__ = [
    "DEFAULT_MAX_BYTES",
    "RGBD",
    "ImageError",
    "exposure_for",
    "is_rgbd",
    "panorama_size",
    "read_panorama",
    "read_rgbd",
    "replacing",
    "write_exr",
    "write_png",
    "write_rgbd",
]
