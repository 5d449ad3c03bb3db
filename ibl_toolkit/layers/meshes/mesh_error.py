"""How far a mesh of a layer is off the layer, in pixels of parallax: any mesh, by its triangles alone."""

from __future__ import annotations

import numpy as np

from ..panorama import Layer
from .map_pixels import MapPixels
from .parallax import parallax, pixel_angle
from .triangle_pixels import triangle_pixels

_AT_ONCE = 1 << 16  # triangles


def mesh_error(mesh, layer: Layer, radius: float) -> np.ndarray:
    """Error (H, W) [px] of a mesh at the layer's pixels: the largest parallax from within ``radius`` [m].

    mesh: has `points` (V, 3) [m] from the origin and `triangles` (T, 3), as a `LayerMesh` or `BoundedMesh`.
    NaN outside of the layer's domain and for what lies at infinity, +inf where the domain has no triangle.
    A pixel is the layer's own, see `pixel_angle`; the depth is that of the ray through its middle.

    >>> from .layer_mesh import uniform_mesh
    >>> wall = Layer("wall", "equirectangular", {"depth": np.full((64, 128), 3.0, np.float32)})
    >>> bool(np.nanmax(mesh_error(uniform_mesh(wall), wall, 1.0)) < 0.02)
    True
    """
    pixels = MapPixels(layer)
    near = np.full(pixels.inside.size, np.nan)
    points = mesh.points
    for start in range(0, len(mesh.triangles), _AT_ONCE):
        corners = points[mesh.triangles[start : start + _AT_ONCE]]
        # The plane of a triangle: its product with a point of the triangle is 1, with a direction 1/depth.
        planes = np.linalg.solve(corners, np.ones((len(corners), 3, 1)))[..., 0]
        corners /= np.linalg.norm(corners, axis=2, keepdims=True)
        for triangle, pixel in triangle_pixels(corners, layer.mapping, *layer.size):
            near[pixel] = np.einsum("nk,nk->n", planes[triangle], pixels.directions(pixel))
    inside = np.flatnonzero(pixels.inside)
    off = np.abs(parallax(np.maximum(near[inside], 0), radius) - parallax(pixels.near(inside), radius))
    errors = np.full(near.shape, np.nan)
    errors[inside] = np.where(np.isnan(off), np.inf, off / pixel_angle(layer))
    return errors.reshape(pixels.inside.shape)
