"""Triangle meshes of a layer, whose vertices are corners of its pixels.

Source: thesis, sections 7.4.1 (uniform) and 7.4.2 (quadtree).
"""

from dataclasses import dataclass

import numpy as np

from ..panorama import Layer
from .corners import Corners
from .quadtree import Quadtree
from .subdivision import Subdivision, layer_quadtree
from .summed_area import rectangle_sums, summed_area_table
from .triangulation import triangulate_cells, triangulate_pixels


@dataclass(frozen=True, eq=False)
class LayerMesh:
    """A mesh over the domain of a layer.

    corners: those of the layer's pixels. vertices: (V,) int64, rising, their numbers (see `Corners`).
    depths: (V,) [m] along the ray. triangles: (T, 3) int32 indices into them, counter-clockwise as seen from
    the panorama's origin.
    """

    corners: Corners
    vertices: np.ndarray
    depths: np.ndarray
    triangles: np.ndarray

    @property
    def points(self) -> np.ndarray:
        """(V, 3) [m] from the panorama's origin, in its frame."""
        return self.corners.directions(self.vertices) * self.depths[:, None]


def quadtree_of(layer: Layer, subdivision: Subdivision | None = None) -> Quadtree:
    """The quadtree that `quadtree_mesh` triangulates; small to store (see `quadtree_code`)."""
    corners, depth, inside = _sheets(layer)
    return layer_quadtree(corners, depth, inside, subdivision or Subdivision())


def quadtree_mesh(layer: Layer, tree: Quadtree) -> LayerMesh:
    """The conforming mesh of the leaves that lie in the layer's domain (7.4.2.4).

    What lies at infinity is left out. Raises ValueError for a tree of another size or domain.

    >>> wall = Layer("wall", "equirectangular", {"depth": np.full((4, 8), 3.0, np.float32)})
    >>> len(quadtree_mesh(wall, quadtree_of(wall)).triangles)
    48
    """
    corners, depth, inside = _sheets(layer)
    if (tree.sheets, tree.height, tree.width) != corners.sheet_shape:
        raise ValueError(
            f"quadtree is of {tree.sheets} sheets of {tree.width} x {tree.height} px, {layer} has "
            "{0} of {2} x {1} px".format(*corners.sheet_shape)
        )
    leaves = tree.leaves()
    pixels = rectangle_sums(
        summed_area_table(inside), leaves.x0, leaves.y0, leaves.x1, leaves.y1, leaves.sheet
    )
    crossing = np.count_nonzero((pixels > 0) & (pixels < leaves.area))
    if crossing:
        raise ValueError(f"{crossing} leaves of the quadtree cross the rim of {layer}'s domain")
    return _mesh(corners, depth, inside, triangulate_cells(leaves.chosen(pixels > 0), corners))


def uniform_mesh(layer: Layer, pixels: np.ndarray | None = None) -> LayerMesh:
    """Two triangles for each pixel of the layer's domain, one in the rows at the poles (7.4.1).

    pixels: (H, W) bool, if only a part of the mesh is wanted: those of these pixels. What lies at infinity is
    left out.

    >>> wall = Layer("wall", "equirectangular", {"depth": np.full((4, 8), 3.0, np.float32)})
    >>> len(uniform_mesh(wall).triangles)
    48
    """
    corners, depth, inside = _sheets(layer)
    wanted = inside if pixels is None else inside & corners.as_sheets(pixels)
    return _mesh(corners, depth, inside, triangulate_pixels(wanted, corners))


def uniform_triangles(layer: Layer) -> int:
    """How many triangles `uniform_mesh` has.

    >>> uniform_triangles(Layer("wall", "equirectangular", {"depth": np.full((4, 8), 3.0, np.float32)}))
    48
    """
    corners, _, inside = _sheets(layer)
    at_poles = np.count_nonzero(inside[:, [0, -1]]) if corners.wraps else 0
    return 2 * np.count_nonzero(inside) - at_poles


def _sheets(layer):
    corners = Corners(layer.mapping, *layer.size)
    inside = layer.mask & np.isfinite(layer.depth)
    return corners, corners.as_sheets(layer.depth), corners.as_sheets(inside)


def _mesh(corners, depth, inside, triangles):
    used = np.zeros(np.prod(corners.shape), dtype=bool)
    used[triangles] = True
    vertices = np.flatnonzero(used)
    index = np.zeros(len(used), dtype=np.int32)
    index[vertices] = np.arange(len(vertices), dtype=np.int32)
    return LayerMesh(corners, vertices, corners.depths(depth, inside, vertices), index[triangles])
