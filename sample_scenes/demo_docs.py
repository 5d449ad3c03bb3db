"""The pictures of the README and the manual, made from a run of the demo."""

from __future__ import annotations

import cv2
import numpy as np

from .demo_pictures import read_srgb, write_srgb

GAP = 8
QUALITY = 88


def write_pictures(demo, folder):
    """Write hotel_room.jpg (before and after), and panorama, reconstruction, depth and lamps as JPEG."""
    folder.mkdir(parents=True, exist_ok=True)
    before, after = (read_srgb(demo / name) for name in ("frame_before.png", "frame.png"))
    gap = np.full((before.shape[0], GAP, 3), 255, np.uint8)
    _write(folder / "hotel_room.jpg", np.hstack([before, gap, after]), 1928)
    _write(folder / "hotel_room_panorama.jpg", read_srgb(demo / "panorama.png"), 1024)
    _write(folder / "hotel_room_reconstruction.jpg", read_srgb(demo / "reconstruction.png"), 1400)
    _write(folder / "hotel_room_depth.jpg", read_srgb(demo / "depth.png"), 1024)
    _write(folder / "hotel_room_lamps.jpg", read_srgb(demo / "lamps.png"), 1024)


def _write(path, picture, width):
    height = round(width * picture.shape[0] / picture.shape[1])
    if width < picture.shape[1]:
        picture = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    write_srgb(path, picture, QUALITY)
