"""Layers taken apart where their depth jumps."""

import numpy as np
import pytest
from box_layers import BOTH, box_depth, box_layer, directions, layer_of

from expanded_panoramas.ibl_toolkit.layers.bounded_mesh import bounded_mesh
from expanded_panoramas.ibl_toolkit.layers.continuous_pieces import continuous_pieces
from expanded_panoramas.ibl_toolkit.layers.mesh_error import mesh_error

WIDTHS = {"equirectangular": 256, "cube map": 192}


def room_with_balls(mapping):
    """A box room, and before it balls in two directions, one of them over the seam: depth, and which ball."""
    depth, ways = box_depth(mapping, WIDTHS[mapping]), directions(mapping, WIDTHS[mapping])
    which = np.zeros(depth.shape, dtype=int)
    for number, middle in enumerate(((-1.2, 0.02, 0.1), (0.3, 0.9, -0.7)), start=1):
        along = ways @ np.array(middle)
        inner = along**2 - np.dot(middle, middle) + 0.3**2
        hit = (inner > 0) & (along > 0)
        depth = np.where(hit, along - np.sqrt(np.maximum(inner, 0)), depth).astype(np.float32)
        which[hit] = number
    return depth, which


@pytest.mark.parametrize("mapping", BOTH)
def test_balls_before_a_room_are_pieces(mapping):
    depth, which = room_with_balls(mapping)
    pieces = continuous_pieces(layer_of(mapping, depth), 0.6)
    assert [piece.name for piece in pieces] == ["room 1", "room 2", "room 3"]
    sizes = [np.count_nonzero(which == k) for k in range(3)]
    for piece in pieces:
        found = {k for k in range(3) if (piece.mask & (which == k)).sum() > 0.5 * sizes[k]}
        assert len(found) == 1
        assert (piece.mask & (which != found.pop())).sum() <= 0.02 * piece.mask.sum()
    assert (sum(piece.mask.astype(int) for piece in pieces) == 1).all()


@pytest.mark.parametrize("mapping", BOTH)
def test_meshes_of_pieces_keep_their_error_and_are_smaller(mapping):
    """No ball is joined to the wall behind it, which would take triangles all round the ball."""
    depth, _ = room_with_balls(mapping)
    layer = layer_of(mapping, depth)
    whole = bounded_mesh(layer, 0.6)
    pieces = continuous_pieces(layer, 0.6)
    meshes = [bounded_mesh(piece, 0.6) for piece in pieces]
    for piece, mesh in zip(pieces, meshes, strict=True):
        assert np.nanmax(mesh_error(mesh, piece, 0.6)) <= 0.5 * (1 + 1e-6)
    assert sum(len(mesh.triangles) for mesh in meshes) < len(whole.triangles)


@pytest.mark.parametrize("mapping", BOTH)
def test_what_is_continuous_stays_whole(mapping):
    """Up to creases and planes seen at a flat angle; round the seam, over poles and over cube edges."""
    layer = box_layer(mapping, WIDTHS[mapping])
    (piece,) = continuous_pieces(layer, 1.0)
    assert piece.mask.all()
    assert piece.depth is layer.depth


def test_dust_is_put_together():
    inside = np.random.default_rng(6).random((64, 128)) < 0.2
    (dust,) = continuous_pieces(box_layer("equirectangular", 128, inside), 1.0)
    assert (dust.mask == inside).all()


def test_infinity_is_no_piece():
    depth = box_depth("equirectangular", 64)
    depth[:16] = np.inf
    (piece,) = continuous_pieces(layer_of("equirectangular", depth), 1.0)
    assert (piece.mask == np.isfinite(depth)).all()
    assert continuous_pieces(layer_of("equirectangular", np.full_like(depth, np.inf)), 1.0) == ()
