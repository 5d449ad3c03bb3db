"""Pictures that explain: the reconstruction drawn over the panorama, and the depth in colours."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from ..ibl_toolkit import overlay
from ..ibl_toolkit.false_colour import depth_colours
from ..ibl_toolkit.images import exposure_for, replacing
from ..ibl_toolkit.images.png import srgb_from_linear
from ..ibl_toolkit.light.lamps import split_into_lamps

LINES_WIDTH = 2048
"""Lines are drawn on a picture of this width [px], whatever the photograph's."""
DIMMED = 0.45
"""The photograph steps back behind the lines."""
NEAREST, FARTHEST = 0.8, 3.5
"""Range of the depth's colours [m]: a hotel room as its own camera sees it."""


def write_reconstruction(path, photograph, pieces, calibration, depth):
    """The rebuilt pieces' visible edges and the axes' planes over the dimmed photograph."""
    picture = _dimmed(photograph)
    overlay.draw_axis_planes(picture, calibration.world_from_panorama)
    overlay.draw_pieces(picture, pieces, calibration.world_from_panorama, calibration.camera_height, depth)
    write_srgb(path, picture)


def write_lamps(path, photograph, depth):
    """The outlines of the photograph's lamps, as the preparation makes them lights at their depth."""
    picture = _dimmed(photograph)
    at_depth = np.where(depth.is_support, np.inf, depth.depth)
    overlay.draw_lamps(picture, split_into_lamps(np.maximum(photograph, 0), at_depth).lamps)
    write_srgb(path, picture)


def write_depth(path, depth):
    """The depth map in colours from NEAREST to FARTHEST."""
    write_srgb(path, depth_colours(depth, NEAREST, FARTHEST))


def _dimmed(photograph):
    """The photograph as (H, W, 3) sRGB, darker and as wide as LINES_WIDTH."""
    display = srgb_from_linear(photograph * exposure_for(photograph) * DIMMED)
    picture = np.round(display * 255).astype(np.uint8)
    return cv2.resize(picture, (LINES_WIDTH, LINES_WIDTH // 2), interpolation=cv2.INTER_CUBIC)


def write_srgb(path, picture, quality=None):
    """Write sRGB values (H, W, 3) uint8 as PNG, or as JPEG of a quality in percent."""
    options = [] if quality is None else [cv2.IMWRITE_JPEG_QUALITY, quality]
    _, file = cv2.imencode(Path(path).suffix, cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), options)
    with replacing(Path(path)) as temporary:
        file.tofile(temporary)


def read_srgb(path):
    """An 8-bit picture as (H, W, 3) uint8."""
    return cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
