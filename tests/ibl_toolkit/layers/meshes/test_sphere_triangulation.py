"""Delaunay triangulations of the sphere: closed, convex, and walked through."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.meshes.sphere_triangulation import SphereTriangulation


def grown(points, at_once):
    """A triangulation of all the points, added as many at once as lie in different triangles."""
    sphere = SphereTriangulation()
    waiting = points
    while len(waiting):
        some = waiting[:at_once]
        triangles = sphere.locate(some, np.zeros(len(some), dtype=np.int64), sphere.normals())
        first = np.unique(triangles, return_index=True)[1]
        first = first[sphere.insertable(triangles[first], some[first])]
        sphere.insert(triangles[first], some[first])
        waiting = np.delete(waiting, first, axis=0)
    return sphere


def on_sphere(points):
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def lattice():
    """Pixels' middles of an equirectangular map: many on one circle, and on one meridian."""
    longitude, latitude = np.meshgrid(np.arange(24) * np.pi / 12 + 0.1, (np.arange(12) - 5.5) * np.pi / 12)
    across = np.cos(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), np.sin(latitude)], -1).reshape(
        -1, 3
    )


CLOUDS = {
    "at random": on_sphere(np.random.default_rng(1).normal(size=(400, 3))),
    "close together": on_sphere([1.0, 0.9, 0.8] + 1e-2 * np.random.default_rng(2).normal(size=(400, 3))),
    "lattice": lattice(),
    "on the octahedron's edges": on_sphere(
        np.stack([np.linspace(0.01, 2, 50), np.ones(50), np.zeros(50)], axis=1)
    ),
}


@pytest.mark.parametrize("name", CLOUDS)
@pytest.mark.parametrize("at_once", [7, 1000])
def test_it_is_the_convex_hull(name, at_once):
    sphere = grown(CLOUDS[name], at_once)
    assert len(sphere.triangles) == 2 * len(sphere.directions) - 4  # Euler: closed, and one piece
    corners = sphere.directions[sphere.triangles]
    assert (np.linalg.det(corners) > 0).all()
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    heights = normals @ sphere.directions.T - np.einsum("nk,nk->n", normals, corners[:, 0])[:, None]
    assert heights.max() < 1e-14  # no point lies above any triangle


@pytest.mark.parametrize("name", CLOUDS)
def test_twins_are_each_others_reverse(name):
    sphere = grown(CLOUDS[name], 1000)
    edge = np.arange(len(sphere.twins))
    start, end = sphere.triangles.reshape(-1), np.roll(sphere.triangles, -1, axis=1).reshape(-1)
    assert (sphere.twins[sphere.twins] == edge).all()
    assert (start[sphere.twins] == end).all()


def test_points_are_found_from_anywhere():
    sphere = grown(CLOUDS["at random"], 1000)
    normals = sphere.normals()
    points = on_sphere(np.random.default_rng(3).normal(size=(500, 3)))
    for start in (0, len(normals) - 1):
        found = sphere.locate(points, np.full(500, start), normals)
        assert (np.einsum("nij,nj->ni", normals[found], points) > -1e-12).all()


def test_of_points_on_one_edge_one_is_insertable():
    sphere = SphereTriangulation()
    edge = on_sphere(np.array([[3.0, 1, 0], [1, 3, 0], [1, 1, 1]]))
    above, below = 0, 4  # both have the edge from +x to +y
    assert sphere.insertable(np.array([above, below]), edge[:2]).sum() == 1
    assert sphere.insertable(np.array([above, below]), on_sphere(np.array([[1.0, 1, 1], [1, 1, -1]]))).all()


def test_what_was_in_changed_triangles_still_is():
    sphere = grown(CLOUDS["at random"][:100], 1000)
    points = on_sphere(np.random.default_rng(4).normal(size=(300, 3)))
    before = sphere.locate(points, np.zeros(300, dtype=np.int64), sphere.normals())
    new = CLOUDS["at random"][200:201]
    where = sphere.locate(new, np.zeros(1, dtype=np.int64), sphere.normals())
    changed = sphere.insert(where, new)
    after = sphere.locate(points, before, sphere.normals())
    assert (np.isin(before, changed) == np.isin(after, changed)).all()
    assert (before == after)[~np.isin(before, changed)].all()
