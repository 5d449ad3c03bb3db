"""Preview pictures of assets, computed: no render is needed to tell a mirror from a matte ball."""

from __future__ import annotations

import numpy as np

from ..ibl_toolkit.images import exposure_for
from ..ibl_toolkit.images.png import srgb_from_linear

SIZE = 128
LIGHT = np.array([-0.5, -0.6, 0.62])
"""Direction to the light of a matte ball; the viewer is at −y, up is z."""


def ball(kind: str) -> np.ndarray:
    """A sphere (SIZE, SIZE, 4), top row first, display values: matte grey, or a mirror of a plain sky."""
    x, z = np.meshgrid(np.linspace(-1.06, 1.06, SIZE), np.linspace(1.06, -1.06, SIZE))
    squared = x**2 + z**2
    normal = np.stack([x, -np.sqrt(np.maximum(1 - squared, 0)), z], axis=-1)
    if kind == "MIRROR":
        reflected_z = 2 * normal[..., 1] * normal[..., 2] * -1  # of the view direction +y
        shade = np.where(reflected_z > 0, 0.92 - 0.5 * reflected_z, 0.15 - 0.1 * reflected_z)
    else:
        shade = 0.12 + 0.6 * np.maximum(normal @ (LIGHT / np.linalg.norm(LIGHT)), 0)
    alpha = np.clip((1 - np.sqrt(squared)) * SIZE / 2.12 + 0.5, 0, 1)
    colour = np.repeat((shade * alpha)[..., None], 3, axis=-1)  # Blender expects it premultiplied
    return np.concatenate([colour, alpha[..., None]], axis=-1)


def panorama(image: np.ndarray) -> np.ndarray:
    """A panorama (H, 2H, 3) in display values (2H, 2H, 4), between transparent bands."""
    shown = srgb_from_linear(image * exposure_for(image))
    height = len(image)
    square = np.zeros((2 * height, 2 * height, 4), np.float32)
    rows = slice(height // 2, height // 2 + height)
    square[rows, :, :3], square[rows, :, 3] = shown, 1
    return square
