"""Layers taken apart where their depth jumps."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from box_layers import BOTH, box_depth, box_layer, directions, layer_of, off_the_walls

from expanded_panoramas.ibl_toolkit.layers.export.pieces import MESHES, pieces_of
from expanded_panoramas.ibl_toolkit.layers.making.continuous_pieces import (
    continuous_pieces,
    cut_at_jumps,
    mesh_pieces,
    with_hidden_rim,
)
from expanded_panoramas.ibl_toolkit.layers.meshes.bounded_mesh import bounded_mesh
from expanded_panoramas.ibl_toolkit.layers.meshes.mesh_error import mesh_error
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.layers.views.view_methods import render_view

BALLS, BALL = np.array([(-1.2, 0.02, 0.1), (0.3, 0.9, -0.7)]), 0.3
RADIUS = 0.6
WIDTHS = {"equirectangular": 256, "cube map": 192}


def room_with_balls(mapping):
    """A box room, and before it balls in two directions, one of them over the seam: depth, and which ball."""
    depth, ways = box_depth(mapping, WIDTHS[mapping]), directions(mapping, WIDTHS[mapping])
    which = np.zeros(depth.shape, dtype=int)
    for number, middle in enumerate(BALLS, start=1):
        along = ways @ middle
        inner = along**2 - middle @ middle + BALL**2
        hit = (inner > 0) & (along > 0)
        depth = np.where(hit, along - np.sqrt(np.maximum(inner, 0)), depth).astype(np.float32)
        which[hit] = number
    return depth, which


def painted(mapping):
    """The room with balls as one layer, white."""
    depth, _ = room_with_balls(mapping)
    return Layer("room", mapping, {"depth": depth, "radiance": np.ones((*depth.shape, 3), np.float32)})


@pytest.mark.parametrize("mapping", BOTH)
def test_balls_before_a_room_are_another_piece(mapping):
    depth, which = room_with_balls(mapping)
    pieces = continuous_pieces(layer_of(mapping, depth), RADIUS)
    assert [piece.name for piece in pieces] == ["room", "room, part 2"]
    room, balls = (piece.mask for piece in pieces)
    assert (room ^ balls).all()
    assert (balls != (which > 0)).sum() < 0.02 * balls.sum()


@pytest.mark.parametrize("mapping", BOTH)
def test_their_meshes_are_right_and_smaller(mapping):
    """What joins a ball to the wall behind it would take triangles all round the ball."""
    layer = layer_of(mapping, room_with_balls(mapping)[0])
    pieces = continuous_pieces(layer, RADIUS)
    meshes = [bounded_mesh(piece, RADIUS) for piece in pieces]
    for piece, mesh in zip(pieces, meshes, strict=True):
        assert np.nanmax(mesh_error(mesh, piece, RADIUS)) <= 0.5 * (1 + 1e-6)
    assert sum(len(mesh.triangles) for mesh in meshes) < len(bounded_mesh(layer, RADIUS).triangles)


@pytest.mark.parametrize("mapping", BOTH)
def test_from_beside_no_skin_is_seen_between_a_ball_and_the_wall(mapping):
    """Though they are one layer, as the first of successive surfaces is."""
    camera = Pinhole.looking_at((0.0, 0.4, 0.0), BALLS[0], 50, 96, 96)
    panorama = LayeredPanorama((painted(mapping),), np.eye(3), np.zeros(3), RADIUS)
    view = render_view(panorama, camera, "mesh")
    seen = ~view.holes
    points = camera.eye + camera.directions()[seen] * view.depth[seen, None]
    off_balls = np.min([np.abs(np.linalg.norm(points - ball, axis=1) - BALL) for ball in BALLS], axis=0)
    assert np.minimum(off_the_walls(points), off_balls).max() < 0.06
    assert (off_balls < 0.06).sum() > 500
    assert view.holes.sum() > 500  # the wall that the ball hides from the origin


@pytest.mark.parametrize("mapping", BOTH)
def test_what_is_continuous_stays_whole(mapping):
    """Up to creases and planes seen at a flat angle; round the seam, over poles and over cube edges."""
    layer = box_layer(mapping, WIDTHS[mapping])
    (piece,) = continuous_pieces(layer, 1.0)
    assert piece.mask.all()
    assert piece.depth is layer.depth


def test_dust_without_jumps_is_one_piece():
    inside = np.random.default_rng(6).random((64, 128)) < 0.2
    (dust,) = continuous_pieces(box_layer("equirectangular", 128, inside), 1.0)
    assert (dust.mask == inside).all()


def test_what_lies_at_infinity_behind_a_ball_is_parted_from_it():
    depth, which = room_with_balls("equirectangular")
    depth = np.where(which > 0, depth, np.inf).astype(np.float32)
    sky, balls = continuous_pieces(layer_of("equirectangular", depth), RADIUS)
    assert (sky.mask == (which == 0)).all()
    assert (balls.mask == (which > 0)).all()


def test_a_domain_smaller_than_where_depth_is_known_stays_so():
    depth, which = room_with_balls("equirectangular")
    left = np.arange(depth.shape[1]) < 200
    pieces = continuous_pieces(layer_of("equirectangular", depth, left & np.ones_like(which, bool)), RADIUS)
    assert (np.sum([piece.mask for piece in pieces], axis=0) == left).all()
    assert len(pieces) == 2


def test_names_that_are_there_are_not_given_again():
    room = painted("equirectangular")
    panorama = LayeredPanorama((room, replace(room, name="room, part 2")), np.eye(3), np.zeros(3), RADIUS)
    names = [layer.name for layer in cut_at_jumps(panorama).layers]
    assert names == ["room", "room, part 3", "room, part 2", "room, part 2, part 2"]


@pytest.mark.parametrize("mesh", ["quadtree", "grid"])
@pytest.mark.parametrize("mapping", BOTH)
def test_no_exported_triangle_joins_a_ball_to_the_wall(mapping, mesh):
    pieces = pieces_of(
        LayeredPanorama((painted(mapping),), np.eye(3), np.zeros(3), RADIUS), 1.0, MESHES[mesh]
    )
    assert [piece.name for piece in pieces] == ["room", "room, part 2"]
    for piece in pieces:
        distance = np.linalg.norm(piece.points, axis=1)[piece.triangles]
        assert (distance.max(axis=1) / distance.min(axis=1)).max() < 1.4


def test_an_exported_mesh_that_goes_beyond_its_piece_is_masked_by_it():
    room = painted("equirectangular")
    pieces = pieces_of(LayeredPanorama((room,), np.eye(3), np.zeros(3), RADIUS), 1.0, MESHES["mesh"])
    wall, balls = (piece.texture.pixels[..., 3] > 0 for piece in pieces)
    np.testing.assert_array_equal(balls, mesh_pieces(room, RADIUS)[1].mask)
    assert (wall | balls).all()
    assert (wall & balls).any()
    inner = cv2.erode(balls.astype(np.uint8), np.ones((5, 5))) > 0
    assert not (wall & inner).any()  # it goes on for two pixels behind them
    dark = (pieces[1].texture.pixels[..., :3] == 0).all(axis=2)
    assert dark.mean() > 0.5  # the room's picture is not stored again
    assert not dark[cv2.dilate(balls.astype(np.uint8), np.ones((9, 9))) > 0].any()


@pytest.mark.parametrize("mapping", BOTH)
def test_what_is_behind_goes_on_under_the_rim_of_what_is_before_it(mapping):
    room = layer_of(mapping, room_with_balls(mapping)[0])
    wall, balls = (with_hidden_rim(piece, room, RADIUS) for piece in mesh_pieces(room, RADIUS))
    hidden = wall.mask & balls.mask
    walls = box_depth(mapping, WIDTHS[mapping])
    assert hidden.any()
    assert np.quantile(np.abs(wall.depth / walls - 1)[hidden], 0.98) < 0.06
    np.testing.assert_array_equal(balls.depth[hidden], room.depth[hidden])


def test_meshes_keep_narrow_sheets():
    """A band at 0.99 of the walls' distance: from within 1.8 m its rim opens by 0.5°, over a pixel."""
    room = box_layer("equirectangular", 1024)
    band = np.abs(directions("equirectangular", 1024)[..., 2]) < 0.2
    layer = layer_of("equirectangular", np.where(band, 0.99 * room.depth, room.depth).astype(np.float32))
    assert len(continuous_pieces(layer, 1.8)) > 1
    assert mesh_pieces(layer, 1.8) == (layer,)


def test_behind_a_frame_what_is_in_it_and_what_is_round_it_do_not_meet():
    """Both are of one piece, for it is the frame that each of them jumps to."""
    depth = np.full((64, 128), 4.0, np.float32)
    depth[20:44, 40:80] = 1.0
    depth[23:41, 43:77] = 2.0
    layer = layer_of("equirectangular", depth)
    pieces = mesh_pieces(layer, RADIUS)
    assert [piece.mask[30, 60] for piece in pieces] == [True, False]
    for piece in pieces:
        grown = with_hidden_rim(piece, layer, RADIUS)
        assert mesh_pieces(grown, RADIUS) == (grown,)
    assert with_hidden_rim(pieces[0], layer, RADIUS).mask.sum() > pieces[0].mask.sum()
