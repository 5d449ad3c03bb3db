"""Layers of clouds of points, scanned from places in a room that is known."""

import numpy as np
import pytest
from box_layers import BOTH, directions
from box_with_object import room_with_box, scanned_room

from expanded_panoramas.ibl_toolkit.layers.making.check import check_layers
from expanded_panoramas.ibl_toolkit.layers.making.from_points import layers_from_points
from expanded_panoramas.ibl_toolkit.layers.making.grid import PixelGrid
from expanded_panoramas.ibl_toolkit.layers.making.point_surfaces import splat_width, surfaces_of_points
from expanded_panoramas.ibl_toolkit.metrics import psnr

WIDTHS = {"equirectangular": 256, "cube map": 192}
SCANNERS = ((0, 0, 0), (2.4, 1.5, 0.3), (2.3, -1.6, 0.0))


@pytest.mark.parametrize("mapping", BOTH)
def test_a_room_scanned_from_three_places(mapping):
    """The other two see what the box hides from the first: that is in the background, not continued."""
    points, colours = scanned_room(SCANNERS, 60_000)
    width = WIDTHS[mapping]
    panorama = layers_from_points(points, colours, (0, 0, 0), width, 0.5, mapping=mapping)
    report = check_layers(panorama)
    assert report.uncovered == 0
    assert sum(report.jumps.values()) <= 2  # the points' places within their pixels are noise
    room, back = room_with_box(mapping, width), panorama.layers[0]
    off = np.abs(back.depth / room.behind_depth - 1)
    visible, hidden = back.mask & ~room.hit, back.mask & room.hit
    assert np.count_nonzero(hidden) > 0.6 * np.count_nonzero(room.hit)
    assert np.median(off[visible]) < 2e-3
    assert np.median(off[hidden]) < 5e-3
    assert psnr(back.radiance, room.behind, visible) > 40
    front = np.any([layer.mask for layer in panorama.layers[1:]], axis=0)
    assert np.count_nonzero(front != room.hit) < 0.2 * np.count_nonzero(room.hit)


def test_place_and_rotation():
    """Points in the world, seen from a place in it by a turned camera."""
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    rays = directions("equirectangular", 64).reshape(-1, 3)
    origin = np.array([5.0, 6.0, 7.0])
    colours = np.where(rays[:, :1] > 0, (1.0, 0, 0), (0, 0, 1.0))
    panorama = layers_from_points(
        origin + 3 * rays @ turn.T, colours, origin, 64, 0.2, world_from_panorama=turn
    )
    (layer,) = panorama.layers
    np.testing.assert_allclose(layer.depth, 3, rtol=1e-4)
    assert layer.radiance[16, 32, 0] > 0.9
    assert layer.radiance[16, 0, 2] > 0.9
    np.testing.assert_array_equal(panorama.origin, origin)


def test_holes_are_closed_up_to_their_width():
    """In a wall all round: one hole 10 px wide, one 60; the latter stays, but for its rim."""
    rays = directions("equirectangular", 256).reshape(-1, 3)
    pixel = 2 * np.pi / 256
    small = np.arccos(np.clip(rays[:, 0], -1, 1)) < 5 * pixel
    large = np.arccos(np.clip(rays[:, 1], -1, 1)) < 30 * pixel
    points = rays[~small & ~large] * 4
    panorama = layers_from_points(points, np.full_like(points, 0.5), (0, 0, 0), 256, 0.5, hole_px=14)
    (layer,) = panorama.layers
    mask = layer.mask.reshape(-1)
    assert mask[small].all()
    np.testing.assert_allclose(layer.depth.reshape(-1)[small], 4, rtol=5e-3)
    np.testing.assert_allclose(layer.radiance.reshape(-1, 3)[small], 0.5, rtol=1e-2)
    covered = np.arccos(np.clip(rays[~mask, 1], -1, 1))
    assert abs(covered.max() / pixel - (30 - 7)) < 2
    expected = (1 - np.cos(23 * pixel)) / 2
    np.testing.assert_allclose(check_layers(panorama).uncovered, expected, rtol=0.1)


def test_the_nearer_point_is_in_front_and_the_other_behind():
    grid = PixelGrid("equirectangular", 512, 256)
    offsets = np.array([[4.0, 0.02, 0.02], [1.0, 0.005, 0.005], [2.0, 0.01, 0.01]])
    colours = np.eye(3)
    found = surfaces_of_points(grid, offsets, colours, 1.0, 0.5)
    pixel = grid.at(offsets[1])
    np.testing.assert_allclose(1 / found.near[pixel], 1, rtol=1e-3)
    np.testing.assert_allclose(1 / found.behind[pixel], 4, rtol=1e-3)
    np.testing.assert_array_equal(found.colours[pixel], colours[1])
    np.testing.assert_array_equal(found.behind_colours[pixel], colours[0])


def test_width_of_splats_follows_the_density():
    """Of points on a lattice 3 px apart."""
    grid = PixelGrid("equirectangular", 512, 256)
    coarse = directions("equirectangular", 170).reshape(-1, 3)
    level = np.abs(coarse[:, 2]) < 0.2
    width = splat_width(grid, coarse[level])
    assert 3 < width < 6
    dense = directions("equirectangular", 1024).reshape(-1, 3)
    assert splat_width(grid, dense) == 1


@pytest.mark.parametrize("mapping", BOTH)
def test_sparse_points_leave_no_gaps_at_the_poles(mapping):
    rng = np.random.default_rng(3)
    rays = rng.normal(size=(6000, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    panorama = layers_from_points(
        2 * rays, np.ones_like(rays), (0, 0, 0), WIDTHS[mapping], 0.3, mapping=mapping
    )
    assert len(panorama.layers) == 1
    assert panorama.layers[0].mask.all()
    np.testing.assert_allclose(panorama.layers[0].depth, 2, rtol=1e-2)


def test_unusable_points_are_passed_over():
    points = np.array([[np.nan, 0, 0], [0, 0, 0], [2.0, 0, 0], [np.inf, 0, 0]])
    panorama = layers_from_points(points, np.ones((4, 3)), (0, 0, 0), 16, hole_px=100)
    assert panorama.radius == 1.0  # half of what is nearest
    np.testing.assert_allclose(panorama.layers[0].depth[4, 8], 2, rtol=0.05)


@pytest.mark.parametrize(
    ("points", "options", "message"),
    [
        (np.empty((0, 3)), {}, "of 0 points none is finite"),
        (np.full((2, 3), np.nan), {}, "of 2 points none is finite"),
        (np.zeros((2, 3)), {}, "over a millimetre from the origin"),
        (np.ones((2, 2)), {}, r"both must be \(n, 3\)"),
        (np.ones((2, 3)), {"width": 31}, "must be 2:1"),
        (np.ones((2, 3)), {"splat_px": 0}, "splat_px 0"),
        (np.ones((2, 3)), {"hole_px": -1}, "hole_px -1"),
        (np.ones((2, 3)), {"count": 0}, "count 0"),
        (np.ones((2, 3)), {"colours": np.full((2, 3), np.inf)}, "colour of point 0"),
        (np.ones((2, 3)), {"radius": -1}, "radius -1"),
    ],
)
def test_refused(points, options, message):
    settings = {"colours": np.ones((len(points), 3)), "width": 32, "radius": 0.5, **options}
    colours, width, radius = (settings.pop(name) for name in ("colours", "width", "radius"))
    with pytest.raises(ValueError, match=message):
        layers_from_points(points, colours, (0, 0, 0), width, radius, **settings)
