"""A scene as a panorama in layers, rendered directly: the successive surfaces along each ray, each as lit.

The first layer is what the camera sees. For each further one its rays begin behind the surface before, so
that they show the next, with the light, shadows and mirror images of the whole scene (thesis, 6.3.2). What
no view within the radius can see is left out, and not rendered.

Where a ray leaves a closed solid, a view from beside may see the solid's far side. That is rendered by rays
that go back towards the camera.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy
import cv2
import numpy as np
from mathutils import Matrix

from ..ibl_toolkit.layers.making.continuous import continuous_layers
from ..ibl_toolkit.layers.making.uncovered import (
    MARGIN_PX,
    can_be_seen,
    share_of_sphere,
    uncovered_reach,
    usual_radius,
)
from ..ibl_toolkit.layers.panorama import EQUIRECTANGULAR, Layer, LayeredPanorama
from . import capture
from .layer_render import LayerCapture, centres, mean_of_surface, ray_depth, refuse_other_radius, set_up
from .layer_scene import rendered_scene
from .next_surface import geometry_only, marked, to_plane, unseen
from .ray_start import RayStart, ray_start
from .solids import closed_solids

SLACK = 2e-4
"""A ray begins behind a surface by this share of its distance, and before one that it is to meet."""
LEAST_SHARE = 1e-4
"""A layer that would show less of the sphere is not made."""
RIM = 2
"""Rays are traced so many pixels beyond a domain, for the denoiser."""
SURFACE = "surface"
"""Names of layers that follow each other along the rays begin with it."""
INFINITY = 1e5
"""Rays that meet no more surface begin here [m]."""


def capture_surfaces(
    scene: bpy.types.Scene,
    world_from_panorama: Matrix,
    radius: float | None,
    options: LayerCapture,
    tell: Callable[[str], None] = lambda step: None,
) -> LayeredPanorama:
    """Render the surfaces along the rays from a frame's (4, 4) origin: layers "surface 1", "surface 2", …

    Where such a surface is of a closed solid, its far side is in a layer "back of surface 1", …
    The scene stays as it is: what its first view layer for rendering shows is rendered in a copy of it. Depth
    [m] is that of pixel centres, +inf at infinity, NaN where a layer shows nothing that is seen within
    `radius` [m] of the origin; None: `usual_radius`. `tell` hears the name of each step.

    Raises: ValueError for a radius that is not above 0.

    Source: thesis, 6.3.2.
    """
    refuse_other_radius(radius)
    with rendered_scene(scene, world_from_panorama) as taken:
        return surfaces_of(taken, world_from_panorama, radius, options, tell)


def split_surfaces(captured: LayeredPanorama, count: int | None = None) -> LayeredPanorama:
    """Continuous layers of what `capture_surfaces` gives: see `continuous_layers`."""
    surfaces = [layer.name for layer in captured.layers if layer.name.startswith(SURFACE)]
    return continuous_layers(captured, surfaces, count)


def surfaces_of(taken, world_from_panorama, radius, options, tell=lambda step: None):
    """What `capture_surfaces` gives, of a temporary scene with its camera; its settings are changed."""
    frame = np.array(world_from_panorama, dtype=np.float64)
    set_up(taken, options)
    solids = closed_solids(taken.view_layers[0], world_from_panorama.translation)
    with ray_start(taken, world_from_panorama, taken.render.resolution_x) as start, marked(solids):
        rays = _Rays(taken, start, solids, radius, options)
        layers = tuple(rays.layers(tell))
    return LayeredPanorama(layers, frame[:3, :3], frame[:3, 3], rays.radius)


class _Rays:
    """The rays of a capture, and how far each has come. Arrays named fine are those of the renders."""

    def __init__(self, taken, start: RayStart, solids, radius, options):
        self.taken, self.start, self.solids, self.radius, self.options = taken, start, solids, radius, options
        self.fine_depth = None
        self.front = None  # (H, W) [m] the farthest surface known whose back may be seen
        self.is_ended = np.zeros((options.width // 2, options.width), bool)

    def layers(self, tell):
        """The surfaces, each followed by the far sides of its solids."""
        kept = np.ones(self.is_ended.shape, bool)
        fine_start = np.zeros(self._fine(kept).shape, np.float32)
        for number in range(1, self.options.most + 1):
            name = f"{SURFACE} {number}"
            tell(name)
            layer, self.fine_depth = self._layer(name, fine_start, kept, number)
            yield layer
            self._advance(kept)
            if number == self.options.most or self.is_ended.all():
                return
            tell(f"back of {name}")
            reach, behind = self._behind()
            kept, fine_start = self._backs(reach, behind)
            if share_of_sphere(kept) >= LEAST_SHARE:
                yield self._layer(f"back of {name}", fine_start, kept, number, inward=True)[0]
            kept, fine_start = self._next(behind)
            if share_of_sphere(kept) < LEAST_SHARE:
                return

    def _advance(self, kept):
        """Take the surfaces of a layer for those in front, and end the rays behind which nothing is seen."""
        depth = centres(self.fine_depth, self.options.finer)
        self.front = depth if self.front is None else np.where(kept, depth, self.front)
        if self.radius is None:
            self.radius = usual_radius(self.front)
        reach = uncovered_reach(self.front, self.radius)
        self.is_ended |= ~can_be_seen(reach, np.inf, self.radius) | ~np.isfinite(self.front)

    def _behind(self):
        """How far it is to be seen behind what is in front, and where rays go on (fine) [m], NaN for none."""
        reach = np.where(self.is_ended, -np.inf, uncovered_reach(self.front, self.radius))
        traced = self._fine(_grown(~self.is_ended, RIM)) & np.isfinite(self.fine_depth)
        return reach, np.where(traced, self.fine_depth * (1 + SLACK), np.nan)

    def _backs(self, reach, behind):
        """Which pixels show the far side of a solid, and where rays begin that go back to it (fine) [m].

        It is seen from where its tangent plane has been crossed: that must be nearer than the radius.
        """
        passes = self._geometry(behind, with_inside=True)
        distance = to_plane(passes["Combined"])
        depth = np.where(np.isnan(distance), distance, ray_depth(passes["Depth"]))
        centre, distance = (centres(each, self.options.finer) for each in (depth, distance))
        margin = MARGIN_PX * np.pi / len(centre) * centre
        kept = (distance < self.radius + margin) & can_be_seen(reach, centre, self.radius) & ~self.is_ended
        return kept, np.where(self._fine(_grown(kept, RIM)), depth * (1 + SLACK), np.nan)

    def _next(self, behind):
        """Which pixels (H, W) the next surface is kept in, and where rays to it begin (fine) [m]."""
        found = ray_depth(self._geometry(behind)["Depth"])
        with unseen(self.solids):
            found = np.minimum(found, ray_depth(self._geometry(behind)["Depth"]))
        centre = np.where(self.is_ended, np.nan, centres(found, self.options.finer))
        reach = uncovered_reach(self.front, self.radius, centre)
        kept = can_be_seen(reach, centre, self.radius) & ~self.is_ended
        self.is_ended |= ~kept
        before = np.maximum(behind, np.minimum(found * (1 - SLACK), INFINITY))
        return kept, np.where(self._fine(_grown(kept, RIM)), before, np.nan)

    def _geometry(self, fine_start, *, with_inside=False):
        """The passes of the next surfaces."""
        self.start.set(fine_start)
        self.taken.cycles.samples, self.taken.cycles.use_denoising = 1, False
        with geometry_only(self.taken.view_layers[0], self.start, with_inside=with_inside):
            return capture.render_in_strips(self.taken, ("Combined", "Depth"))

    def _layer(self, name, fine_start, kept, number, *, inward=False):
        """A layer of the pixels that are kept, and its depth (fine) [m]."""
        set_up(self.taken, self.options)
        self.taken.cycles.seed += number - 1
        self.start.set(fine_start, inward=inward)
        passes = capture.render_in_strips(self.taken, ("Combined", "Depth"))
        depth = np.where(np.isnan(fine_start), np.float32(np.nan), ray_depth(passes["Depth"]))
        centre = centres(depth, self.options.finer)
        attributes = {
            "radiance": mean_of_surface(passes["Combined"], depth, centre, self.options.finer),
            "depth": np.where(kept, centre, np.float32(np.nan)),
        }
        return Layer(name, EQUIRECTANGULAR, attributes), depth

    def _fine(self, pixels):
        finer = self.options.finer
        return pixels.repeat(finer, axis=0).repeat(finer, axis=1)


def _grown(pixels, by):
    """Pixels (H, W) and those up to `by` away, round the seam."""
    wrapped = np.concatenate([pixels[:, -by:], pixels, pixels[:, :by]], axis=1).astype(np.uint8)
    kernel = np.ones((2 * by + 1, 2 * by + 1), np.uint8)
    return cv2.dilate(wrapped, kernel)[:, by:-by].astype(bool)
