"""Meshes of a stated largest error: they keep it, cover the domain, and take few triangles."""

import numpy as np
import pytest
from box_layers import BOTH, box_depth, box_layer, directions, faces_the_origin, is_closed, layer_of

from expanded_panoramas.ibl_toolkit.layers.meshes.bounded_mesh import bounded_mesh
from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import quadtree_mesh, quadtree_of
from expanded_panoramas.ibl_toolkit.layers.meshes.mesh_error import mesh_error

RADIUS = 1.0
WIDTHS = {"equirectangular": 256, "cube map": 192}


def checked(layer, error_px=0.5, radius=RADIUS):
    """The mesh, once its error at every pixel is found to be what was asked for."""
    mesh = bounded_mesh(layer, radius, error_px=error_px)
    assert np.nanmax(mesh_error(mesh, layer, radius)) <= error_px * (1 + 1e-6)
    assert faces_the_origin(mesh)
    return mesh


@pytest.mark.parametrize("mapping", BOTH)
def test_the_box_room_takes_a_handful_of_triangles(mapping):
    """Its walls are planes: what costs are its edges, from which vertices may be half a pixel away."""
    mesh = checked(box_layer(mapping, WIDTHS[mapping]))
    assert is_closed(mesh)
    assert len(mesh.triangles) < 200
    coarse = checked(box_layer(mapping, WIDTHS[mapping]), error_px=2)
    assert len(coarse.triangles) < 120


def test_large_maps_take_no_more():
    """Here every 16th row and column is looked at first."""
    assert len(checked(box_layer("equirectangular", 1024)).triangles) < 200


def test_a_domain_between_the_rows_that_are_looked_at_first():
    depth = box_depth("equirectangular", 512)
    inside = np.ones(depth.shape, dtype=bool)
    inside[2::4] = False  # of every 4th row the one in the middle
    assert len(checked(layer_of("equirectangular", depth, inside)).triangles) < 400


@pytest.mark.parametrize("mapping", BOTH)
def test_a_picture_on_a_wall_takes_the_triangles_to_begin_with(mapping):
    """Within one of the octahedron's faces: its vertices fit themselves to the picture."""
    ways = directions(mapping, WIDTHS[mapping])
    normal = np.array([0.6, 0.64, 0.48])
    depth = np.where(ways @ normal > 0.9, 2 / (ways @ normal), np.nan).astype(np.float32)
    mesh = checked(layer_of(mapping, depth), error_px=0.01)
    assert len(mesh.triangles) <= 4
    of_its_face = (mesh.points > 0).any(axis=1)
    np.testing.assert_allclose(mesh.points[of_its_face] @ normal, 2, rtol=1e-4)


@pytest.mark.parametrize("mapping", BOTH)
def test_a_smaller_error_takes_more_triangles(mapping):
    ways = directions(mapping, WIDTHS[mapping])
    along = ways @ np.array([0.5, 0.3, 0.2])
    ball = layer_of(
        mapping, (along + np.sqrt(along**2 + 4 - 0.38)).astype(np.float32)
    )  # radius 2, from inside
    counts = [len(checked(ball, error).triangles) for error in (2.0, 0.5, 0.2)]
    assert counts[0] < counts[1] / 2 < counts[2] / 3
    wide = len(checked(ball, radius=0.9).triangles)
    assert len(checked(ball, radius=0.1).triangles) < wide / 4


@pytest.mark.parametrize("mapping", BOTH)
def test_rims_take_no_triangles(mapping):
    """Dust in the box room's domain: the quadtree has to follow it, this mesh has not."""
    dust = np.random.default_rng(5).random(box_depth(mapping, WIDTHS[mapping]).shape) < 0.5
    layer = box_layer(mapping, WIDTHS[mapping], dust)
    assert len(checked(layer).triangles) < 200
    assert len(quadtree_mesh(layer, quadtree_of(layer)).triangles) > 20000


@pytest.mark.parametrize("mapping", BOTH)
def test_domains_over_seam_and_poles_with_holes(mapping):
    """A ring across the seam, a cap at a pole, and two pixels that touch at a corner."""
    ways = directions(mapping, WIDTHS[mapping])
    round_seam = ways @ np.array([-0.9, 0.1, 0.3]) / np.sqrt(0.91)
    inside = ((round_seam > 0.8) & (round_seam < 0.95)) | (ways[..., 2] < -0.9)
    inside[20, 100] = inside[21, 101] = True
    layer = box_layer(mapping, WIDTHS[mapping], inside)
    assert np.isfinite(mesh_error(checked(layer), layer, RADIUS)).sum() == inside.sum()


@pytest.mark.parametrize("mapping", BOTH)
def test_every_pixel_alone(mapping):
    """A layer of one pixel, which may be at the seam, at a pole, or in the corner of a face."""
    depth = box_depth(mapping, {"equirectangular": 12, "cube map": 9}[mapping])
    for row, column in np.ndindex(depth.shape):
        inside = np.zeros(depth.shape, dtype=bool)
        inside[row, column] = True
        mesh = checked(layer_of(mapping, depth, inside), error_px=0.01)
        assert len(mesh.triangles) <= 10


@pytest.mark.parametrize("mapping", BOTH)
def test_infinity_is_left_out(mapping):
    depth = box_depth(mapping, 24)
    depth[depth > 2.5] = np.inf
    checked(layer_of(mapping, depth))
    empty = bounded_mesh(layer_of(mapping, np.full_like(depth, np.inf)), RADIUS)
    assert empty.points.shape == (0, 3)
    assert empty.triangles.shape == (0, 3)


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("share", [0.02, 1.0])
def test_noise_takes_many_triangles_but_keeps_the_error(mapping, share):
    random = np.random.default_rng(7)
    depth = box_depth(mapping, 96)
    depth = (depth * np.exp(random.normal(0, 0.5, depth.shape))).astype(np.float32)
    depth[random.random(depth.shape) < 0.01] = 1e-6  # so near that any rounding shows
    mesh = checked(layer_of(mapping, depth, random.random(depth.shape) < share), error_px=0.01, radius=0.1)
    pixels = share * depth.size
    assert 1.2 * pixels < len(mesh.triangles) < 2.2 * pixels + 8


def test_noise_beyond_the_limit_is_refused():
    depth = np.random.default_rng(8).uniform(2, 3, (64, 128)).astype(np.float32)
    with pytest.raises(
        ValueError, match="layer 'room': its mesh takes more than 1000 triangles to be right within 0"
    ):
        bounded_mesh(layer_of("equirectangular", depth), RADIUS, most_triangles=1000)


@pytest.mark.parametrize("mapping", BOTH)
def test_the_smallest_maps(mapping):
    for width in {"equirectangular": (2, 4, 6), "cube map": (3, 6, 9)}[mapping]:
        checked(box_layer(mapping, width), error_px=1e-4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radius": 1.0, "error_px": 0.0}, "error of 0.0 px must be finite and above 0"),
        ({"radius": 1.0, "error_px": np.nan}, "error of nan px must be finite"),
        ({"radius": -1.0}, "radius -1.0 m must be finite and not below 0"),
    ],
)
def test_impossible_demands_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        bounded_mesh(box_layer("equirectangular", 8), **options)
