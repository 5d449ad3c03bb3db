"""Moments of regions against a sum over all pixels, and where the lights of a map with depth are."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.light_map import luminous_power
from expanded_panoramas.ibl_toolkit.light.positions import mean_directions, moments, positions_at_depth
from expanded_panoramas.ibl_toolkit.light.samples import samples_from_sites

SUM = 1e-6
ANGLE = 1e-6  # [rad]
SIZE = 80, 40


@pytest.fixture
def image():
    return np.random.default_rng(0).random((40, 80, 3), dtype=np.float32)


def some_depth():
    rng = np.random.default_rng(1)
    depth = rng.uniform(1, 3, (40, 80))
    depth[rng.random((40, 80)) < 0.3] = np.inf
    return depth


@pytest.mark.parametrize("depth", [None, some_depth()])
def test_moments_are_sums_over_the_pixels(image, depth):
    partition = np.random.default_rng(2).integers(-1, 5, (40, 80)).astype(np.int32)
    partition[8:30] = -1
    length = np.ones((40, 80)) if depth is None else np.where(np.isfinite(depth), depth, 0)
    power = luminous_power(image).astype(float) * (length > 0)
    directions = equirectangular.pixel_directions(*SIZE).astype(float)
    found = moments(image, partition, 5, depth)
    for number in range(5):
        weights = power * (partition == number)
        expected = [weights.sum(), *np.einsum("rc,rck->k", weights * length, directions)]
        assert np.allclose(found[number], expected, rtol=SUM, atol=SUM)


def test_a_light_is_in_the_middle_of_its_regions_light(image):
    image[:] = 0
    image[12:15, 78:] = image[12:15, :4] = 5  # over the seam
    samples = samples_from_sites(image, [[-1, 0, 0.2]])
    (direction,) = mean_directions(image, samples)
    middle = equirectangular.direction_from_uv([1 / 80, 13.5 / 40])
    assert np.arctan2(direction[1], direction[0]) == pytest.approx(
        np.arctan2(middle[1], middle[0]), abs=ANGLE
    )
    assert direction @ middle > 0.999


def test_a_region_round_the_whole_sphere_keeps_its_direction():
    samples = samples_from_sites(np.ones((40, 80, 3), np.float32), [[0.6, 0, 0.8]])
    assert np.allclose(mean_directions(np.ones((40, 80, 3), np.float32), samples), [[0.6, 0, 0.8]])


def test_positions_lie_where_the_depth_says(image):
    """Regions on a floor 1.5 m below: their middles are on it."""
    directions = equirectangular.pixel_directions(*SIZE).astype(float)
    with np.errstate(divide="ignore"):
        depth = np.where(directions[..., 2] < 0, -1.5 / directions[..., 2], np.inf)
    mask = directions[..., 2] < -0.5
    samples = samples_from_sites(image, [[1, 0, -1], [-1, 0, -1], [0, 1, -2]], mask)
    assert np.allclose(positions_at_depth(image, samples, depth)[:, 2], -1.5)


def test_most_of_a_regions_light_must_have_depth(image):
    samples = samples_from_sites(image, [[1, 0, 0], [-1, 0, 0]])
    depth = np.full((40, 80), 2.0)
    depth[:, :20] = depth[:, 42:] = np.inf  # 22 of the 40 columns ahead have depth, none behind
    assert np.isnan(positions_at_depth(image, samples, depth)).any(axis=1).tolist() == [False, True]
    depth[:, 38:42] = np.inf  # 18 of 40
    assert np.isnan(positions_at_depth(image, samples, depth)).all()
