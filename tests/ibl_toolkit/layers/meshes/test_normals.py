"""Normals from depth, how they turn, and the masks that split a quadtree."""

import numpy as np
import pytest
from box_layers import BOTH, HALF, box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.meshes.corners import Corners
from expanded_panoramas.ibl_toolkit.layers.meshes.normals import normal_variation, normals_from_depth
from expanded_panoramas.ibl_toolkit.layers.meshes.subdivision import (
    Subdivision,
    border,
    features_and_residual,
)

WIDTHS = {"equirectangular": 256, "cube map": 192}


def room(mapping):
    """Corners, and as sheets: depth, the true normals, and how near a pixel is to an edge (1 at it)."""
    ways, depth = directions(mapping, WIDTHS[mapping]), box_depth(mapping, WIDTHS[mapping])
    corners = Corners(mapping, *depth.shape[::-1])
    share = np.abs(ways) * depth[..., None] / HALF
    wall = share == share.max(axis=2, keepdims=True)
    sheets = [corners.as_sheets(a) for a in (depth, -np.sign(ways) * wall, np.sort(share, axis=2)[..., 1])]
    return corners, *sheets


@pytest.mark.parametrize("mapping", BOTH)
def test_normals_of_the_walls_of_the_room(mapping):
    """Poles, seam and faces' rims included; as far as two pixels from the room's edges."""
    corners, depth, truth, nearness = room(mapping)
    found = normals_from_depth(corners, depth, np.ones(depth.shape, bool))
    cosine = np.sum(found * truth, axis=-1)
    assert cosine[nearness < 0.9].min() > np.cos(np.radians(0.5))
    assert np.allclose(np.linalg.norm(found, axis=-1), 1, atol=1e-5)


@pytest.mark.parametrize("mapping", BOTH)
def test_features_are_the_edges_of_the_room(mapping):
    corners, depth, _, nearness = room(mapping)
    inside = np.ones(depth.shape, bool)
    variation = normal_variation(corners, normals_from_depth(corners, depth, inside), inside)
    features, residual = features_and_residual(variation, 10)
    assert nearness[features].min() > 0.88
    assert features[nearness > 0.995].all()
    assert residual[features].max() == 0
    assert np.array_equal(residual[~features], variation[~features])


def test_every_row_is_compared_with_the_one_above():
    """Of a map of more rows than are looked at together."""
    normals = np.random.default_rng(3).normal(size=(1, 150, 300, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    inside = np.ones((1, 150, 300), bool)
    found = normal_variation(Corners("equirectangular", 300, 150), normals, inside)
    here, left, above = normals[:, 1:-1, 1:-1], normals[:, 1:-1, :-2], normals[:, :-2, 1:-1]
    expected = np.hypot(*(1 - np.sum(here * other, axis=-1) for other in (left, above)))
    np.testing.assert_allclose(found[:, 1:-1, 1:-1], expected, atol=1e-5)


def test_a_domain_has_no_normals_from_beyond_its_rim():
    """A near half before a far wall: each has its own normals up to the rim."""
    corners = Corners("equirectangular", 64, 32)
    inside = np.zeros((1, 32, 64), bool)
    inside[:, :, :20] = True
    depth = np.where(inside, 2.0, 50.0).astype(np.float32)
    found = normals_from_depth(corners, depth, inside)
    towards_origin = -directions("equirectangular", 64)[None]
    assert np.sum(found * towards_origin, axis=-1)[inside].min() > 0.99
    assert not found[~inside].any()


def test_a_pixel_alone_looks_at_the_origin():
    corners = Corners("equirectangular", 16, 8)
    inside = np.zeros((1, 8, 16), bool)
    inside[0, 3, 5] = True
    normal = normals_from_depth(corners, np.ones(inside.shape), inside)[0, 3, 5]
    assert np.allclose(normal, -directions("equirectangular", 16)[3, 5], atol=1e-6)


def test_a_fold_is_a_feature():
    """Opposite normals: eq. 7.12 as printed calls them equal."""
    normals = np.zeros((1, 2, 6, 3), np.float32)
    normals[:, :, :3, 0], normals[:, :, 3:, 0] = 1, -1
    inside = np.ones((1, 2, 6), bool)
    variation = normal_variation(Corners("equirectangular", 6, 3), normals, inside)
    assert variation[0, 0].tolist() == [2, 0, 0, 2, 0, 2]  # at the fold, and where the seam folds back
    inside[:, :, 2] = False
    assert normal_variation(Corners("equirectangular", 6, 3), normals, inside)[0, 0, 3] == 0


def test_the_border_is_inside_the_domain():
    inside = np.ones((1, 5, 10), bool)
    inside[0, 2, 3] = False
    expected = np.zeros((5, 10), bool)
    expected[1:4, 2:5] = True
    expected[2, 3] = False
    corners = Corners("equirectangular", 10, 5)
    assert np.array_equal(border(corners, inside)[0], expected)  # the sheet's own rim is none
    inside[0, 1, 0] = False
    assert border(corners, inside)[0, 1].tolist() == [k in (1, 2, 3, 4, 9) for k in range(10)]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"feature_deg": 0}, "feature_deg is 0, must be above 0 and at most 180 degrees"),
        ({"turn_deg": 200}, "turn_deg is 200, must be above 0"),
    ],
)
def test_impossible_settings_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        Subdivision(**changes)
