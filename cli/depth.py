"""`panorama depth SET -o MAP.exr`: the panorama with the depth of its rebuilt place (RGB-D)."""

import cv2
import numpy as np

from ..ibl_toolkit import equirectangular
from ..ibl_toolkit.images import RGBD, read_panorama, write_rgbd
from . import blender
from .job import open_job, place_in, rebuild, refuse_output
from .options import whole_number
from .progress import Progress

INPUT = "panorama set (.json)"
SUMMARY = "write the RGB-D panorama: image and ray distance of the rebuilt place"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "MAP.exr", "_depth.exr", True


def add_options(parser):
    """Add the verb's own options."""
    parser.add_argument(
        "--width", type=whole_number(8), metavar="W", help="width [px] (default: the image's)"
    )


def run(set_path, output, options, progress):
    """Do the verb -> what `--json` prints."""
    return write_depth(set_path, output, options.width, progress)


def write_depth(set_path, output, width=None, progress=None):
    """Write the RGB-D EXR of a set -> size [width, height], coverage in 0 to 1, nearest and farthest [m].

    nearest and farthest are None where the place covers nothing that the map's pixels hit.
    """
    progress = progress or Progress()
    job = open_job(set_path)
    width = width or job.image_size[0]
    if width < 8 or width % 2:
        raise ValueError(f"--width {width}: must be even and at least 8, for the height is half of it")
    refuse_output(output, ".exr", (job.set.image,))
    depth = _render(job, width, progress)
    with progress.step("image"):
        image = resized(read_panorama(job.set.image), width)
    with progress.step("writing"):
        calibration = job.calibration
        write_rgbd(
            output, RGBD(image, depth.depth, calibration.world_from_panorama, calibration.camera_height)
        )
    hit = depth.depth[np.isfinite(depth.depth)]
    return {
        "size": [width, width // 2],
        "coverage": depth.coverage,
        "nearest": float(hit.min()) if hit.size else None,
        "farthest": float(hit.max()) if hit.size else None,
    }


def _render(job, width, progress):
    pieces = rebuild(job)
    with blender.empty_scene(progress) as scene:
        from ..cycles_integration import maps, place

        made = place_in(scene, job, pieces)
        place.sort_objects(scene, made)
        with progress.step("depth"):
            return maps.render_depth(scene, made, width)


def resized(image, width):
    """(H, W, 3) -> (width/2, width, 3): averaged where that is smaller, interpolated where it is larger."""
    if width == image.shape[1]:
        return image
    if width < image.shape[1]:
        return cv2.resize(image, (width, width // 2), interpolation=cv2.INTER_AREA)
    return equirectangular.sample(image, equirectangular.pixel_directions(width, width // 2)).astype(
        np.float32
    )


def describe(result):
    """One line."""
    width, height = result["size"]
    lengths = "nothing hit"
    if result["nearest"] is not None:
        lengths = f"from {result['nearest']:.3f} m to {result['farthest']:.3f} m"
    return [f"{width} × {height} px, coverage {result['coverage']:.1%}, {lengths}".replace("%", " %")]
