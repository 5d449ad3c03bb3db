"""A layer's colours on a surface: what the layer shows in the direction in which its origin has the surface.

So they stay in place on triangles of any size and shape, whereas a texture interpolated between a triangle's
vertices is distorted (thesis, 7.4.3, which names projective textures as a cure).
"""

from __future__ import annotations

import numpy as np

from ..panorama import Layer
from ..views.rendered_view import sampled

INSIDE = 0.5
"""A direction is in the domain if at least so much of the weight of the four pixels round it is."""


class ProjectiveTexture:
    """The radiance of a layer's domain, less what lies at infinity.

    Raises: ValueError for a layer without radiance.
    """

    def __init__(self, layer: Layer):
        if layer.radiance is None:
            raise ValueError(f"{layer} has no radiance: there is nothing to see of it")
        self._layer, self._texels, self._domain = layer, layer.radiance, None
        domain = layer.mask & np.isfinite(layer.depth)
        if not domain.all():  # what colours mean outside is not known: they may be NaN
            self._texels = np.zeros(layer.radiance.shape, dtype=np.float32)
            self._texels[domain] = layer.radiance[domain]
            self._domain = domain.astype(np.float32)

    def has(self, points: np.ndarray) -> np.ndarray:
        """Whether points (n, 3) [m], in the panorama's frame, are in a direction of the domain: (n,) bool."""
        if self._domain is None:
            return np.ones(len(points), dtype=bool)
        return sampled(self._layer, self._domain, points) >= INSIDE

    def radiance(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) at points (n, 3) [m]: bilinear, of the domain's pixels alone; 0 where there are none."""
        colours = sampled(self._layer, self._texels, points)
        if self._domain is None:
            return colours
        share = sampled(self._layer, self._domain, points)[:, None]
        return np.divide(colours, share, out=np.zeros_like(colours), where=share > 0)
