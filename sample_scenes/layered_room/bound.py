"""What the best method could show: the true surfaces of a view, in the colours that the layers have of them.

A method that sees a layered panorama from beside has to find out where surfaces are, and which layer shows
them. Here both are given: each pixel's true point gets the colours of those pixels round its direction, in
the layer that has its surface there, that lie on it. What is left of the error is the layers' own: their
resolution, light that changes with the eye, and what no layer has seen.
"""

from __future__ import annotations

import numpy as np

from ...ibl_toolkit import equirectangular
from ...ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from ...ibl_toolkit.layers.views.pinhole import Pinhole
from ...ibl_toolkit.layers.views.rendered_view import RenderedView
from ...ibl_toolkit.layers.views.texels import sheets_of, texel_index
from ...ibl_toolkit.layers.views.visible_tiles import mapping_of

SAME_SURFACE = 1.05
"""Of the four pixels round a direction those count whose depth is worse than the best by this at most."""
_LEAST_WEIGHT = 1e-9  # a direction may lie on the middle of a pixel that does not count


def bound_view(panorama: LayeredPanorama, camera: Pinhole, distance: np.ndarray) -> RenderedView:
    """The view of the true surfaces, at ``distance`` (H, W) [m] along the camera's forward axis.

    A point gets its colour from the layer with the pixel, among the four round the point's direction, whose
    depth is the nearest to its own by ratio: where none is right, as behind a cushion, that is the best
    guess. It is a hole where no layer has its direction.

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
    radiance, misfit = np.zeros(points.shape, dtype=np.float32), np.full(len(points), np.inf)
    for layer in panorama.layers:
        if layer.radiance is None:
            raise ValueError(f"{layer} has no radiance: there is nothing to see of it")
        texels, weights = _texels_round(layer, points)
        misfits = _misfits(layer, texels, np.linalg.norm(points, axis=1))
        least = misfits.min(axis=0)
        better = np.flatnonzero(least < misfit)
        misfit[better] = least[better]
        fits = (misfits <= least + np.log(SAME_SURFACE))[:, better]
        weights = np.where(fits, np.maximum(weights[:, better], _LEAST_WEIGHT), 0)
        colours = np.where(fits[..., None], layer.radiance.reshape(-1, 3)[texels[:, better]], 0)
        radiance[better] = np.einsum("kn,knc->nc", weights, colours) / weights.sum(axis=0)[:, None]
    depth = np.where(np.isfinite(misfit).reshape(distance.shape), along_ray, np.nan).astype(np.float32)
    return RenderedView(radiance.reshape(*distance.shape, 3), depth)


def _texels_round(layer: Layer, points):
    """Row-major indices (4, n) of the pixels round points' directions, and their bilinear weights (4, n)."""
    (width, height), (_, rows, columns) = layer.size, sheets_of(layer.mapping, *layer.size)
    x, y = mapping_of(layer).uv_from_direction(points).T * [[width], [height]]
    across, down = (np.clip(k // n, 0, m // n - 1) for k, n, m in ((x, columns, width), (y, rows, height)))
    i, j = x - across * columns - 0.5, y - down * rows - 0.5
    left, top = (np.floor(k).astype(np.int64) for k in (i, j))
    sheet = (down * (width // columns) + across).astype(np.int64)
    places = ((top, left), (top, left + 1), (top + 1, left), (top + 1, left + 1))
    texels = np.stack([texel_index(layer.mapping, width, height, sheet, *place) for place in places])
    weights = np.stack(equirectangular.bilinear_weights(i - left, j - top))
    return np.maximum(texels, 0), np.where(texels >= 0, weights, 0)


def _misfits(layer: Layer, texels, depth):
    """How far (4, n) texels' depths are off those (n,) of points, |log|; inf outside of the domain."""
    own = np.where(layer.mask & np.isfinite(layer.depth), layer.depth, np.inf).reshape(-1)[texels]
    return np.abs(np.log(own / depth))
