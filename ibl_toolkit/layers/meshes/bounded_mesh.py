"""Meshes of layers with a stated largest error: in pixels of parallax, from anywhere within the radius.

Vertices are put where the mesh errs most, until it errs nowhere by more (greedy insertion). In between the
depth is that of the triangles' planes; of a plane the reciprocal depth is linear in the direction, so walls
need no vertices but where they meet. The mesh is a Delaunay triangulation of the sphere, so it closes round
the seam, over the poles and over the cube's edges. Beyond the rim of the domain it goes on as it likes: the
layer's mask cuts it when it is drawn, by direction from the origin. So a rim, however ragged, takes none.

Source: ours, beside thesis, section 7.4.2; greedy insertion after Garland and Heckbert, "Fast polygonal
approximation of terrains and height fields" (1995).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..panorama import Layer
from .growing_mesh import GrowingMesh, Lattice
from .map_pixels import MapPixels
from .parallax import pixel_angle

_STEPS = (16, 4, 1)  # of the lattices of pixels that are looked at, one after the other
_FEWEST = 2000  # pixels of the domain in a lattice, or it is skipped
_WORST = 0.5  # at first vertices are inserted where the error is above this share of the largest one
_MOST = 2_000_000


@dataclass(frozen=True, eq=False)
class BoundedMesh:
    """A mesh that covers the domain of a layer, and goes beyond it.

    directions: (V, 3) unit vectors, panorama frame. depths: (V,) [m] along them. triangles: (T, 3) int32
    indices, counter-clockwise as seen from the panorama's origin.
    """

    directions: np.ndarray
    depths: np.ndarray
    triangles: np.ndarray

    @property
    def points(self) -> np.ndarray:
        """(V, 3) [m] from the panorama's origin, in its frame."""
        return self.directions * self.depths[:, None]


def bounded_mesh(
    layer: Layer, radius: float, *, error_px: float = 0.5, most_triangles: int = _MOST
) -> BoundedMesh:
    """The mesh that is nowhere off by more than ``error_px``, seen from anywhere within ``radius`` [m].

    A pixel is the layer's own, see `pixel_angle`; what counts are the layer's depths in the middles of its
    pixels, and the largest angle at which an eye can see such a point and the mesh apart, see `parallax`.
    What lies at infinity is left out.

    Raises: ValueError for an error that is not above 0, a radius below 0, either not finite, and where the
    mesh would take more than ``most_triangles``, as that of noise does.

    >>> wall = Layer("wall", "equirectangular", {"depth": np.full((4, 8), 3.0, np.float32)})
    >>> len(bounded_mesh(wall, 0.1).triangles)
    8
    """
    if not (np.isfinite(error_px) and error_px > 0):
        raise ValueError(f"error of {error_px} px must be finite and above 0")
    if not (np.isfinite(radius) and radius >= 0):
        raise ValueError(f"radius {radius} m must be finite and not below 0")
    pixels = MapPixels(layer)
    if not pixels.inside.any():
        return BoundedMesh(np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3), dtype=np.int32))
    mesh = GrowingMesh(pixels, radius)
    lattice = None
    for step in _STEPS:
        finer = Lattice(pixels, step, lattice)
        if step > 1 and len(finer.pixels) < _FEWEST:
            continue
        is_first, lattice = lattice is None, finer
        for triangles in _refined(mesh, lattice, error_px * pixel_angle(layer), is_first):
            if triangles > most_triangles:
                raise ValueError(
                    f"{layer}: its mesh takes more than {most_triangles} triangles to be right "
                    f"within {error_px} px: allow more of them, or a larger error"
                )
    return _over_domain(mesh, lattice)


def _refined(mesh, lattice, tolerance, is_first):
    """Insert vertices until no pixel of the lattice errs by more [rad]; yields the number of triangles."""
    active = np.arange(len(lattice.pixels))
    while True:
        mesh.measure(lattice, active)
        if is_first and mesh.is_free.any():
            mesh.fit_free(lattice)
            mesh.measure(lattice, np.arange(len(lattice.pixels)))
        over = np.flatnonzero(lattice.errors > tolerance)
        if not len(over):
            return
        worst = _worst_of_each(over, lattice, _WORST if is_first else 0)
        triangles = lattice.triangles[worst]
        changed = mesh.insert(triangles, mesh.worst_near(lattice.pixels[worst], triangles, lattice.step // 2))
        yield len(mesh.sphere.triangles)
        has_changed = np.zeros(len(mesh.sphere.triangles), dtype=bool)
        has_changed[changed] = True
        active = np.flatnonzero(has_changed[lattice.triangles])


def _worst_of_each(over, lattice, share):
    """Of the lattice's pixels ``over`` (n,) the worst of each triangle, if above a share of the worst."""
    errors = lattice.errors[over]
    order = np.lexsort((errors, lattice.triangles[over]))
    triangles = lattice.triangles[over[order]]
    last = np.append(triangles[1:] != triangles[:-1], True)
    return over[order[last & (errors[order] >= share * errors.max())]]


def _over_domain(mesh, lattice):
    """The triangles that a pixel of the domain may see a part of.

    Those in which its middle lies, and those with a corner in the domain, or beside one of the former:
    however thin they are, parts of pixels lie there.
    """
    sphere = mesh.sphere
    used = np.zeros(len(sphere.triangles), dtype=bool)
    used[lattice.triangles] = True
    used |= used[sphere.twins.reshape(-1, 3) // 3].any(axis=1)
    used |= ~mesh.is_free[sphere.triangles].all(axis=1)
    vertices, corners = np.unique(sphere.triangles[used][:, ::-1], return_inverse=True)
    triangles = corners.reshape(-1, 3).astype(np.int32)
    return BoundedMesh(sphere.directions[vertices], 1 / mesh.near[vertices], triangles)
