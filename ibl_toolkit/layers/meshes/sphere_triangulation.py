"""Delaunay triangulations of points on the sphere, to which many points are added at once.

They are the convex hulls of their points, so the sphere needs no seam and no poles. Points are put into the
triangles in which they lie, then edges are flipped until no point lies above the plane of a neighbouring
triangle (Lawson); many flips at once, of which no two share a triangle. A flip is sound here because every
triangle is counter-clockwise as seen from outside: then its circle is smaller than a hemisphere, and a point
that lies in it beyond an edge makes a convex quadrilateral with the triangle.

Half-edge 3t + k leads from corner k of triangle t to the next; its twin is the same edge of the neighbour.
"""

import numpy as np

# Differences of unit vectors have the rounding of 1.0, so a volume errs by as much times two lengths.
_ROUNDING = 1e-15
_OCTAHEDRON = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], dtype=np.float64
)
_ITS_FACES = np.array(
    [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]], dtype=np.int64
)
_ON_EDGE = 1e-8  # [rad] so near to an edge a point is said to lie on it

OUTSIDE = 1e-12
"""[rad] So little outside a point is said to lie in a triangle: the rounding of edges of 1e-4 or more."""


class SphereTriangulation:
    """Triangles over the whole sphere, at first those of the octahedron of the axes.

    directions: (V, 3) unit vectors. triangles: (T, 3) int64 indices into them, counter-clockwise as seen from
    outside. twins: (3 T,) int64. Points and triangles keep their numbers for good, not their corners.

    >>> sphere = SphereTriangulation()
    >>> changed = sphere.insert(np.array([0]), np.array([[0.6, 0.64, 0.48]]))
    >>> len(sphere.triangles), changed.tolist()
    (10, [0, 8, 9])
    """

    def __init__(self):
        self.directions, self.triangles = _OCTAHEDRON.copy(), _ITS_FACES.copy()
        ends = np.stack([self.triangles, np.roll(self.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
        self.twins = np.argmax((ends[:, None] == ends[:, ::-1]).all(axis=2), axis=1)

    def normals(self, triangles=slice(None)):
        """Unit normals (n, 3, 3), inwards, of the planes through the origin and the edges of triangles (n,).

        Row k belongs to the edge opposite to corner k.
        """
        return _normals(self.directions[self.triangles[triangles]])

    def locate(self, points, triangles, normals):
        """Triangles (n,) in which points (n, 3) lie, found by walking from ``triangles`` (n,).

        normals: what `normals` gives. The walk ends, since it only goes down to lower planes of the hull.
        """
        triangles = triangles.copy()
        walking, here = None, triangles  # None: all points; most are where they were, so they aren't copied
        while walking is None or len(walking):
            there = points if walking is None else points[walking]
            sides = np.einsum("nij,nj->ni", normals.take(here, axis=0), there)
            a, b, c = sides.T
            outside = np.flatnonzero(np.minimum(np.minimum(a, b), c) < -OUTSIDE)
            walking = outside if walking is None else walking[outside]
            corner = sides[outside].argmin(axis=1)
            here = self.twins[3 * here[outside] + (corner + 1) % 3] // 3
            triangles[walking] = here
        return triangles

    def insertable(self, triangles, points):
        """Boolean (n,): which of these points can be inserted together, at most one a triangle.

        Of points on an edge only one can be, or triangles without area might lie over one another.
        """
        normals = self.normals(triangles)
        sides = np.einsum("nij,nj->ni", normals, points)
        corner = sides.argmin(axis=1)
        edge = 3 * triangles + (corner + 1) % 3
        edge = np.minimum(edge, self.twins[edge])
        alone = sides[np.arange(len(corner)), corner] > _ON_EDGE
        edge[alone] = -1 - np.flatnonzero(alone)
        chosen = np.zeros(len(points), dtype=bool)
        chosen[np.unique(edge, return_index=True)[1]] = True
        return chosen

    def insert(self, triangles, points):
        """Add points (n, 3) that lie in triangles (n,), all different; numbers of the triangles that changed.

        What was in a triangle that changed is now in one of those, so they cover the same directions.
        """
        count, new = len(self.triangles), len(self.directions) + np.arange(len(points))
        second = count + np.arange(len(points))
        third = second + len(points)
        a, b, c = self.triangles[triangles].T
        moved = np.arange(3 * count)
        moved[3 * triangles + 1], moved[3 * triangles + 2] = 3 * second, 3 * third
        twins = np.empty(3 * (count + 2 * len(points)), dtype=np.int64)
        twins[moved] = moved[self.twins]
        for one, next_one in ((triangles, second), (second, third), (third, triangles)):
            twins[3 * one + 1], twins[3 * next_one + 2] = 3 * next_one + 2, 3 * one + 1
        self.directions = np.concatenate([self.directions, points])
        self.triangles = np.concatenate(
            [self.triangles, np.stack([b, c, new], axis=1), np.stack([c, a, new], axis=1)]
        )
        self.triangles[triangles, 2] = new
        self.twins = twins
        return self._flip_to_delaunay(np.concatenate([triangles, second, third]))

    def _flip_to_delaunay(self, changed):
        has_changed = np.zeros(len(self.triangles), dtype=bool)
        has_changed[changed] = True
        while len(changed):
            edges = (3 * changed[:, None] + np.arange(3)).reshape(-1)
            edges = np.unique(np.minimum(edges, self.twins[edges]))
            edges = edges[self._is_too_low(edges)]
            changed = np.unique(np.concatenate([edges // 3, self.twins[edges] // 3]))
            has_changed[changed] = True
            self._flip(self._apart(edges))
        return np.flatnonzero(has_changed)

    def _is_too_low(self, edges):
        """Whether the neighbour's corner lies above a triangle's plane, (n,)."""
        corners, twins = self.triangles.reshape(-1), self.twins[edges]
        a, b, c, d = (
            self.directions[corners[k]]
            for k in (edges, _next(edges), _next(_next(edges)), _next(_next(twins)))
        )
        sides = np.stack([b - a, c - a, d - a], axis=1)
        return np.linalg.det(sides) > _ROUNDING * np.sum(sides**2, axis=(1, 2))

    def _apart(self, edges):
        """Those of the edges that are the last to name both of their triangles: no two share one."""
        owner = np.empty(len(self.triangles), dtype=np.int64)
        number = np.arange(len(edges))
        both = np.stack([edges, self.twins[edges]], axis=1) // 3
        owner[both.reshape(-1)] = np.repeat(number, 2)
        return edges[(owner[both] == number[:, None]).all(axis=1)]

    def _flip(self, edges):
        """Turn edges a-b between the triangles abc and bad into c-d; no two of them in one triangle."""
        corners, twins = self.triangles.reshape(-1), self.twins[edges]
        one, other = edges // 3, twins // 3
        before, after = _next(_next(edges)), _next(edges)
        beyond_after, beyond_before = _next(twins), _next(_next(twins))
        a, b, c, d = corners[edges], corners[twins], corners[before], corners[beyond_before]
        moved = np.arange(3 * len(self.triangles))
        outer = np.concatenate([before, beyond_after, beyond_before, after])
        moved[outer] = np.concatenate([3 * one, 3 * one + 1, 3 * other, 3 * other + 1])
        here, there = moved[outer], moved[self.twins[outer]]
        self.triangles[one] = np.stack([c, a, d], axis=1)
        self.triangles[other] = np.stack([d, b, c], axis=1)
        self.twins[here], self.twins[there] = there, here
        self.twins[3 * one + 2], self.twins[3 * other + 2] = 3 * other + 2, 3 * one + 2


def _normals(corners):
    normals = np.cross(np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1))
    return normals / np.linalg.norm(normals, axis=2, keepdims=True)


def _next(edges):
    return edges - edges % 3 + (edges + 1) % 3
