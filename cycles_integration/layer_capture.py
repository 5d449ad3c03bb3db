"""A scene as a panorama in layers, rendered directly: the successive surfaces along each ray, each as lit.

The first layer is what the camera sees. For each further one its rays begin behind the surface before, so
that they show the next, with the light, shadows and mirror images of the whole scene (thesis, 6.3.2). What
no view within the radius can see is left out, and not rendered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import cv2
import numpy as np
from mathutils import Matrix

from ..ibl_toolkit.layers.making.uncovered import (
    can_be_seen,
    share_of_sphere,
    uncovered_reach,
    usual_radius,
)
from ..ibl_toolkit.layers.panorama import EQUIRECTANGULAR, Layer, LayeredPanorama
from . import capture
from .layer_scene import rendered_scene
from .next_surface import geometry_only, marked, unseen
from .ray_start import RayStart, ray_start
from .solids import closed_solids

FINER = 3
"""Samples of a pixel lie on a grid of so many across: the middle one is the pixel's centre."""
FAR = 1e6
"""Cycles' depth of what no surface covers is larger [m]."""
SLACK = 2e-4
"""A ray begins behind a surface by this share of its distance, and before one that it is to meet."""
SAME_SURFACE = 1.1
"""What lies within this ratio of depth of a pixel's centre is taken for its surface: the pixel's radiance is
the mean over that part of it."""
LEAST_SHARE = 1e-4
"""A layer that would show less of the sphere is not made."""
RIM = 2
"""Rays are traced so many pixels beyond a domain, for the denoiser."""
INFINITY = 1e5
"""Rays that meet no more surface begin here [m]."""


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


def capture_surfaces(
    scene: bpy.types.Scene,
    world_from_panorama: Matrix,
    radius: float | None,
    options: LayerCapture,
    tell: Callable[[str], None] = lambda step: None,
) -> LayeredPanorama:
    """Render the surfaces along the rays from a frame's (4, 4) origin: layers "surface 1", "surface 2", …

    The scene stays as it is: what its first view layer for rendering shows is rendered in a copy of it. Depth
    [m] is that of pixel centres, +inf at infinity, NaN where a layer shows nothing that is seen within
    `radius` [m] of the origin; None: `usual_radius`. `tell` hears the name of each step.

    Raises: ValueError for a radius that is not above 0.

    Source: thesis, 6.3.2.
    """
    refuse_other_radius(radius)
    with rendered_scene(scene, world_from_panorama) as taken:
        return surfaces_of(taken, world_from_panorama, radius, options, tell)


def surfaces_of(taken, world_from_panorama, radius, options, tell=lambda step: None):
    """What `capture_surfaces` gives, of a temporary scene with its camera; its settings are changed."""
    frame = np.array(world_from_panorama, dtype=np.float64)
    set_up(taken, options)
    solids = closed_solids(taken.view_layers[0], world_from_panorama.translation)
    with ray_start(taken, world_from_panorama, taken.render.resolution_x) as start, marked(solids):
        rays = _Rays(taken, start, solids, radius, options)
        layers = tuple(rays.layers(tell))
    return LayeredPanorama(layers, frame[:3, :3], frame[:3, 3], rays.radius)


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


class _Rays:
    """The rays of a capture, and how far each has come. Arrays named fine are those of the renders."""

    def __init__(self, taken, start: RayStart, solids, radius, options):
        self.taken, self.start, self.solids, self.radius, self.options = taken, start, solids, radius, options
        height, width = options.width // 2, options.width
        self.fine_depth = None
        self.front = None  # (H, W) [m] the farthest surface known whose back may be seen
        self.is_ended = np.zeros((height, width), bool)

    def layers(self, tell):
        tell("surface 1")
        everything = np.ones(self.is_ended.shape, bool)
        fine_start = np.zeros(self._fine(everything).shape, np.float32)
        yield self._layer(1, fine_start, everything)
        self.front = self._centres(self.fine_depth)
        if self.radius is None:
            self.radius = usual_radius(self.front)
        for number in range(2, self.options.most + 1):
            tell(f"surface {number}")
            kept, fine_start = self._next()
            if share_of_sphere(kept) < LEAST_SHARE:
                return
            yield self._layer(number, fine_start, kept)
            self.front[kept] = self._centres(self.fine_depth)[kept]

    def _next(self):
        """Which pixels (H, W) the next layer shows, and where its rays begin (fine) [m]."""
        reach = uncovered_reach(self.front, self.radius)
        self.is_ended |= ~can_be_seen(reach, np.inf, self.radius) | ~np.isfinite(self.front)
        alive = ~self.is_ended
        if not alive.any():
            return alive, None
        traced = self._fine(_grown(alive, RIM)) & np.isfinite(self.fine_depth)
        behind = np.where(traced, self.fine_depth * (1 + SLACK), np.nan)
        found = self._geometry(behind)
        behind_front = np.where(alive, self._centres(found), np.nan)
        reach = uncovered_reach(self.front, self.radius, behind_front)
        kept = alive & can_be_seen(reach, behind_front, self.radius)
        self.is_ended |= ~kept
        before = np.maximum(behind, np.minimum(found * (1 - SLACK), INFINITY))
        return kept, np.where(self._fine(_grown(kept, RIM)), before, np.nan)

    def _geometry(self, fine_start):
        """Distances of the next surfaces (fine) [m]: +inf for none, NaN where no ray is."""
        self.start.set(fine_start)
        self.taken.cycles.samples, self.taken.cycles.use_denoising = 1, False
        with geometry_only(self.taken.view_layers[0], self.start):
            depth = capture.render_in_strips(self.taken, ("Depth",))["Depth"]
            with unseen(self.solids):
                depth = np.minimum(depth, capture.render_in_strips(self.taken, ("Depth",))["Depth"])
        return np.where(np.isnan(fine_start), np.float32(np.nan), ray_depth(depth))

    def _layer(self, number, fine_start, kept):
        set_up(self.taken, self.options)
        self.taken.cycles.seed += number - 1
        self.start.set(fine_start)
        passes = capture.render_in_strips(self.taken, ("Combined", "Depth"))
        depth = np.where(np.isnan(fine_start), np.float32(np.nan), ray_depth(passes["Depth"]))
        self.fine_depth = depth
        centre = self._centres(depth)
        attributes = {
            "radiance": mean_of_surface(passes["Combined"], depth, centre, self.options.finer),
            "depth": np.where(kept, centre, np.float32(np.nan)),
        }
        return Layer(f"surface {number}", EQUIRECTANGULAR, attributes)

    def _fine(self, pixels):
        finer = self.options.finer
        return pixels.repeat(finer, axis=0).repeat(finer, axis=1)

    def _centres(self, fine):
        return centres(fine, self.options.finer)


def _grown(pixels, by):
    """Pixels (H, W) and those up to `by` away, round the seam."""
    wrapped = np.concatenate([pixels[:, -by:], pixels, pixels[:, :by]], axis=1).astype(np.uint8)
    kernel = np.ones((2 * by + 1, 2 * by + 1), np.uint8)
    return cv2.dilate(wrapped, kernel)[:, by:-by].astype(bool)
