"""Directions <-> pixels of the 3 x 2 cube map: appendix A.3, edges, corners, solid angles, look-up."""

import itertools

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import cube_map as cm
from expanded_panoramas.ibl_toolkit import equirectangular as er

ROUND_TRIP = 1e-6
EXACT = 1e-12

# Centre of each face in the layout, and the direction at its right and its bottom edge: eq. A.29-A.34.
FACES = [
    ((1 / 6, 1 / 4), (1, 0, 0), (1, -1, 0), (1, 0, -1)),
    ((3 / 6, 1 / 4), (0, 1, 0), (1, 1, 0), (0, 1, -1)),
    ((5 / 6, 1 / 4), (0, 0, 1), (-1, 0, 1), (0, -1, 1)),
    ((1 / 6, 3 / 4), (-1, 0, 0), (-1, 1, 0), (-1, 0, -1)),
    ((3 / 6, 3 / 4), (0, -1, 0), (-1, -1, 0), (0, -1, -1)),
    ((5 / 6, 3 / 4), (0, 0, -1), (1, 0, -1), (0, -1, -1)),
]


def unit(d):
    d = np.asarray(d, dtype=float)
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def edges_and_corners(n=9):
    """Directions exactly on all edges and corners of the cube, and on the axes."""
    grid = itertools.product((-1, 0, 1), repeat=3)
    fine = [(a, b, t) for a in (-1, 1) for b in (-1, 1) for t in np.linspace(-1, 1, n)]
    rolled = [np.roll(d, k) for d in fine for k in range(3)]
    return unit([d for d in [*grid, *rolled] if np.any(d)])


def random_directions(count=2000, seed=0):
    return unit(np.random.default_rng(seed).normal(size=(count, 3)))


@pytest.mark.parametrize(("centre", "forward", "right", "down"), FACES)
def test_faces_lie_as_in_the_appendix(centre, forward, right, down):
    u, v = centre
    inside = 1e-9
    np.testing.assert_allclose(cm.direction_from_uv(centre), forward, atol=EXACT)
    np.testing.assert_allclose(cm.direction_from_uv((u + 1 / 6 - inside, v)), unit(right), atol=ROUND_TRIP)
    np.testing.assert_allclose(cm.direction_from_uv((u, v + 1 / 4 - inside)), unit(down), atol=ROUND_TRIP)
    np.testing.assert_allclose(cm.uv_from_direction(np.multiply(forward, 7)), centre, atol=EXACT)


@pytest.mark.parametrize("directions", [random_directions(), edges_and_corners()], ids=["random", "edges"])
def test_directions_survive_uv_and_pixels(directions):
    uv = cm.uv_from_direction(directions)
    assert np.all((uv >= 0) & (uv < 1))
    np.testing.assert_allclose(cm.direction_from_uv(uv), directions, atol=ROUND_TRIP)
    again = cm.uv_from_pixel(cm.pixel_from_uv(uv, 96, 64), 96, 64)
    # a pixel coordinate on a face's far edge is only good to rounding: compare away from there
    inner = np.all(np.abs(uv * (3, 2) - np.round(uv * (3, 2))) > 1e-9, axis=-1)
    np.testing.assert_allclose(cm.direction_from_uv(again)[inner], directions[inner], atol=ROUND_TRIP)


def test_every_pixel_centre_survives():
    n = 5
    ij = np.stack(np.meshgrid(np.arange(3 * n), np.arange(2 * n)), axis=-1)
    d = cm.direction_from_uv(cm.uv_from_pixel(ij, 3 * n, 2 * n))
    np.testing.assert_allclose(cm.pixel_from_uv(cm.uv_from_direction(d), 3 * n, 2 * n), ij, atol=ROUND_TRIP)
    np.testing.assert_allclose(cm.pixel_directions(n), d, atol=2e-7)
    assert not cm.pixel_directions(n).flags.writeable


def test_outer_corner_of_the_image_belongs_to_the_last_face():
    np.testing.assert_allclose(cm.direction_from_uv((1, 1)), unit((1, -1, -1)), atol=EXACT)


@pytest.mark.parametrize("n", [1, 2, 3, 64, 1024])
def test_solid_angles_make_a_sphere(n):
    assert cm.solid_angles(n).shape == (2 * n, 3 * n)
    assert cm.solid_angles(n).sum() == pytest.approx(4 * np.pi, rel=EXACT)


def test_solid_angles_follow_the_density():
    """Small pixels: area times cos^3 of the angle to the face's axis (at most 3 sqrt 3, appendix A.3)."""
    n = 256
    d = cm.pixel_directions(n).astype(float)
    expected = (2 / n) ** 2 * np.abs(d).max(axis=-1) ** 3
    np.testing.assert_allclose(cm.solid_angles(n), expected, rtol=1e-4)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_sample_returns_the_pixels_at_their_centres(n):
    cube = np.random.default_rng(1).random((2 * n, 3 * n, 3))
    d = cm.direction_from_uv(
        cm.uv_from_pixel(np.stack(np.meshgrid(np.arange(3 * n), np.arange(2 * n)), -1), 3 * n, 2 * n)
    )
    np.testing.assert_allclose(cm.sample(cube, d), cube, atol=ROUND_TRIP)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_sample_is_continuous_across_edges_and_corners(n):
    cube = np.random.default_rng(2).random((2 * n, 3 * n, 2))
    at = edges_and_corners(4 * n + 1)
    for nudge in np.random.default_rng(3).normal(size=(4, 3)) * 1e-9:
        np.testing.assert_allclose(cm.sample(cube, at + nudge), cm.sample(cube, at), atol=1e-6)


def test_sample_on_an_edge_is_the_mean_of_both_sides():
    """The edge between +x (its right column) and -y (its left column), at the rows' centres."""
    n = 4
    cube = np.random.default_rng(4).random((2 * n, 3 * n))
    rows = 1 - (2 * np.arange(n) + 1) / n
    d = np.stack([np.ones(n), -np.ones(n), rows], axis=-1)
    np.testing.assert_allclose(cm.sample(cube, d), (cube[:n, n - 1] + cube[n:, n]) / 2, atol=ROUND_TRIP)


def test_sample_on_an_edge_between_turned_faces():
    """The edge between +y (its top row) and +z (its top row): the columns run against each other."""
    n = 4
    cube = np.random.default_rng(5).random((2 * n, 3 * n))
    x = (2 * np.arange(n) + 1) / n - 1
    d = np.stack([x, np.ones(n), np.ones(n)], axis=-1)
    expected = (cube[0, n : 2 * n] + cube[0, 2 * n :][::-1]) / 2
    np.testing.assert_allclose(cm.sample(cube, d), expected, atol=ROUND_TRIP)


def test_sample_at_a_corner_is_the_mean_of_three():
    """(1, 1, 1): top left of +x, top right of +y, and the top left of +z, which sees +x left and +y up."""
    n = 3
    cube = np.random.default_rng(6).random((2 * n, 3 * n))
    expected = (cube[0, 0] + cube[0, 2 * n - 1] + cube[0, 2 * n]) / 3
    assert cm.sample(cube, (1, 1, 1)) == pytest.approx(expected, abs=ROUND_TRIP)


def test_sample_of_a_smooth_field_has_no_seams():
    """cube[d] = d: second order inside the faces, first order with a small factor between two faces."""
    n = 32
    d = random_directions(5000)
    error = np.abs(cm.sample(cm.pixel_directions(n), d) - d).max(axis=-1)
    from_axis = np.sort(np.abs(d), axis=-1)
    inside = from_axis[:, 1] < (1 - 1 / n) * from_axis[:, 2]
    assert error[inside].max() < 1 / n**2
    assert error[~inside].max() < 0.25 / n
    on_edges = edges_and_corners()
    assert np.abs(cm.sample(cm.pixel_directions(n), on_edges) - on_edges).max() < 0.4 / n


def test_resampling_there_and_back():
    """A smooth image: low spherical harmonics."""
    x, y, z = np.moveaxis(er.pixel_directions(128, 64), -1, 0)
    image = np.stack([1 + x, 2 + y * z, 1 + x * y], axis=-1)
    cube = cm.from_equirectangular(image, 48)
    assert cube.shape == (96, 144, 3)
    np.testing.assert_allclose(cm.to_equirectangular(cube, 128, 64), image, atol=5e-3)


@pytest.mark.parametrize("shape", [(4, 4, 3), (3, 4, 3), (0, 0, 3), (2, 6, 3)])
def test_refuses_what_is_not_three_by_two(shape):
    with pytest.raises(ValueError, match=f"{shape[1]} x {shape[0]} px"):
        cm.sample(np.ones(shape), (1, 0, 0))
