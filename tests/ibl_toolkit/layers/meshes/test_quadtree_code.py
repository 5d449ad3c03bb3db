"""Quadtrees and triangles as bytes: exact round trips, the size of the thesis, and what is refused."""

import numpy as np
import pytest
from box_layers import box_layer

from expanded_panoramas.ibl_toolkit.layers.meshes.corners import Corners
from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import quadtree_mesh, quadtree_of
from expanded_panoramas.ibl_toolkit.layers.meshes.quadtree import balanced, build_quadtree, without_strips
from expanded_panoramas.ibl_toolkit.layers.meshes.quadtree_code import (
    decode_quadtree,
    decode_triangles,
    encode_quadtree,
    encode_triangles,
)
from expanded_panoramas.ibl_toolkit.layers.meshes.triangulation import triangulate_cells


def same_tree(one, other):
    sizes = [(tree.sheets, tree.width, tree.height, len(tree.splits)) for tree in (one, other)]
    return sizes[0] == sizes[1] and all(map(np.array_equal, one.splits, other.splits))


@pytest.mark.parametrize("size", [(1, 1, 1), (6, 1, 1), (1, 2, 1), (1, 5, 3), (6, 7, 7), (2, 64, 31)])
@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_round_trip(size, share):
    random = np.random.default_rng(7)
    tree = build_quadtree(*size, lambda cells: random.random(len(cells.x0)) < share)
    data = encode_quadtree(tree)
    assert same_tree(decode_quadtree(data), tree)
    assert encode_quadtree(decode_quadtree(data)) == data


def test_a_mesh_comes_back_from_its_bits_and_its_depth():
    layer = box_layer("cube map", 96)
    tree = quadtree_of(layer)
    one, other = (quadtree_mesh(layer, t) for t in (tree, decode_quadtree(encode_quadtree(tree))))
    for name in ("vertices", "depths", "triangles"):
        assert np.array_equal(getattr(one, name), getattr(other, name))


def test_a_million_triangles_take_at_most_122_kilobytes():
    """Section 7.4.2.7. The hardest case: split at random, and no leaf so small that it needs no bit."""
    random = np.random.default_rng(3)
    width, height = 4096, 2048

    def must_split(cells):
        return (cells.area > 32) | ((cells.area > 8) & (random.random(len(cells.x0)) < 0.5))

    inside = np.ones((1, height, width), bool)
    tree = without_strips(balanced(build_quadtree(1, width, height, must_split), inside, wraps=True))
    triangles = len(triangulate_cells(tree.leaves(), Corners("equirectangular", width, height)))
    data = encode_quadtree(tree)
    assert triangles > 1e6
    assert len(data) * 1e6 / triangles <= 122_000
    assert same_tree(decode_quadtree(data), tree)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "data is no quadtree: it must begin with XPQ1, not b''"),
        (b"PNG1" + bytes(40), "must begin with XPQ1, not b'PNG1'"),
        (b"XPQ1" + b"\xff" * 12, "quadtree of 4294967295 sheets .* must be 1 to 6 of 1 to 2\\^29 px"),
        (b"XPQ1" + bytes(12), "quadtree of 0 sheets of 0 x 0 px"),
        (b"XPQ1" + np.array([1, 8, 8], "<u4").tobytes(), "ends after 0 bits, in level 0"),
        (b"XPQ1" + np.array([1, 8, 8], "<u4").tobytes() + b"\xff", "ends after 8 bits, in level 2"),
        (b"XPQ1" + np.array([1, 8, 8], "<u4").tobytes() + b"\x00\x00", "goes on after its last bit, 1"),
        (b"XPQ1" + np.array([1, 8, 8], "<u4").tobytes() + b"\x01", "goes on after its last bit, 1"),
    ],
)
def test_other_bytes_are_no_quadtree(data, message):
    with pytest.raises(ValueError, match=message):
        decode_quadtree(data)


def test_triangles_come_back():
    vertices, triangles = np.array([3, 9, 2**32 - 1]), np.array([[0, 1, 2], [2, 1, 0]], np.int32)
    found = decode_triangles(encode_triangles(vertices, triangles))
    assert np.array_equal(found[0], vertices)
    assert np.array_equal(found[1], triangles)
    assert found[1].dtype == np.int32
    empty = decode_triangles(encode_triangles(vertices[:0], triangles[:0]))
    assert (empty[0].shape, empty[1].shape) == ((0,), (0, 3))


def test_other_bytes_are_no_triangles():
    good = encode_triangles(np.array([3, 9, 11]), np.array([[0, 1, 2]]))
    for data, message in (
        (b"XPQ1" + good[4:], "data is no triangles: it must begin with XPT1"),
        (good[:-1], "data of 3 vertices, 1 triangles has 35 bytes, not 36"),
        (good[:-4] + b"\x03\0\0\0", "triangles have vertex 3, but there are only 3"),
    ):
        with pytest.raises(ValueError, match=message):
            decode_triangles(data)
