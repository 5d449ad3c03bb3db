"""Textured meshes of layers: coordinates over seam, poles and cube edges; cut until the texture fits."""

import numpy as np
import pytest
from box_layers import BOTH, HALF, directions, is_closed
from layered_box import layered_box, radiance_in

from expanded_panoramas.ibl_toolkit.images.png import linear_from_srgb
from expanded_panoramas.ibl_toolkit.layers.export.pieces import MESHES, far_radius, pieces_of, shape_radius
from expanded_panoramas.ibl_toolkit.layers.export.ply import points_of_piece
from expanded_panoramas.ibl_toolkit.layers.export.texture_coordinates import CubeChart, EquirectangularChart
from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import LayerMesh
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

ERROR_PX = 0.5
INSIDE_PX = 2 * ERROR_PX  # the middles of sides are held to ERROR_PX; within a triangle all three add up
WITHIN = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [3, 3, 0], [0, 3, 3], [3, 0, 3]])
WITHIN = WITHIN / WITHIN.sum(axis=1, keepdims=True)


def texture_errors(piece):
    """By how many pixels the texture is off within triangles (T, P)."""
    shown = piece.texture.chart.direction(np.einsum("pc,tck->tpk", WITHIN, piece.uv[piece.triangles]))
    points = np.einsum("pc,tck->tpk", WITHIN, piece.points[piece.triangles].astype(float))
    right = points / np.linalg.norm(points, axis=2, keepdims=True)
    return np.linalg.norm(shown - right, axis=2) * piece.texture.chart.pixels_per_radian


def welded(piece):
    """The piece's triangles with one index a point, as `is_closed` wants them."""
    _, which = np.unique(piece.points, axis=0, return_inverse=True)

    class Mesh:
        triangles = which.reshape(-1)[piece.triangles]

    return Mesh


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("mapping", BOTH)
def test_the_texture_fits_everywhere(mapping, mesh):
    panorama = layered_box(mapping, 48 if mapping == "cube map" else 64)
    for piece in pieces_of(panorama, 1.0, MESHES[mesh], texture_error_px=ERROR_PX):
        assert texture_errors(piece).max() < INSIDE_PX


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("mapping", BOTH)
def test_every_pixel_of_the_domain_is_on_a_triangle(mapping, mesh):
    panorama = layered_box(mapping, 48 if mapping == "cube map" else 64)
    room, objects = panorama.layers
    open_room = np.isinf(room.depth)
    pieces = pieces_of(panorama, 1.0, MESHES[mesh])
    for piece, inside in zip(pieces, (~open_room, open_room, objects.mask), strict=True):
        towards = directions(mapping, inside.shape[1])[inside]
        corners = piece.points[piece.triangles].astype(float)
        # Counter-clockwise as the origin sees them: a direction within is on one side of all three planes.
        sides = np.stack([np.cross(corners[:, k], corners[:, k - 2]) for k in range(3)], axis=1)
        sides /= np.linalg.norm(sides, axis=2, keepdims=True)
        within = (np.einsum("nk,tsk->nts", towards, sides) <= 1e-6).all(axis=2)
        assert within.any(axis=1).all()


def test_without_cutting_it_does_not_fit():
    panorama = layered_box(width=512, names=("walls",))
    coarse, fine = (pieces_of(panorama, 1.0, texture_error_px=error)[0] for error in (1e9, ERROR_PX))
    assert texture_errors(coarse).max() > 1.5 * INSIDE_PX
    assert texture_errors(fine).max() < INSIDE_PX
    assert len(coarse.triangles) < len(fine.triangles) < 1.2 * len(coarse.triangles)


@pytest.mark.parametrize("mapping", BOTH)
def test_large_triangles_over_faces_and_poles(mapping):
    """Eight of them round the sphere: cut along the edges of the cube, still closed, and textured."""
    points = np.concatenate([np.eye(3), -np.eye(3)]) * 5
    triangles = np.array(
        [[0, 2, 1], [1, 2, 3], [3, 2, 4], [4, 2, 0], [1, 5, 0], [3, 5, 1], [4, 5, 3], [0, 5, 4]]
    )

    class Octahedron:
        pass

    Octahedron.points, Octahedron.triangles = points, triangles
    panorama = layered_box(mapping, 96 if mapping == "cube map" else 128, ("walls",))
    piece = pieces_of(panorama, 1.0, lambda layer, radius: Octahedron, texture_error_px=ERROR_PX)[0]
    assert texture_errors(piece).max() < INSIDE_PX
    assert is_closed(welded(piece))
    np.testing.assert_allclose(np.abs(piece.points).sum(axis=1), 5, rtol=1e-6)


@pytest.mark.parametrize("mapping", BOTH)
def test_cutting_leaves_the_surface_as_it_is_and_closed(mapping):
    width = 192 if mapping == "cube map" else 256
    piece = pieces_of(layered_box(mapping, width, ("walls",)), 1.0)[0]
    assert is_closed(welded(piece))
    a, b, c = piece.points[piece.triangles.T].astype(float)
    volume = -np.einsum("nk,nk->n", np.cross(b, c), a).sum() / 6
    assert volume == pytest.approx(8 * HALF.prod(), rel=2e-3)


@pytest.mark.parametrize("mapping", BOTH)
def test_colours_at_vertices_are_those_of_their_directions(mapping):
    panorama = layered_box(mapping, 48 if mapping == "cube map" else 64)
    for piece in pieces_of(panorama, 1.0):
        towards = piece.points / np.linalg.norm(piece.points, axis=1, keepdims=True)
        got = linear_from_srgb(points_of_piece(piece).colours / 255)
        # At the domain's edge the colour is that of a texel half a pixel away, of a map so coarse.
        assert np.abs(got - radiance_in(towards)).max() < 0.05
        assert np.abs(got - radiance_in(towards)).mean() < 0.01


def test_what_lies_at_infinity_is_a_far_sphere_of_its_own():
    panorama = layered_box()
    room, window, objects = pieces_of(panorama, 1.0)
    assert [p.name for p in (room, window, objects)] == ["room", "room at infinity", "objects"]
    assert room.texture is window.texture
    far = far_radius(panorama)
    np.testing.assert_allclose(np.linalg.norm(window.points, axis=1), far, rtol=0.02)
    farthest = np.linalg.norm(HALF)
    assert far == pytest.approx(10 * farthest, rel=0.05)
    assert (window.points[:, 1] > 0.85 * far).all()
    assert not room.masked
    assert not objects.masked
    assert room.two_sided
    assert objects.two_sided


def test_parallax_sets_the_far_sphere_where_the_radius_is_large():
    panorama = layered_box(width=64)
    wide = LayeredPanorama(panorama.layers, np.eye(3), np.zeros(3), 20.0)
    assert far_radius(wide) == pytest.approx(20 * 64 / (2 * np.pi))
    cube = Layer("sky", "cube map", {"depth": np.full((32, 48), 3.0, np.float32)})  # 16 pixels a right angle
    wide = LayeredPanorama((cube,), np.eye(3), np.zeros(3), 20.0)
    assert far_radius(wide) == pytest.approx(20 * 64 / (2 * np.pi))
    both = LayeredPanorama((layered_box(width=128).layers[0], cube), np.eye(3), np.zeros(3), 20.0)
    assert far_radius(both) == pytest.approx(20 * 128 / (2 * np.pi))  # the finest layer's pixel
    with pytest.raises(ValueError, match=r"far 3\.0 m must be finite and beyond the farthest surface, 3\."):
        pieces_of(panorama, 1.0, far=3.0)


def test_a_mesh_beyond_the_domain_is_masked_and_a_closed_one_is_one_sided():
    whole = layered_box(names=("walls",))
    assert not pieces_of(whole, 1.0)[0].two_sided
    mesh = MESHES["grid"](whole.layers[0], 0)
    piece = pieces_of(layered_box(names=("objects",)), 1.0, lambda layer, radius: mesh)[0]
    assert piece.masked
    np.testing.assert_array_equal(piece.texture.pixels[..., 3] == 255, layered_box().layers[1].mask)
    assert 0 < len(piece.triangles) < 0.3 * len(mesh.triangles)  # what shows nothing is left out


@pytest.mark.parametrize("mapping", BOTH)
def test_masks_of_a_part_at_infinity_and_of_the_rest(mapping):
    """They make up the layer, and what of a mesh they leave covers them."""
    panorama = layered_box(mapping, 96 if mapping == "cube map" else 128, ("room",))
    room, window = pieces_of(panorama, 1.0, MESHES["mesh"])
    assert room.masked
    assert window.masked
    alphas = [piece.texture.pixels[..., 3].astype(int) for piece in (room, window)]
    assert (np.abs(alphas[0] + alphas[1] - 255) <= 1).all()
    for piece in (room, window):
        chart, alpha = piece.texture.chart, piece.texture.pixels[..., 3]
        middles = piece.uv[piece.triangles].mean(axis=1)
        height, width = alpha.shape
        at = (middles * (width, height)).astype(int)
        towards = chart.direction(middles)
        shown = alpha[at[:, 1].clip(0, height - 1), at[:, 0] % width] > 127
        assert ((towards[:, 1] > 0.9) == shown)[np.abs(towards[:, 1] - 0.9) > 0.1].all() == (piece is window)


def test_a_panorama_of_no_radius_has_a_shape_all_the_same():
    panorama = layered_box(width=128, names=("walls",))
    still = LayeredPanorama(panorama.layers, np.eye(3), np.zeros(3), 0.0)
    points = pieces_of(still, 1.0, MESHES["mesh"])[0].points
    np.testing.assert_allclose(np.ptp(points, axis=0), 2 * HALF, rtol=0.02)
    assert shape_radius(still) == pytest.approx(HALF.min() / 2, rel=0.01)
    assert shape_radius(panorama) == panorama.radius


def test_colours_are_spread_beyond_the_domain():
    panorama = layered_box(width=128, names=("objects",))
    layer = panorama.layers[0]
    radiance = np.where(layer.mask[..., None], np.ones(3, np.float32), np.float32(np.nan))
    attributes = {"radiance": radiance, "depth": layer.depth}
    lit = LayeredPanorama((Layer("lit", layer.mapping, attributes),), np.eye(3), np.zeros(3), 0.0)
    pixels = pieces_of(lit, 1.0)[0].texture.pixels
    row, column = 32, np.flatnonzero(~layer.mask[32])
    assert layer.mask[row, -1]
    assert layer.mask[row, 0]
    assert (pixels[row, column[:3], 0] == 255).all()
    assert (pixels[row, column[-3:], 0] == 255).all()
    assert (pixels[row, 64, :3] == 0).all()


def test_a_seam_vertex_is_two_and_no_triangle_runs_back_over_the_image():
    piece = pieces_of(layered_box(names=("walls",)), 1.0)[0]
    u = piece.uv[piece.triangles][..., 0]
    assert (np.ptp(u, axis=1) < 0.26).all()
    on_seam = (piece.points[:, 0] < 0) & (np.abs(piece.points[:, 1]) < 1e-6)
    assert set(piece.uv[on_seam & (np.abs(piece.points[:, 2]) < 1), 0].round(6).tolist()) == {0.0, 1.0}


@pytest.mark.parametrize("mesh", MESHES)
def test_of_a_small_domain_few_rows_are_kept(mesh):
    towards = directions("equirectangular", 256)
    depth = np.where(towards @ (1, 1, 0.2) > 1.41, 2, np.nan).astype(np.float32)
    attributes = {"depth": depth, "radiance": radiance_in(towards)}
    small = LayeredPanorama((Layer("small", "equirectangular", attributes),), np.eye(3), np.zeros(3), 0.1)
    piece = pieces_of(small, 1.0, MESHES[mesh])[0]
    assert 16 < np.count_nonzero((~np.isnan(depth)).any(axis=1)) + 32 <= 64
    assert piece.texture.pixels.shape == (64, 256, 4)
    assert texture_errors(piece).max() < INSIDE_PX
    assert piece.masked == (mesh == "mesh")
    if piece.masked:
        assert not piece.texture.pixels[[0, -1], :, 3].any()  # so beyond the rows there is nothing
        assert np.count_nonzero(piece.texture.pixels[..., 3]) == np.count_nonzero(~np.isnan(depth))


def test_exposure_multiplies_and_clips():
    pixels = pieces_of(layered_box(names=("walls",)), 4.0)[0].texture.pixels
    assert pixels[..., :3].max() == 255
    low = radiance_in((-1, 0, 0))[0] * 4
    assert linear_from_srgb(pixels[..., 0].min() / 255) == pytest.approx(low, abs=0.02)


@pytest.mark.parametrize(
    ("chart", "rays", "message"),
    [
        (EquirectangularChart(8), [[1, 0, 3], [-1, 1, 3], [-1, -1, 3]], "triangle 0 holds a pole"),
        (CubeChart(4, 2), [[1, 0, 0], [1, 1.5, 0], [1, 0, 0.5]], "triangle 0 lies on several faces"),
    ],
)
def test_triangles_without_texture_coordinates_are_refused(chart, rays, message):
    with pytest.raises(ValueError, match=message):
        chart.uv(np.array([rays], float))


def test_layers_that_cannot_be_shown_are_refused():
    panorama = layered_box(names=("walls",))
    bare = Layer("bare", "equirectangular", {"depth": panorama.layers[0].depth})
    with pytest.raises(ValueError, match="layer 'bare' has no radiance"):
        pieces_of(LayeredPanorama((bare,), np.eye(3), np.zeros(3), 0.0), 1.0)
    with pytest.raises(ValueError, match="texture error of 0 px must be above 0"):
        pieces_of(panorama, 1.0, texture_error_px=0)


def test_any_mesh_with_points_and_triangles_will_do():
    panorama = layered_box(width=64, names=("walls",))
    whole = MESHES["grid"](panorama.layers[0], 0)
    some = LayerMesh(whole.corners, whole.vertices, whole.depths, whole.triangles[:100])
    assert len(pieces_of(panorama, 1.0, lambda layer, radius: some)[0].triangles) == 100
