"""HDR panoramas, RGB-D panoramas and previews: in from files and out to files."""

from .atomic import replacing
from .errors import ImageError
from .exr import write_exr
from .jpeg import write_jpeg
from .photo_sphere import PhotoSphere
from .png import exposure_for, write_png
from .reading import DEFAULT_MAX_BYTES, read_panorama
from .rgbd import RGBD, is_rgbd, read_rgbd, write_rgbd
from .size import panorama_size
from .xmp import read_photo_sphere

__all__ = [
    "DEFAULT_MAX_BYTES",
    "RGBD",
    "ImageError",
    "PhotoSphere",
    "exposure_for",
    "is_rgbd",
    "panorama_size",
    "read_panorama",
    "read_photo_sphere",
    "read_rgbd",
    "replacing",
    "write_exr",
    "write_jpeg",
    "write_png",
    "write_rgbd",
]
