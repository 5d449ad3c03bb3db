"""Meshes of layers: closed, sewn at seam, poles and cube edges, facing the origin, and on the surface."""

import cv2
import numpy as np
import pytest
from box_layers import (
    BOTH,
    HALF,
    box_depth,
    box_layer,
    directions,
    edge_counts,
    faces_the_origin,
    is_closed,
    layer_of,
    off_the_walls,
    rim,
    rim_of_pixels,
)

from expanded_panoramas.ibl_toolkit.layers.meshes.corners import Corners
from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import quadtree_mesh, quadtree_of, uniform_mesh
from expanded_panoramas.ibl_toolkit.layers.meshes.normals import normal_variation, normals_from_depth
from expanded_panoramas.ibl_toolkit.layers.meshes.quadtree import build_quadtree
from expanded_panoramas.ibl_toolkit.layers.meshes.subdivision import Subdivision, features_and_residual

SIZES = [("equirectangular", w) for w in (4, 6, 10, 64, 74, 128)] + [
    ("cube map", w) for w in (3, 6, 9, 15, 48, 111, 192)
]


def adaptive_mesh(layer, subdivision=None):
    return quadtree_mesh(layer, quadtree_of(layer, subdivision))


def some_domain(mapping, width):
    """A ring across the seam, a disc that holds a pole, a single pixel, and two joined at a corner."""
    ways = directions(mapping, width)
    inside = ways @ np.array([-0.9, 0.1, 0.3]) > 0.8
    inside &= ways @ np.array([-0.9, 0.1, 0.3]) < 0.93
    inside |= ways[..., 2] < -0.9
    if mapping == "cube map":
        inside[: len(inside) // 4, : len(inside) // 4] = True  # a quarter of a face, on two of its rims
    row, column = inside.shape[0] // 3, inside.shape[1] // 2
    inside[row, column] = True
    inside[row + 3, column] = inside[row + 4, column + 1] = True
    return inside


@pytest.mark.parametrize(("mapping", "width"), SIZES)
@pytest.mark.parametrize("mesh_of", [adaptive_mesh, uniform_mesh])
def test_a_whole_map_is_closed_and_faces_the_origin(mapping, width, mesh_of):
    mesh = mesh_of(box_layer(mapping, width))
    assert is_closed(mesh)
    assert len(mesh.points) - len(edge_counts(mesh.triangles)[0]) + len(mesh.triangles) == 2  # Euler
    if width >= 9:
        assert faces_the_origin(mesh)


@pytest.mark.parametrize(("mapping", "width"), [("equirectangular", 128), ("equirectangular", 74)])
@pytest.mark.parametrize("mesh_of", [adaptive_mesh, uniform_mesh])
def test_the_rim_is_that_of_the_domain_equirectangular(mapping, width, mesh_of):
    refuse_other_rims(mapping, width, mesh_of)


@pytest.mark.parametrize("width", [192, 111])
@pytest.mark.parametrize("mesh_of", [adaptive_mesh, uniform_mesh])
def test_the_rim_is_that_of_the_domain_cube_map(width, mesh_of):
    refuse_other_rims("cube map", width, mesh_of)


def refuse_other_rims(mapping, width, mesh_of):
    """Edges with one triangle are those where the domain ends; on all others two triangles meet."""
    layer = box_layer(mapping, width, some_domain(mapping, width))
    mesh = mesh_of(layer)
    _, forwards, backwards = edge_counts(mesh.triangles)
    assert forwards.max() == 1
    assert backwards.max() == 1
    expected = rim_of_pixels(mesh.corners, mesh.corners.as_sheets(layer.mask))
    found = rim(mesh)
    assert sorted(map(tuple, found)) == sorted(map(tuple, expected))
    assert faces_the_origin(mesh)
    assert np.isfinite(mesh.points).all()


@pytest.mark.parametrize("mapping", BOTH)
def test_a_domain_without_pixels_is_a_mesh_without_triangles(mapping):
    layer = layer_of(mapping, np.full(box_depth(mapping, 24).shape, np.inf, np.float32))
    for mesh_of in (adaptive_mesh, uniform_mesh):
        mesh = mesh_of(layer)
        assert mesh.points.shape == (0, 3)
        assert mesh.triangles.shape == (0, 3)


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("mesh_of", [adaptive_mesh, uniform_mesh])
def test_a_single_pixel_is_a_patch_at_its_depth(mapping, mesh_of):
    depth = box_depth(mapping, 24)
    inside = np.zeros(depth.shape, dtype=bool)
    inside[5, 5] = True
    mesh = mesh_of(layer_of(mapping, depth, inside))
    assert mesh.triangles.shape == (2, 3)
    spread = {"equirectangular": 1e-6, "cube map": 0.1}[mapping]  # on a face it is flat, one of 8 x 8 px
    assert np.allclose(np.linalg.norm(mesh.points, axis=1), depth[5, 5], rtol=spread)


@pytest.mark.parametrize("rows", [slice(0, 1), slice(-1, None)])
def test_a_ring_of_pixels_at_a_pole_is_a_fan(rows):
    depth = box_depth("equirectangular", 24)
    inside = np.zeros(depth.shape, dtype=bool)
    inside[rows] = True
    for mesh_of in (adaptive_mesh, uniform_mesh):
        mesh = mesh_of(layer_of("equirectangular", depth, inside))
        assert mesh.triangles.shape == (24, 3)
        assert len(rim(mesh)) == 24
        assert np.abs(mesh.points[:, :2]).sum(axis=1).min() < 1e-9


def test_uniform_meshes_have_as_many_triangles_as_the_thesis_says():
    """2048 x 1024 px: 4190208 (section 7.4.3); here an eighth of the width."""
    assert len(uniform_mesh(box_layer("equirectangular", 256)).triangles) == 2 * 256 * 128 - 2 * 256
    assert len(uniform_mesh(box_layer("cube map", 96)).triangles) == 2 * 96 * 64


@pytest.mark.parametrize("mapping", BOTH)
def test_error_against_triangles_in_the_room(mapping):
    """Off the walls, in units of depth, in the middles of the triangles, weighted by the angle they take."""
    width = {"equirectangular": 512, "cube map": 384}[mapping]
    layer = box_layer(mapping, width)
    uniform, adaptive = uniform_mesh(layer), adaptive_mesh(layer)
    assert len(adaptive.triangles) < 0.12 * len(uniform.triangles)
    assert mean_error(adaptive) < mean_error(uniform) + 1e-5
    assert off_the_walls(adaptive.points).max() < 2 * np.pi / 512  # a pixel, at the room's edges
    assert np.median(off_the_walls(adaptive.points)) < 5e-5
    fine = box_layer(mapping, 2 * width)
    finer = adaptive_mesh(fine)
    assert len(finer.triangles) < 2.5 * len(adaptive.triangles)  # edges, not areas, cost triangles
    assert mean_error(finer) < 0.35 * mean_error(adaptive)


def test_corners_of_walls_lie_on_them():
    """Away from the room's edges; on a cube's face exactly, and at the rim of a domain as well as inside."""
    for mapping, width, tolerance in (("cube map", 192, 1e-6), ("equirectangular", 256, 5e-4)):
        points = directions(mapping, width) * box_depth(mapping, width)[..., None]
        share = np.sort(np.abs(points) / HALF, axis=2)
        mesh = uniform_mesh(box_layer(mapping, width, share[..., 1] < 0.9))
        assert len(rim(mesh)) > width
        assert off_the_walls(mesh.points).max() < tolerance


def mean_error(mesh):
    a, b, c = mesh.points[mesh.triangles.T]
    middles = (a + b + c) / 3
    angles = np.linalg.norm(np.cross(b - a, c - a), axis=1) / np.linalg.norm(middles, axis=1) ** 2
    return np.average(off_the_walls(middles), weights=angles)


@pytest.mark.parametrize("mapping", BOTH)
def test_a_ball_takes_more_triangles_for_a_smaller_turn(mapping):
    """From beside its middle, so that the surface is a curved one in the picture."""
    ways = directions(mapping, 384)
    along = ways @ np.array([0.5, 0.3, 0.2])
    depth = (along + np.sqrt(along**2 + 4 - 0.38)).astype(np.float32)  # radius 2
    layer = layer_of(mapping, depth)
    counts, errors = [], []
    for turn_deg in (20, 10, 5):
        mesh = adaptive_mesh(layer, Subdivision(turn_deg=turn_deg))
        assert is_closed(mesh)
        middles = mesh.points[mesh.triangles].mean(axis=1)
        errors.append(np.abs(np.linalg.norm(middles - [0.5, 0.3, 0.2], axis=1) / 2 - 1).max())
        counts.append(len(mesh.triangles))
    assert counts[0] < counts[1] < counts[2]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 1 - np.cos(np.radians(5))


def test_a_hole_in_the_room_keeps_its_shape():
    """The mesh of a disc at constant depth has the disc's solid angle, up to its rim of pixels."""
    inside = np.zeros((128, 256), np.uint8)
    cv2.circle(inside, (128, 64), 40, 1, -1)
    mesh = adaptive_mesh(layer_of("equirectangular", np.full(inside.shape, 2.0, np.float32), inside > 0))
    assert np.allclose(mesh.depths, 2, rtol=1e-6)
    assert len(mesh.triangles) < inside.sum()


def test_trees_of_other_layers_are_refused():
    layer = box_layer("equirectangular", 64)
    with pytest.raises(ValueError, match="of 1 sheets of 32 x 16 px, layer 'room' has 1 of 64 x 32 px"):
        quadtree_mesh(layer, quadtree_of(box_layer("equirectangular", 32)))
    inside = np.zeros((32, 64), dtype=bool)
    inside[:7] = True
    tree = build_quadtree(1, 64, 32, lambda cells: cells.area > 32)
    with pytest.raises(ValueError, match="8 leaves of the quadtree cross the rim of layer 'room'"):
        quadtree_mesh(box_layer("equirectangular", 64, inside), tree)
    strips = build_quadtree(1, 6, 3, lambda cells: cells.area > 3)
    with pytest.raises(ValueError, match="cells are one pixel wide or high and have finer neighbours"):
        quadtree_mesh(box_layer("equirectangular", 6), strips)


def test_a_map_too_small_for_triangles_is_refused():
    with pytest.raises(ValueError, match="2 x 1 px is too small for a mesh"):
        uniform_mesh(layer_of("equirectangular", np.ones((1, 2), np.float32)))


def test_the_mean_of_alg_16_cannot_tell_how_large_a_cell_is():
    """The inside of a ball bends alike everywhere: means of cells are alike, their sums are not."""
    corners, inside = Corners("cube map", 192, 128), np.ones((6, 64, 64), bool)
    normals = normals_from_depth(corners, np.full(inside.shape, 2, np.float32), inside)
    _, residual = features_and_residual(normal_variation(corners, normals, inside), 10)
    cells = [residual[0, 32 : 32 + n, 32 : 32 + n] for n in (4, 8, 16)]
    means, sums = ([fold(cell) for cell in cells] for fold in (np.mean, np.sum))
    assert max(means) < 1.3 * min(means)
    assert max(sums) > 10 * min(sums)


def test_cells_are_no_larger_than_22_5_degrees():
    for mapping, width, most in (("cube map", 96, 8), ("equirectangular", 128, 8)):
        leaves = quadtree_of(box_layer(mapping, width)).leaves()
        assert (leaves.x1 - leaves.x0).max() == most


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 1.0])
def test_domains_and_depths_at_random(mapping, share):
    """Sizes of any kind, pixels at infinity, noise: nothing but the domain's rim has one triangle."""
    random = np.random.default_rng(int(10 * share))
    for width in random.integers(3, 30, 6) * {"equirectangular": 2, "cube map": 3}[mapping]:
        depth = box_depth(mapping, width)
        depth = (depth * np.exp(random.normal(0, 0.3, depth.shape))).astype(np.float32)
        depth[random.random(depth.shape) < 0.05] = np.inf
        layer = layer_of(mapping, depth, random.random(depth.shape) < share)
        smooth = Subdivision(feature_deg=180, turn_deg=180)
        for mesh in (uniform_mesh(layer), adaptive_mesh(layer), adaptive_mesh(layer, smooth)):
            inside = mesh.corners.as_sheets(layer.mask & np.isfinite(depth))
            assert sorted(map(tuple, rim(mesh))) == sorted(map(tuple, rim_of_pixels(mesh.corners, inside)))
            assert np.isfinite(mesh.points).all()
