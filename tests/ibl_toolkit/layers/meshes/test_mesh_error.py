"""The error of meshes that are off by a known amount."""

from dataclasses import replace

import numpy as np
import pytest
from box_layers import BOTH, box_layer, layer_of

from expanded_panoramas.ibl_toolkit.layers.meshes.bounded_mesh import BoundedMesh
from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import quadtree_mesh, quadtree_of, uniform_mesh
from expanded_panoramas.ibl_toolkit.layers.meshes.mesh_error import mesh_error
from expanded_panoramas.ibl_toolkit.layers.meshes.parallax import parallax, pixel_angle

WIDTHS = {"equirectangular": 128, "cube map": 96}


def box_mesh():
    """The walls of the box room as they are, two triangles each."""
    corners = np.array([[x, y, z] for x in (-2.0, 2.0) for y in (-3.0, 3.0) for z in (-1.5, 1.5)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])
    depths = np.linalg.norm(corners, axis=1)
    return BoundedMesh(corners / depths[:, None], depths, triangles)


@pytest.mark.parametrize("mapping", BOTH)
def test_the_room_itself_has_none(mapping):
    layer = box_layer(mapping, WIDTHS[mapping])
    assert mesh_error(box_mesh(), layer, 1.0).max() < 1e-4  # depths are 32-bit
    turned = replace(box_mesh(), triangles=box_mesh().triangles[:, ::-1])
    assert mesh_error(turned, layer, 1.0).max() < 1e-4


@pytest.mark.parametrize("mapping", BOTH)
def test_a_room_made_larger_is_off_as_far_as_it_should(mapping):
    layer = box_layer(mapping, WIDTHS[mapping])
    larger = replace(box_mesh(), depths=box_mesh().depths * 1.05)
    near = 1 / layer.depth.astype(float)
    expected = (parallax(near, 1.0) - parallax(near / 1.05, 1.0)) / pixel_angle(layer)
    np.testing.assert_allclose(mesh_error(larger, layer, 1.0), expected, rtol=1e-4)


@pytest.mark.parametrize("mapping", BOTH)
def test_what_is_missing_is_infinitely_wrong(mapping):
    layer = box_layer(mapping, WIDTHS[mapping])
    ceiling = box_mesh().points[box_mesh().triangles][:, :, 2].min(axis=1) > 1
    errors = mesh_error(replace(box_mesh(), triangles=box_mesh().triangles[~ceiling]), layer, 1.0)
    assert 0.05 < np.isinf(errors).mean() < 0.4
    assert np.isinf(errors[0]).any()
    none = replace(box_mesh(), triangles=np.zeros((0, 3), int))
    assert np.isinf(mesh_error(none, layer, 1.0)).all()


@pytest.mark.parametrize("mapping", BOTH)
def test_beyond_the_domain_and_at_infinity_there_is_none(mapping):
    depth = box_layer(mapping, WIDTHS[mapping]).depth.copy()
    depth[0], depth[5] = np.nan, np.inf
    errors = mesh_error(box_mesh(), layer_of(mapping, depth), 1.0)
    assert (np.isnan(errors) == ~np.isfinite(depth)).all()


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("mesh_of", [uniform_mesh, lambda layer: quadtree_mesh(layer, quadtree_of(layer))])
def test_meshes_of_pixels_cover_every_pixel(mapping, mesh_of):
    layer = box_layer(mapping, WIDTHS[mapping])
    errors = mesh_error(mesh_of(layer), layer, 1.0)
    assert errors.max() < 0.5
    assert np.median(errors) < 0.01
