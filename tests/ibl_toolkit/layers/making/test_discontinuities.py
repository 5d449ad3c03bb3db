"""Where depth jumps and where it does not, in both mappings."""

import numpy as np
import pytest
from box_layers import BOTH, box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.making.discontinuities import creases, cuts, nearness
from expanded_panoramas.ibl_toolkit.layers.making.flood import flood
from expanded_panoramas.ibl_toolkit.layers.making.grid import PixelGrid
from expanded_panoramas.ibl_toolkit.layers.making.regions import parallax

WIDTHS = {"equirectangular": 256, "cube map": 192}


def grid_and_near(mapping, depth):
    grid = PixelGrid(mapping, depth.shape[1], depth.shape[0])
    return grid, grid.flat(nearness(depth))


def both_ways(grid, found):
    """Whether what is said of pairs is the same from both sides."""
    pixel, other = grid.pairs(found)
    pairs = set(zip(pixel.tolist(), other.tolist(), strict=True))
    return all((b, a) in pairs for a, b in pairs)


@pytest.mark.parametrize("mapping", BOTH)
def test_neighbours_are_mutual_and_near(mapping):
    for width in (6, WIDTHS[mapping]):
        grid = PixelGrid(mapping, width, width // 2 if mapping == "equirectangular" else width * 2 // 3)
        everyone = np.ones((4, grid.size), bool)
        assert both_ways(grid, everyone)
        pixel, other = grid.pairs(everyone)
        angle = np.arccos(np.clip((grid.directions[pixel] * grid.directions[other]).sum(axis=1), -1, 1))
        assert angle.max() < 2 * grid.pixel
        assert np.array_equal(grid.at(grid.directions), np.arange(grid.size))
        image = np.arange(grid.size * 2).reshape(grid.height, grid.width, 2)
        assert np.array_equal(grid.image(grid.flat(image)), image)


@pytest.mark.parametrize("mapping", BOTH)
def test_a_room_has_creases_and_no_jumps(mapping):
    grid, near = grid_and_near(mapping, box_depth(mapping, WIDTHS[mapping]))
    assert not cuts(grid, near, 1.0).any()
    found = creases(grid, near)
    assert both_ways(grid, found)
    points = grid.directions / near[:, None] / (2.0, 3.0, 1.5)
    gap = np.sort(np.abs(points), axis=1)[:, 1]  # 1 at the room's edges
    assert (gap[found.any(axis=0)] > 0.7).all()  # two pixels away, where the wall is seen flat
    assert found.any(axis=0)[gap > 0.99].mean() > 0.95


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("towards", [(1, 0, 0), (-1, 0.02, 0.01), (0.1, 0, 1), (1, -1, 0.1), (1, 1, -1)])
def test_the_rim_of_a_disc(mapping, towards):
    """A disc before a wall, over the seam, a pole, an edge and a corner of the cube, is cut all round."""
    towards = np.array(towards) / np.linalg.norm(towards)
    rays = directions(mapping, WIDTHS[mapping])
    inside = rays @ towards > 0.95
    grid, near = grid_and_near(mapping, np.where(inside, 2.0, 4.0))
    flat = grid.flat(inside)
    found = cuts(grid, near, 0.5)
    pixel, other = grid.pairs(np.ones((4, grid.size), bool))
    slot, _ = np.nonzero(np.ones((4, grid.size), bool))
    differs = flat[pixel] != flat[other]
    assert np.array_equal(found[slot, pixel], differs)


def test_a_jump_too_small_to_be_seen_is_none():
    depth = np.full((64, 128), 3.0)
    depth[:, :40] = 3.02
    grid, near = grid_and_near("equirectangular", depth)
    seen_px = 0.5 * (1 / 3 - 1 / 3.02) / grid.pixel
    assert not cuts(grid, near, 0.5, 1.01 * seen_px).any()
    assert cuts(grid, near, 0.5, 0.99 * seen_px).any()
    assert not cuts(grid, near, 0.0).any()


def test_a_pixel_of_a_mean_depth_hides_no_jump():
    depth = np.full((64, 128), 4.0)
    depth[:, 40:60] = 1.0
    depth[:, 39] = depth[:, 60] = 1.6  # half way in 1/depth
    grid, near = grid_and_near("equirectangular", depth)
    found = grid.image(cuts(grid, near, 0.5).T)
    assert found[32, 38:41].any(axis=1).all()
    assert found[32, 59:62].any(axis=1).all()


def test_a_ball_turns_away_without_a_jump():
    """Only its outline is cut, however steep it is there."""
    rays = directions("equirectangular", 1024)
    along = rays[..., 0] * 3.0
    inside = along**2 - 9 + 0.8**2
    depth = np.where((inside > 0) & (along > 0), along - np.sqrt(np.maximum(inside, 0)), 6.0)
    grid, near = grid_and_near("equirectangular", depth)
    pixel, other = grid.pairs(cuts(grid, near, 0.5))
    ball = grid.flat(depth < 6)
    assert (ball[pixel] != ball[other]).all()


def test_a_box_on_a_floor_has_a_hollow_crease_and_its_own_edge_none():
    """In profile: floor, a step up of a metre, and on."""
    down = np.linspace(-1.2, -0.3, 64)
    wall = 1.5 / np.abs(np.sin(down))
    profile = np.where(wall * np.cos(down) > 2, 2 / np.cos(down), wall)
    depth = np.full((128, 256), 2.0)
    rows = np.rint((0.5 - down / np.pi) * 128 - 0.5).astype(int)
    depth[rows] = profile[:, None]
    grid, near = grid_and_near("equirectangular", depth[:, :256])
    found = grid.image(creases(grid, near).any(axis=0))
    foot = np.arctan(1.5 / 2)
    row = (0.5 + foot / np.pi) * 128 - 0.5
    assert found[round(row) - 1 : round(row) + 2].any(axis=0).all()


def test_parallax_against_lines_of_sight():
    """From eyes all round at the radius, past the edge, to what is behind: the widest is what it says."""
    radius, edge, wall = 0.5, 1.3, 3.0
    turn = np.linspace(0, 2 * np.pi, 20001)
    eye = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    sight = np.array([edge, 0.0]) - eye
    sight /= np.linalg.norm(sight, axis=1, keepdims=True)
    along = np.einsum("nk,nk->n", eye, sight)
    point = eye + (-along + np.sqrt(along**2 - radius**2 + wall**2))[:, None] * sight
    widest = np.abs(np.arctan2(point[:, 1], point[:, 0])).max()
    np.testing.assert_allclose(parallax(radius, np.array(1 / edge), np.array(1 / wall)), widest, rtol=1e-6)
    np.testing.assert_allclose(parallax(1.0, np.array(1 - 1e-9), np.array(0.0)), np.pi / 2, atol=1e-4)


def test_an_eye_goes_round_an_edge_within_the_radius():
    """Also where both surfaces are within it; nothing hides what is nearer, or itself."""
    nearer, farther = np.array([4.0, 4.0, 4.0, 3.0]), np.array([0.0, 3.0, 4.0, 4.0])
    np.testing.assert_array_equal(parallax(0.5, nearer, farther), [np.pi, np.pi, 0, 0])


@pytest.mark.parametrize("mapping", BOTH)
def test_a_flood_is_a_disc(mapping):
    width = WIDTHS[mapping]
    grid = PixelGrid(mapping, width, width // 2 if mapping == "equirectangular" else width * 2 // 3)
    for towards in ((-1, 0.01, 0), (0, 0, 1), (1, 1, 1)):
        start = grid.at(np.array([towards], float))
        left, number = flood(grid, start, start, np.array([0.4]), np.ones(grid.size, bool))
        angle = np.arccos(np.clip(grid.directions @ grid.directions[start[0]], -1, 1))
        assert np.array_equal(number >= 0, angle <= 0.4)
        np.testing.assert_allclose(left[number >= 0], 0.4 - angle[number >= 0], atol=1e-3)
