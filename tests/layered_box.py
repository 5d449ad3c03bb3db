"""A layered panorama of a box room whose colours and walls are known in every direction."""

import cv2
import numpy as np
from box_layers import box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

ROTATION = cv2.Rodrigues(np.array([0.2, -0.5, 1.1]))[0]
ORIGIN = np.array([1.0, -2.0, 1.15])
RADIUS = 0.5


def radiance_in(towards):
    """Linear radiance (..., 3) in unit directions (..., 3): no two directions have the same."""
    return (0.5 + 0.4 * np.asarray(towards)).astype(np.float32)


def object_mask(mapping, width):
    """Pixels round the +z pole and round -x, where the seam of an equirectangular map is."""
    towards = directions(mapping, width)
    return (towards[..., 2] > 0.9) | (towards[..., 0] < -0.95)


def window_mask(mapping, width):
    return directions(mapping, width)[..., 1] > 0.9


def layered_box(mapping="equirectangular", width=64, names=("room", "objects")):
    """The room, with a window to what is at infinity; before it objects at half the walls' depth."""
    colour, depth = radiance_in(directions(mapping, width)), box_depth(mapping, width)
    open_room = np.where(window_mask(mapping, width), np.float32(np.inf), depth)
    near = np.where(object_mask(mapping, width), depth / 2, np.float32(np.nan))
    layers = {
        "room": Layer("room", mapping, {"radiance": colour, "depth": open_room}),
        "walls": Layer("walls", mapping, {"radiance": colour, "depth": depth}),
        "objects": Layer("objects", mapping, {"radiance": colour.copy(), "depth": near}),
    }
    return LayeredPanorama(tuple(layers[name] for name in names), ROTATION, ORIGIN, RADIUS)
