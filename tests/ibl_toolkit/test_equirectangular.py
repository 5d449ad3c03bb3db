"""Directions <-> pixels of the equirectangular panorama: known points, round trips, solid angles, look-up."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular as er

ROUND_TRIP = 1e-6
EXACT = 1e-12
FLOAT32 = 2e-7

AXES = {
    (1, 0, 0): (0.5, 0.5),
    (0, 1, 0): (0.25, 0.5),
    (0, -1, 0): (0.75, 0.5),
    (-1, 0, 0): (0.0, 0.5),
}


def random_directions(count=2000, seed=0):
    d = np.random.default_rng(seed).normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.mark.parametrize(("direction", "uv"), AXES.items())
def test_axes_lie_where_the_conventions_say(direction, uv):
    np.testing.assert_allclose(er.uv_from_direction(direction), uv, atol=EXACT)
    np.testing.assert_allclose(er.direction_from_uv(uv), direction, atol=EXACT)


def test_general_point_by_hand():
    # phi = (1/2 - 1/3) 2 pi = 60 deg, theta = (1/2 - 1/3) pi = 30 deg
    expected = (np.sqrt(3) / 4, 3 / 4, 1 / 2)
    np.testing.assert_allclose(er.direction_from_uv((1 / 3, 1 / 3)), expected, atol=EXACT)


def test_top_row_is_up():
    assert er.direction_from_uv((0.3, 0.0))[2] == pytest.approx(1, abs=EXACT)
    assert er.uv_from_direction((0, 0, 5))[1] == 0
    assert er.uv_from_direction((0, 0, -5))[1] == 1


def test_directions_survive_uv_and_pixels():
    d = random_directions()
    uv = er.uv_from_direction(d * np.geomspace(1e-30, 1e30, len(d))[:, None])
    again = er.uv_from_pixel(er.pixel_from_uv(uv, 4096, 2048), 4096, 2048)
    np.testing.assert_allclose(er.direction_from_uv(again), d, atol=ROUND_TRIP)


def test_uv_survive_directions_up_to_the_poles_and_the_seam():
    u, v = np.meshgrid(np.linspace(0, 1, 101)[:-1], np.linspace(0, 1, 51))
    uv = np.stack([u, v], axis=-1)
    again = er.uv_from_direction(er.direction_from_uv(uv))
    np.testing.assert_allclose(again[..., 1], v, atol=ROUND_TRIP)
    # u wraps: 0 and just below 1 are the same meridian
    np.testing.assert_allclose((again[..., 0] - u + 0.5) % 1, 0.5, atol=ROUND_TRIP)


def test_every_pixel_centre_survives():
    i, j = np.meshgrid(np.arange(16), np.arange(8))
    ij = np.stack([i, j], axis=-1)
    d = er.direction_from_uv(er.uv_from_pixel(ij, 16, 8))
    np.testing.assert_allclose(er.pixel_from_uv(er.uv_from_direction(d), 16, 8), ij, atol=ROUND_TRIP)
    np.testing.assert_allclose(er.pixel_directions(16, 8), d, atol=FLOAT32)


def test_u_stays_below_one_on_both_sides_of_the_seam():
    u = er.uv_from_direction(
        [[-1, 0.0, 0], [-1, -0.0, 0], [-1, 1e-320, 0], [-1, -1e-320, 0], [-1, -1e-9, 0]]
    )[:, 0]
    assert np.all((u >= 0) & (u < 1))
    assert u[-1] > 0.999


@pytest.mark.parametrize("direction", [(0, 0, 0), (np.nan, 0, 1), (np.inf, 0, 0)])
def test_refuses_directions_that_point_nowhere(direction):
    with pytest.raises(ValueError, match="points nowhere"):
        er.uv_from_direction([(1, 0, 0), direction])


def test_pixel_directions_are_read_only_and_kept():
    d = er.pixel_directions(8, 4)
    assert d is er.pixel_directions(8, 4)
    assert d.dtype == np.float32
    with pytest.raises(ValueError, match="read-only"):
        d[0, 0, 0] = 0


@pytest.mark.parametrize("size", [(2, 1), (4, 2), (16384, 8192)])
def test_solid_angles_make_a_sphere(size):
    width, height = size
    assert er.row_solid_angles(width, height).sum() * width == pytest.approx(4 * np.pi, rel=EXACT)


def test_solid_angles_against_closed_form():
    # the cap of the top row: 2 pi (1 - cos(pi / H))
    np.testing.assert_allclose(
        er.row_solid_angles(10, 5)[0] * 10, 2 * np.pi * (1 - np.cos(np.pi / 5)), rtol=EXACT
    )


def test_sample_returns_the_pixels_at_their_centres():
    image = np.random.default_rng(1).random((8, 16, 3))
    d = er.direction_from_uv(er.uv_from_pixel(np.stack(np.meshgrid(np.arange(16), np.arange(8)), -1), 16, 8))
    np.testing.assert_allclose(er.sample(image, d), image, atol=ROUND_TRIP)


@pytest.mark.parametrize("c", [1, 3, 4])
def test_sample_takes_any_number_of_channels_and_shape_of_directions(c):
    image = np.random.default_rng(2).random((4, 8, c)).astype(np.float32)
    d = random_directions(6).reshape(2, 3, 3)
    assert er.sample(image, d).shape == (2, 3, c)
    assert er.sample(image, d).dtype == np.float32
    assert er.sample(image, d[0, 0]).shape == (c,)
    np.testing.assert_array_equal(er.sample(image[..., 0], d), er.sample(image, d)[..., 0])


def test_sample_is_linear_between_centres():
    image = np.arange(8.0)[None, :].repeat(4, axis=0)
    uv = er.uv_from_pixel([[2.25, 1], [5.75, 2]], 8, 4)
    np.testing.assert_allclose(er.sample(image, er.direction_from_uv(uv)), [2.25, 5.75], atol=ROUND_TRIP)


def test_sample_wraps_at_the_seam():
    image = np.arange(8.0)[None, :].repeat(4, axis=0)
    across = er.direction_from_uv(er.uv_from_pixel([[-0.25, 1], [7.25, 1], [-0.5, 1]], 8, 4))
    np.testing.assert_allclose(er.sample(image, across), [0.25 * 7, 0.75 * 7, 3.5], atol=ROUND_TRIP)


@pytest.mark.parametrize(("row", "edge"), [(0, 0.0), (3, 1.0)])
def test_sample_crosses_the_poles(row, edge):
    """At a pole, half of it comes from the pixel opposite; so the look-up is continuous through it."""
    image = np.random.default_rng(3).random((4, 8))
    at_pole = er.sample(image, er.direction_from_uv([[(i + 0.5) / 8, edge] for i in range(8)]))
    np.testing.assert_allclose(at_pole, (image[row] + np.roll(image[row], 4)) / 2, atol=ROUND_TRIP)
    one_side, other_side = er.direction_from_uv([[1.5 / 8, abs(edge - 1e-9)], [5.5 / 8, abs(edge - 1e-9)]])
    assert er.sample(image, one_side) == pytest.approx(er.sample(image, other_side), abs=ROUND_TRIP)


def test_sample_agrees_with_a_padded_image():
    """An independent look-up: pad by one pixel, then plain bilinear interpolation."""
    h, w = 6, 12
    image = np.random.default_rng(4).random((h, w))
    rows = np.vstack([np.roll(image[0], w // 2), image, np.roll(image[-1], w // 2)])
    padded = np.hstack([rows[:, -1:], rows, rows[:, :1]])
    d = random_directions(500, seed=5)
    x, y = er.pixel_from_uv(er.uv_from_direction(d), w, h).T + 1
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = x - i, y - j
    expected = (1 - b) * ((1 - a) * padded[j, i] + a * padded[j, i + 1])
    expected += b * ((1 - a) * padded[j + 1, i] + a * padded[j + 1, i + 1])
    np.testing.assert_allclose(er.sample(image, d), expected, atol=EXACT)


def test_infinite_depth_spreads_no_further_than_its_neighbours():
    depth = np.ones((4, 8), dtype=np.float32)
    depth[0] = np.inf
    i, j = np.meshgrid(np.arange(8), [0, 0.5, 1, 2])
    uv = er.uv_from_pixel(np.stack([i, j], axis=-1), 8, 4)
    d = er.direction_from_uv(uv)
    sampled = er.sample(depth, d)
    assert not np.isnan(sampled).any()
    assert np.isinf(sampled[:2]).all()
    np.testing.assert_array_equal(er.sample(depth, er.direction_from_uv([0.5, 0.6])), 1)


def test_many_directions_are_handled_in_blocks(monkeypatch):
    image = np.random.default_rng(6).random((4, 8, 3))
    d = random_directions(100)
    whole = er.sample(image, d)
    monkeypatch.setattr(er, "_BLOCK", 7)
    np.testing.assert_array_equal(er.sample(image, d), whole)


def test_odd_width_has_no_opposite_column():
    with pytest.raises(ValueError, match="width 5"):
        er.sample(np.ones((3, 5, 3)), (0, 0, 1))
