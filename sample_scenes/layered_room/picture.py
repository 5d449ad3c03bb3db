"""The documentation's picture of the sample room: python -m …sample_scenes.layered_room.picture FOLDER."""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np

from ...ibl_toolkit.images import exposure_for
from ...ibl_toolkit.images.png import srgb_from_linear
from ..demo_pictures import write_srgb
from . import capture, materials, scene, views

WIDTH, SAMPLES, QUALITY = 960, 24, 86
GAP = 6
SHOWN = (views.C1, views.TABLE_8_1[1], views.TABLE_8_1[2])


def write_picture(folder: Path):
    """Write sample_room.jpg: the shiny room's two layers as one panorama, and views C1, S2 and S3 below."""
    room = scene.new_room(materials.SHINY)
    back, front = capture.capture_layers(room, WIDTH, SAMPLES).layers
    panorama = np.where(front.mask[..., None], front.radiance, back.radiance)
    # Near the poles there are ceiling and floor alone.
    rows = len(panorama) // 8
    panorama = panorama[rows:-rows]
    across = (WIDTH - GAP * (len(SHOWN) - 1)) // len(SHOWN)
    seen = [capture.render_view(room, view, (across, across * 5 // 8), SAMPLES) for view in SHOWN]
    strip = np.full((len(seen[0]), WIDTH, 3), np.inf)
    for number, picture in enumerate(seen):
        left = number * (across + GAP)
        strip[:, left : left + across] = picture
    gap = np.full((GAP, WIDTH, 3), np.inf)
    whole = np.concatenate([panorama, gap, strip])
    display = srgb_from_linear(whole * exposure_for(panorama) * 1.2)
    write_srgb(folder / "sample_room.jpg", cv2.convertScaleAbs(display, alpha=255), QUALITY)


if __name__ == "__main__":
    write_picture(Path(sys.argv[1]))
