"""Views of layered panoramas by the name of the method."""

from __future__ import annotations

import numpy as np

from ..making.continuous_pieces import cut_at_jumps
from ..meshes.bounded_mesh import bounded_mesh
from ..panorama import LayeredPanorama
from ..points.adaptive_splatting import adaptive_view
from ..points.splatting import splat_view
from ..raster.mesh_view import grid_view, mesh_view, quadtree_view
from .pinhole import Pinhole
from .rendered_view import RenderedView


def bounded_view(panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """A view of the meshes of `bounded_mesh`, right to half a pixel of each layer within the radius, and cut
    where its depth jumps."""
    panorama = cut_at_jumps(panorama)
    return mesh_view(panorama, camera, (bounded_mesh(layer, panorama.radius) for layer in panorama.layers))


METHODS = {
    "splat": splat_view,
    "adaptive": adaptive_view,
    "grid": grid_view,
    "quadtree": quadtree_view,
    "mesh": bounded_view,
}
"""By name, what makes a RenderedView of a panorama and a camera (thesis, 7.3.1 to 7.4.2; ours)."""


def render_view(panorama: LayeredPanorama, camera: Pinhole, method: str) -> RenderedView:
    """See a panorama through a camera in the world.

    Raises: ValueError for a method that is none of METHODS, and what the method raises.
    """
    if method not in METHODS:
        raise ValueError(f"method {method!r} must be one of {', '.join(METHODS)}")
    return METHODS[method](panorama, camera)


def outside_by(panorama: LayeredPanorama, camera: Pinhole) -> float:
    """How far the eye is outside of the panorama's radius [m], 0 within it."""
    distance = float(np.linalg.norm(camera.eye - np.asarray(panorama.origin)))
    return max(0.0, distance - panorama.radius)
