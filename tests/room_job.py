"""The closed room's set with a small picture of known colours, for tests of operators and panels."""

import numpy as np

from expanded_panoramas.ibl_toolkit.images import write_exr
from expanded_panoramas.ibl_toolkit.panorama_set import write_set

SIZE = (256, 128)


def picture():
    """(H, W, 3): u in red, v in green, so that a look-up tells where it looked."""
    v, u = np.meshgrid(*((np.arange(n) + 0.5) / n for n in SIZE[::-1]), indexing="ij")
    return np.stack([u, v, np.full_like(u, 0.25)], axis=-1).astype(np.float32)


def write_room(folder, name="room"):
    """Write the picture and the set; returns the set's path."""
    from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

    image = folder / f"{name}.exr"
    write_exr(image, {channel: picture()[..., k] for k, channel in enumerate("RGB")}, {})
    write_set(closed_room_set(image), folder / f"{name}.json")
    return folder / f"{name}.json"


def calibrated(bpy, folder):
    """Import the room's set and calibrate; returns the scene's state."""
    bpy.ops.panorama.import_set(filepath=str(write_room(folder)))
    bpy.ops.panorama.calibrate()
    return bpy.context.scene.panorama_set


def built(bpy, folder):
    """… and build its shapes."""
    state = calibrated(bpy, folder)
    bpy.ops.panorama.build()
    return state


def select(bpy, *names):
    """Select these objects alone, the last one active."""
    for thing in bpy.context.view_layer.objects:
        thing.select_set(thing.name in names)
    bpy.context.view_layer.objects.active = bpy.data.objects[names[-1]] if names else None
