"""What the best method could show: the true surfaces of a view, in the colours that the layers have of them.

A method that sees a layered panorama from beside has to find out where surfaces are, and which layer shows
them. Here both are given: each pixel's true point is looked up in the layer that has its surface there. What
is left of the error is the layers' own: their resolution, light that changes with the eye, and what no layer
has seen.
"""

from __future__ import annotations

import numpy as np

from ...ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from ...ibl_toolkit.layers.pinhole import Pinhole
from ...ibl_toolkit.layers.projective_texture import ProjectiveTexture
from ...ibl_toolkit.layers.rendered_view import RenderedView, sampled


def bound_view(panorama: LayeredPanorama, camera: Pinhole, distance: np.ndarray) -> RenderedView:
    """The view of the true surfaces, at ``distance`` (H, W) [m] along the camera's forward axis.

    A point that several layers have in their domain gets its colour from the one whose depth in its direction
    is the nearest to its own, by ratio: where none is right, as behind a cushion, that is the best guess. It
    is a hole where no layer has its direction. Depths are compared bilinearly, in reciprocals.

    Raises: ValueError for distances of another size than the camera's picture, or not above 0, and for a
    layer without radiance.
    """
    if distance.shape != (camera.height, camera.width):
        raise ValueError(
            f"distances of {distance.shape[::-1]} px, must be {camera.width} x {camera.height} as the picture"
        )
    if not (distance > 0).all():
        raise ValueError("distances of true surfaces must be above 0")
    inner = camera.in_panorama(panorama)
    rays = inner.directions()
    along_ray = distance / (rays @ inner.axes[2])
    points = (inner.eye + rays * along_ray[..., None]).reshape(-1, 3)
    near = 1 / np.linalg.norm(points, axis=1)
    radiance, misfit = np.zeros(points.shape, dtype=np.float32), np.full(len(points), np.inf)
    for layer in panorama.layers:
        better = np.flatnonzero(_misfit(layer, points, near) < misfit)
        misfit[better] = _misfit(layer, points[better], near[better])
        radiance[better] = ProjectiveTexture(layer).radiance(points[better])
    depth = np.where(np.isfinite(misfit).reshape(distance.shape), along_ray, np.nan).astype(np.float32)
    return RenderedView(radiance.reshape(*distance.shape, 3), depth)


def _misfit(layer: Layer, points, near):
    """How far (n,) reciprocals of points' depths (n,) are off the layer's, |log|; inf out of its domain."""
    domain = layer.mask & np.isfinite(layer.depth)
    own = np.divide(1.0, layer.depth, out=np.zeros_like(layer.depth), where=domain)
    share = sampled(layer, domain.astype(np.float32), points)
    own = sampled(layer, own, points)
    ratio = np.divide(own, share * near, out=np.full_like(near, np.inf), where=share > 0)
    return np.abs(np.log(ratio))
