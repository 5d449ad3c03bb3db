"""The light map that a verb works on: of a panorama set, an image, or an RGB-D panorama."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ..ibl_toolkit.images import read_panorama, read_rgbd
from ..ibl_toolkit.images.exr_header import MAGIC, read_header
from ..ibl_toolkit.images.rgbd import WORLD_FROM_PANORAMA
from . import blender
from .job import open_job, place_in, rebuild

DEPTH_WIDTH = 2048
"""Wider maps get their depth at this width [px]: it says where a light is, not which pixel shows it."""


@dataclass(frozen=True)
class LightMap:
    """image (H, W, 3) radiance; depth (H, W) along the ray [m] or None; the picture's path; up in it."""

    image: np.ndarray
    depth: np.ndarray | None
    path: Path
    up: tuple[float, ...] = (0.0, 0.0, 1.0)


def picture_of(path):
    """The picture that a set names, or `path` itself; reads no pixels.

    Raises: ValueError for a set that is not valid; OSError.
    """
    path = Path(path)
    return open_job(path).set.image if path.suffix.lower() == ".json" else path


def read_light_map(path, progress):
    """Read the light map of a set (.json), an RGB-D panorama, or any other panorama -> LightMap.

    A set with shapes is rebuilt for its depth, which needs Blender.

    Raises: ValueError naming file and value; OSError.
    """
    path = Path(path)
    if path.suffix.lower() != ".json":
        with progress.step("reading"):
            if not _is_rgbd(path):
                return LightMap(read_panorama(path), None, path)
            rgbd = read_rgbd(path)
            return LightMap(rgbd.image, rgbd.depth, path, _up(rgbd.world_from_panorama))
    job = open_job(path)
    pieces = rebuild(job)
    with progress.step("reading"):
        image = read_panorama(job.set.image)
    depth = _depth(job, pieces, image.shape[1], progress) if pieces else None
    return LightMap(image, depth, job.set.image, _up(job.calibration.world_from_panorama))


def _up(world_from_panorama):
    return tuple(float(number) for number in world_from_panorama[2])


def _is_rgbd(path):
    with open(path, "rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            return False
    return any(WORLD_FROM_PANORAMA in part.attributes for part in read_header(path))


def _depth(job, pieces, width, progress):
    with blender.empty_scene(progress) as scene:
        from ..cycles_integration import maps, place

        made = place_in(scene, job, pieces)
        place.sort_objects(scene, made)
        with progress.step("depth"):
            depth = maps.render_depth(scene, made, min(width, DEPTH_WIDTH)).depth
    # The nearest pixel's: a mean across an edge would lie in the air between.
    return cv2.resize(depth, (width, width // 2), interpolation=cv2.INTER_NEAREST)
