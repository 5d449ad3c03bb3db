"""Views of a layered panorama from its meshes (thesis, section 7.4).

Each layer's mesh is drawn by itself with the layer's colours projected from the origin, and in each pixel
the nearest of them is seen. Both sides of a mesh are drawn: the back of a surface, which the origin never
saw, shows the colours of its front.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ..meshes.layer_mesh import quadtree_mesh, quadtree_of, uniform_mesh, uniform_triangles
from ..panorama import LayeredPanorama
from ..views.pinhole import Pinhole
from ..views.rendered_view import RenderedView, far_view
from .cracks import without_cracks
from .mesh_in_sight import pixels_in_sight
from .projective_texture import ProjectiveTexture
from .rasterizer import rasterize


def mesh_view(
    panorama: LayeredPanorama, camera: Pinhole, meshes: Iterable, *, cut: bool = True
) -> RenderedView:
    """What a camera in the world sees of the meshes of a panorama's layers, one for each in their order.

    meshes: objects with `points` (V, 3) [m], in the panorama's frame, and `triangles` (T, 3), their indices.
    Those of a generator are held one at a time. cut: whether what a mesh has outside of its layer's domain is
    left out, so that it hides nothing; a mesh that ends where the domain ends needs no cutting. What lies at
    infinity is behind all, and cracks are closed. `triangles` counts those of all meshes, in sight or not.

    Raises: ValueError for a layer without radiance, and for more or fewer meshes than layers.
    """
    view = _Canvas(panorama, camera)
    meshes = iter(meshes)
    for number, layer in enumerate(panorama.layers):
        mesh = next(meshes, None)
        if mesh is None:
            raise ValueError(f"{number} meshes for {len(panorama.layers)} layers: each must have one")
        view.draw(layer, mesh, cut)
    if next(meshes, None) is not None:
        raise ValueError(f"more meshes than layers, which are {len(panorama.layers)}: each must have one")
    return without_cracks(view.before(far_view(panorama, camera)), panorama, camera)


def grid_view(panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """What a camera sees of uniform meshes, two triangles for each pixel (7.4.1). Raises as `mesh_view`.

    Triangles that are surely out of sight are not even made; `triangles` counts them all the same.
    """
    inner = camera.in_panorama(panorama)
    meshes = (uniform_mesh(layer, pixels_in_sight(layer, inner)) for layer in panorama.layers)
    view = mesh_view(panorama, camera, meshes, cut=False)
    return replace(view, triangles=sum(uniform_triangles(layer) for layer in panorama.layers))


def quadtree_view(panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """What a camera sees of meshes by quadtrees (7.4.2). Raises as `mesh_view`."""
    meshes = (quadtree_mesh(layer, quadtree_of(layer)) for layer in panorama.layers)
    return mesh_view(panorama, camera, meshes, cut=False)


class _Canvas:
    """A view on which one layer after the other is drawn, the nearest in front."""

    def __init__(self, panorama, camera):
        self._camera = camera.in_panorama(panorama)
        self._rays = self._camera.directions()
        self._radiance, self._triangles = np.zeros(self._rays.shape, dtype=np.float32), 0
        self._along_ray = 1 / (self._rays @ self._camera.axes[2])
        self._distance = np.full(self._rays.shape[:2], np.inf, dtype=np.float32)

    def draw(self, layer, mesh, cut):
        texture = ProjectiveTexture(layer)
        raster = rasterize(mesh.points, mesh.triangles, self._camera, texture.has if cut else None)
        nearer = raster.distance < self._distance
        self._distance[nearer] = raster.distance[nearer]
        depth = self._distance[nearer] * self._along_ray[nearer]
        points = self._camera.eye + self._rays[nearer] * depth[:, None]
        self._radiance[nearer] = texture.radiance(points)
        self._triangles += len(mesh.triangles)

    def before(self, background):
        """All that was drawn, and the background in between."""
        drawn = np.isfinite(self._distance)
        radiance = np.where(drawn[..., None], self._radiance, background.radiance)
        depth = np.where(drawn, self._distance * self._along_ray, background.depth)
        return RenderedView(radiance, depth.astype(np.float32), self._triangles)
