"""What renders of layers have in common: their size, their samples, and pixels made of what they show."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

FINER = 3
"""Samples of a pixel lie on a grid of so many across: the middle one is the pixel's centre."""
FAR = 1e6
"""Cycles' depth of what no surface covers is larger [m]."""
SAME_SURFACE = 1.1
"""What lies within this ratio of depth of a pixel's centre is taken for its surface: the pixel's radiance is
the mean over that part of it."""


@dataclass(frozen=True)
class LayerCapture:
    """How layers are rendered.

    width: of the maps, width × width/2 [px], even. samples: paths per pixel; below FINER² they all lie on its
    centre, else they are spread over it. most: layers at most; fewer where nothing new is uncovered.
    """

    width: int = 2048
    samples: int = 64
    most: int = 4
    denoise: bool = False
    seed: int = 0

    def __post_init__(self):
        if self.width < 8 or self.width % 2 or self.samples < 1 or self.most < 1:
            raise ValueError(
                f"{self.most} layers of width {self.width} px at {self.samples} samples; "
                "expected at least 1 layer, 1 sample and 8 px, and an even width"
            )

    @property
    def finer(self) -> int:
        """How many times as fine as the layers the renders are."""
        return FINER if self.samples >= FINER**2 else 1


def refuse_other_radius(radius: float | None):
    """Raise ValueError unless a radius [m] is None, or finite and above 0."""
    if radius is not None and not 0 < radius < np.inf:
        raise ValueError(f"radius {radius} m: must be finite and above 0, for nothing is hidden at 0")


def set_up(taken: bpy.types.Scene, options: LayerCapture):
    """Give a temporary scene the size, the samples and the seed of these options."""
    taken.render.resolution_x = options.width * options.finer
    taken.render.resolution_y = taken.render.resolution_x // 2
    taken.cycles.samples = max(1, round(options.samples / options.finer**2))
    taken.cycles.use_denoising, taken.cycles.seed = options.denoise, options.seed


def ray_depth(depth: np.ndarray) -> np.ndarray:
    """Cycles' depth (H, W) [m] with +inf where it met nothing."""
    return np.where(depth < FAR, depth, np.inf).astype(np.float32)


def centres(fine: np.ndarray, finer: int) -> np.ndarray:
    """Of the values (finer·H, finer·W) of a render those of the pixels' centres (H, W)."""
    return fine[finer // 2 :: finer, finer // 2 :: finer].copy()


def mean_of_surface(picture: np.ndarray, depth: np.ndarray, centre: np.ndarray, finer: int) -> np.ndarray:
    """Radiance (H, W, 3): the mean over those parts of a pixel that show the surface at its centre.

    picture: (finer·H, finer·W, 3 or 4) and its depth; centre: (H, W) [m].
    """
    radiance = np.maximum(np.nan_to_num(picture[..., :3], posinf=0, neginf=0), 0)
    total, count = 0, 0
    for row in range(finer):
        for column in range(finer):
            part = depth[row::finer, column::finer]
            with np.errstate(invalid="ignore"):
                ratio = np.maximum(part / centre, centre / part)
            is_same = (ratio < SAME_SURFACE) | (np.isinf(part) & np.isinf(centre))
            total = total + np.where(is_same[..., None], radiance[row::finer, column::finer], 0)
            count = count + is_same
    return (total / np.maximum(count, 1)[..., None]).astype(np.float32)
