"""A mesh of a layer while it grows: its vertices are pixels, and it knows its error at the others."""

import numpy as np

from .parallax import parallax
from .sphere_triangulation import OUTSIDE, SphereTriangulation

_AT_ONCE = 1 << 16  # pixels: what they need stays near the processor


class Lattice:
    """The domain's pixels (n,) in every step-th row and column, the triangle of each, and its error [rad]."""

    def __init__(self, pixels, step, coarser):
        self.step = step
        rows, columns = pixels.lattice(step)
        inside = pixels.inside[np.ix_(rows, columns)]
        self._shape, self._inside = inside.shape, inside
        self.pixels = np.add.outer(rows * pixels.width, columns, dtype=np.int32)[inside]
        self.triangles = np.zeros(len(self.pixels), dtype=np.int32)
        self.errors = np.zeros(len(self.pixels), dtype=np.float32)
        if coarser is not None:
            self.triangles = coarser.spread(rows, columns)[inside]

    def spread(self, rows, columns):
        """Of a finer lattice's rows (n,) and columns (m,): where to look for the triangles of its pixels."""
        image = np.zeros(self._shape, dtype=np.int32)
        image[self._inside] = self.triangles
        rows, columns = (
            np.minimum(k // self.step, n - 1) for k, n in zip((rows, columns), self._shape, strict=True)
        )
        return image[np.ix_(rows, columns)]


class GrowingMesh:
    """A triangulation of the sphere, and how near each vertex is.

    pixels: the layer's, a `MapPixels`. radius: [m] within which errors are seen. near: (V,) [1/m]. is_free:
    (V,) whether a vertex is outside of the domain, so that any nearness is right.
    """

    def __init__(self, pixels, radius):
        self.pixels, self.radius = pixels, radius
        self.sphere = SphereTriangulation()
        first = self.sphere.directions
        here = pixels.nearest(first)
        self.is_free = ~pixels.inside.reshape(-1)[here]
        self.near = np.ones(len(first))
        self.near[~self.is_free] = pixels.near(here[~self.is_free])
        self._is_vertex = np.zeros(
            pixels.inside.size, dtype=bool
        )  # so none is added twice, whatever rounding
        self.normals, self.duals = (np.zeros((0, 3, 3)) for _ in range(2))
        self.planes = np.zeros((0, 3))
        self._prepare(np.arange(len(self.sphere.triangles)))

    def _prepare(self, changed):
        """Of triangles: normals to their edges, the bases dual to their corners, and their planes.

        A plane is the vector whose product with a direction is how near it is there.
        """
        new = len(self.sphere.triangles) - len(self.planes)
        self.normals, self.duals, self.planes = (
            np.concatenate([known, np.empty((new, *known.shape[1:]))])
            for known in (self.normals, self.duals, self.planes)
        )
        corners = self.sphere.directions[self.sphere.triangles[changed]]
        normals = self.normals[changed] = self.sphere.normals(changed)
        self.duals[changed] = normals / np.einsum("nik,nik->ni", corners, normals)[..., None]
        self._put_planes(changed)

    def _put_planes(self, changed):
        near = self.near[self.sphere.triangles[changed]]
        self.planes[changed] = np.einsum("ni,nij->nj", near, self.duals[changed])

    def measure(self, lattice, active):
        """Bring triangles and errors of a lattice's pixels up to date: of those with numbers ``active``."""
        for start in range(0, len(active), _AT_ONCE):
            block = active[start : start + _AT_ONCE]
            pixels = lattice.pixels[block]
            directions = self.pixels.directions(pixels)
            triangles = self.sphere.locate(directions, lattice.triangles[block], self.normals)
            lattice.triangles[block] = triangles
            errors = self._errors(pixels, directions, self.planes.take(triangles, axis=0))
            lattice.errors[block] = np.where(self._is_vertex[pixels], 0, errors)

    def _errors(self, pixels, directions, planes):
        found = np.maximum(np.einsum("...j,...j->...", planes, directions), 0)
        known = self.pixels.near(pixels)
        return np.abs(parallax(found, self.radius) - parallax(known, self.radius))

    def worst_near(self, pixels, triangles, reach):
        """The worst (n,) of the pixels that are near each of (n,) and in the same triangle (n,).

        reach: in rows and columns; a coarse lattice so finds a crease as exactly as a fine one.
        """
        block = max(1, _AT_ONCE // (2 * reach + 1) ** 2)
        starts = range(0, len(pixels), block)
        found = [self._worst_near(pixels[k : k + block], triangles[k : k + block], reach) for k in starts]
        return np.concatenate(found)

    def _worst_near(self, pixels, triangles, reach):
        windows = self.pixels.around(pixels, reach)
        directions = self.pixels.directions(windows.reshape(-1)).reshape(*windows.shape, 3)
        sides = np.einsum("nij,nwj->nwi", self.normals[triangles], directions).min(axis=2)
        there = (sides >= -OUTSIDE) & self.pixels.inside.reshape(-1)[windows]
        there &= ~self._is_vertex[windows]
        there[:, windows.shape[1] // 2] = True  # the pixel itself
        known = np.where(there, windows, pixels[:, None])
        errors = self._errors(known, directions, self.planes[triangles][:, None])
        return windows[np.arange(len(pixels)), np.where(there, errors, -1).argmax(axis=1)]

    def insert(self, triangles, pixels):
        """Add pixels (n,) as vertices where they lie in triangles (n,); the triangles that changed."""
        unique = np.unique(pixels, return_index=True)[1]
        triangles, pixels = triangles[unique], pixels[unique]
        directions = self.pixels.directions(pixels)
        chosen = self.sphere.insertable(triangles, directions)
        changed = self.sphere.insert(triangles[chosen], directions[chosen])
        self._is_vertex[pixels[chosen]] = True
        self.near = np.concatenate([self.near, self.pixels.near(pixels[chosen])])
        self.is_free = np.concatenate([self.is_free, np.zeros(np.count_nonzero(chosen), dtype=bool)])
        self._prepare(changed)
        return changed

    def fit_free(self, lattice):
        """Let the free vertices be as near as suits a lattice's pixels best (least squares).

        Within what the domain has: so no triangle beyond its rim is behind an eye, or at infinity.
        """
        free = np.flatnonzero(self.is_free)
        near = self.pixels.near(lattice.pixels)
        shares, rest = self._told_of(free, lattice, near)
        # Those that no pixel tells of are as near as the domain is in the middle.
        weight = 1e-4 * np.sqrt(len(near))
        shares = np.concatenate([shares, weight * np.eye(len(free))])
        rest = np.concatenate([rest, np.full(len(free), weight * np.median(near))])
        self.near[free] = np.clip(np.linalg.lstsq(shares, rest, rcond=None)[0], near.min() / 2, near.max())
        self._put_planes(np.arange(len(self.planes)))

    def _told_of(self, free, lattice, near):
        """Of the pixels in a free vertex's triangles: what share (n, free) each of these vertices has in how
        near the mesh is there, and what is left (n,) [1/m] for them."""
        number = np.full(len(self.near), -1)
        number[free] = np.arange(len(free))
        here = np.flatnonzero((number[self.sphere.triangles] >= 0).any(axis=1)[lattice.triangles])
        triangles, directions = lattice.triangles[here], self.pixels.directions(lattice.pixels[here])
        corners = self.sphere.triangles[triangles]
        shares = np.einsum("nij,nj->ni", self.duals[triangles], directions)
        is_free = number[corners] >= 0
        row, corner = np.nonzero(is_free)
        of_free = np.zeros((len(here), len(free)))
        of_free[row, number[corners[row, corner]]] = shares[row, corner]
        return of_free, near[here] - np.sum(np.where(is_free, 0, shares * self.near[corners]), axis=1)
