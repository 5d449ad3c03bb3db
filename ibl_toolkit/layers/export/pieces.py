"""What is exported of a layered panorama: meshes with texture coordinates, in the panorama's frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..making.continuous_pieces import mesh_pieces, with_hidden_rim
from ..meshes.bounded_mesh import bounded_mesh
from ..meshes.layer_mesh import quadtree_mesh, quadtree_of, uniform_mesh
from ..meshes.parallax import pixel_angle
from ..panorama import Layer, LayeredPanorama
from ..views.rendered_view import sampled
from .refinement import refined
from .texture import Texture, texture_of
from .texture_coordinates import shared_vertices

MESHES: dict[str, Callable] = {
    "mesh": bounded_mesh,
    "quadtree": lambda layer, radius: quadtree_mesh(layer, quadtree_of(layer)),
    "grid": lambda layer, radius: uniform_mesh(layer),
}
"""Surfaces of a layer by their names, for panoramas that are looked at within a radius [m]."""

TEXTURE_ERROR_PX = 0.5
AT_INFINITY = " at infinity"
_FAR_TIMES = 10  # as far as the farthest surface: behind all of them, however one looks
_LEAST_FAR = 10.0  # [m]
# Of triangles, where it is asked whether they keep to the domain: the middle, and places towards the corners.
_PLACES = np.array([[1, 1, 1], [3, 1, 1], [1, 3, 1], [1, 1, 3]]) / np.array([[3], [5], [5], [5]])


@dataclass(frozen=True, eq=False)
class Piece:
    """One mesh with one texture.

    points: (n, 3) float32 [m] from the panorama's origin, in its frame. uv: (n, 2) float32, v from the top.
    triangles: (T, 3) uint32, counter-clockwise as the origin sees them. masked: whether the mesh goes beyond
    the domain, so that the texture's alpha must cut it. two_sided: whether it can be seen from behind, as all
    can that aren't closed.
    """

    name: str
    points: np.ndarray
    uv: np.ndarray
    triangles: np.ndarray
    texture: Texture
    masked: bool
    two_sided: bool


def pieces_of(
    panorama: LayeredPanorama,
    exposure: float,
    mesh_of: Callable = MESHES["quadtree"],
    far: float | None = None,
    texture_error_px: float = TEXTURE_ERROR_PX,
) -> list[Piece]:
    """A piece for each of `mesh_parts`.

    mesh_of: gives a mesh (its `points` and `triangles`) over the domain of a layer, for a radius [m]. What
    lies at infinity becomes a sphere of the radius `far` [m], `far_radius` if None.

    Raises: ValueError for a layer without radiance, a `far` nearer than a surface, and a texture error not
    above 0.
    """
    far = checked_far(panorama, far)
    pieces = []
    for layer in panorama.layers:
        texture = texture_of(layer, exposure)
        for part in mesh_parts(panorama, layer, far):
            mesh = mesh_of(part, shape_radius(panorama))
            pieces.append(_piece(part, mesh, texture, texture_error_px))
    return pieces


def shape_radius(panorama: LayeredPanorama) -> float:
    """How far from the origin the meshes' shape is to be right [m]: within the panorama's radius.

    Where that is 0 any shape would do, as seen from the origin. Other programs look from elsewhere: half of
    what is nearest is taken.
    """
    if panorama.radius > 0:
        return panorama.radius
    finite = [layer.depth[layer.mask & np.isfinite(layer.depth)] for layer in panorama.layers]
    return float(min((depth.min() for depth in finite if depth.size), default=0.0)) / 2


def parts_of(layer: Layer, far: float) -> list[Layer]:
    """The layer's domain at a finite depth, and the one at infinity with the depth `far` [m], if any."""
    at_infinity = layer.mask & np.isposinf(layer.depth)
    rest, parts = layer.mask & ~at_infinity, []
    if rest.any():
        parts.append(Layer(layer.name, layer.mapping, {"depth": layer.depth, "mask": rest}))
    if at_infinity.any():
        name = layer.name + AT_INFINITY if rest.any() else layer.name
        depth = np.full(layer.depth.shape, far, dtype=np.float32)
        parts.append(Layer(name, layer.mapping, {"depth": depth, "mask": at_infinity}))
    return parts


def mesh_parts(panorama: LayeredPanorama, layer: Layer, far: float) -> list[Layer]:
    """What of a layer one mesh shall be of: its `parts_of`, taken apart where their depth jumps.

    So no mesh joins what is seen apart from within `shape_radius`. Each goes on a little behind the others.
    """
    radius, found = shape_radius(panorama), []
    for part in parts_of(layer, far):
        pieces = mesh_pieces(part, radius)
        found += pieces if len(pieces) == 1 else [with_hidden_rim(piece, part, radius) for piece in pieces]
    return found


def far_radius(panorama: LayeredPanorama) -> float:
    """Of the sphere that stands for infinity [m].

    So large that within the panorama's radius it moves by less than a pixel against infinity (6.2.4), ten
    times the farthest surface, and 10 m, whichever is most.
    """
    smallest_pixel = min(map(pixel_angle, panorama.layers))
    return max(panorama.radius / smallest_pixel, _FAR_TIMES * _farthest(panorama), _LEAST_FAR)


def checked_far(panorama: LayeredPanorama, far: float | None) -> float:
    """`far` [m], or `far_radius` if it is None; ValueError unless it is finite and behind all surfaces."""
    if far is None:
        return far_radius(panorama)
    farthest = _farthest(panorama)
    if not (np.isfinite(far) and far > farthest):
        raise ValueError(f"far {far} m must be finite and beyond the farthest surface, {farthest:.3f} m")
    return far


def leaves_domain(part: Layer, corners: np.ndarray) -> bool:
    """Whether triangles with corners (T, 3, 3), panorama frame, show something outside of the domain."""
    directions = np.einsum("pc,tck->tpk", _PLACES, corners)
    return bool((sampled(part, part.mask.astype(np.float32), directions) <= 0).any())


def _farthest(panorama):
    finite = (layer.depth[layer.mask & np.isfinite(layer.depth)] for layer in panorama.layers)
    return float(max((depth.max() for depth in finite if depth.size), default=0.0))


def _piece(part, mesh, texture, error_px):
    points, triangles = refined(mesh.points, mesh.triangles.astype(np.int64), texture.chart, error_px)
    uv = texture.chart.uv(points[triangles])
    masked = leaves_domain(part, points[triangles])
    if masked:
        texture = texture.cut_to(part)
        seen = texture.is_seen_on(uv)
        triangles, uv = triangles[seen], uv[seen]
    point, uv, shared = shared_vertices(triangles, uv)
    return Piece(
        part.name,
        points[point].astype(np.float32),
        uv.astype(np.float32),
        shared.astype(np.uint32),
        texture,
        masked,
        two_sided=not part.mask.all(),
    )
