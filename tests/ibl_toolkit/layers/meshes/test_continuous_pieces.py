"""Layers taken apart where their depth jumps."""

import numpy as np
import pytest
from box_layers import BOTH, box_depth, box_layer, directions, layer_of, off_the_walls

from expanded_panoramas.ibl_toolkit.layers.meshes.bounded_mesh import bounded_mesh
from expanded_panoramas.ibl_toolkit.layers.meshes.continuous_pieces import continuous_pieces
from expanded_panoramas.ibl_toolkit.layers.meshes.mesh_error import mesh_error
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.raster.mesh_view import mesh_view
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole

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


@pytest.mark.parametrize("mapping", BOTH)
def test_balls_before_a_room_are_another_piece(mapping):
    depth, which = room_with_balls(mapping)
    pieces = continuous_pieces(layer_of(mapping, depth), RADIUS)
    assert [piece.name for piece in pieces] == ["room 1", "room 2"]
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
    depth, _ = room_with_balls(mapping)
    attributes = {"depth": depth, "radiance": np.ones((*depth.shape, 3), np.float32)}
    pieces = continuous_pieces(Layer("room", mapping, attributes), RADIUS)
    camera = Pinhole.looking_at((0.0, 0.4, 0.0), BALLS[0], 50, 96, 96)
    panorama = LayeredPanorama(pieces, np.eye(3), np.zeros(3), RADIUS)
    view = mesh_view(panorama, camera, [bounded_mesh(piece, RADIUS) for piece in pieces])
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


def test_infinity_is_no_piece():
    depth = box_depth("equirectangular", 64)
    depth[:16] = np.inf
    (piece,) = continuous_pieces(layer_of("equirectangular", depth), 1.0)
    assert (piece.mask == np.isfinite(depth)).all()
    assert continuous_pieces(layer_of("equirectangular", np.full_like(depth, np.inf)), 1.0) == ()
