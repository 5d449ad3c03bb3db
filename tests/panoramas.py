"""Tiny panoramas and places with a known answer."""

import numpy as np

from expanded_panoramas.ibl_toolkit.images import write_exr
from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set


def constant_panorama(path, radiance, width=32):
    """A panorama of one radiance everywhere."""
    return write_panorama(path, np.full((width // 2, width, 3), radiance, np.float32))


def smooth_panorama(path, width=64):
    """A panorama that varies slowly, with no two pixels alike."""
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(width // 2) + 0.5) / (width // 2))
    waves = [0.5 + 0.3 * np.cos(2 * np.pi * (u - shift)) * np.sin(np.pi * v) for shift in (0.1, 0.4, 0.7)]
    return write_panorama(path, np.stack(waves, axis=2))


def write_panorama(path, image):
    """Write (H, W, 3) as an EXR; returns the path."""
    write_exr(path, {name: image[..., k].astype(np.float32) for k, name in enumerate("RGB")})
    return path


def room_place(bpy, image, **changes):
    """A scene whose place is the closed room, rebuilt from picks as exact as those on a large image."""
    from expanded_panoramas.cycles_integration import place
    from expanded_panoramas.cycles_integration.pieces import update_pieces
    from expanded_panoramas.ibl_toolkit.calibration import calibrate
    from expanded_panoramas.ibl_toolkit.reconstruction import reconstruct

    panorama_set = closed_room_set(image, **changes)
    calibration = calibrate(panorama_set.calibration, (4096, 2048))
    scene = bpy.context.scene
    here = place.create_place(scene, str(image), calibration)
    update_pieces(here, reconstruct(panorama_set, calibration))
    return scene, here
