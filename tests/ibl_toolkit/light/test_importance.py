"""The density of the drawn directions against the map's luminance on the sphere."""

import numpy as np

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.importance import draw, importance_sampling
from expanded_panoramas.ibl_toolkit.light.light_map import luminance, luminous_power

LEAST_EXPECTED = 5
"""Fields where fewer samples are expected are taken together."""
MOST_DEVIATION = 3.7
"""Standard deviations of a normal variable: one good density in 10,000 would be refused."""
SHAPE = 16, 32
EXACT = 1e-12


def map_of(seed=3):
    return np.random.default_rng(seed).lognormal(0, 1.2, (*SHAPE, 3)).astype(np.float32)


def deviation(counts, expected):
    """How far χ² of counts is above its mean, as of a normal variable (Wilson and Hilferty 1931)."""
    order = np.argsort(expected.ravel())
    counts, expected = counts.ravel()[order], expected.ravel()[order]
    rare = np.searchsorted(np.cumsum(expected), LEAST_EXPECTED) + 1
    starts = np.append(0, np.arange(max(rare, np.searchsorted(expected, LEAST_EXPECTED)), len(expected)))
    counts, expected = np.add.reduceat(counts, starts), np.add.reduceat(expected, starts)
    assert expected.min() >= LEAST_EXPECTED
    freedom = len(expected) - 1
    ratio = np.sum((counts - expected) ** 2 / expected) / freedom
    return (np.cbrt(ratio) - 1 + 2 / (9 * freedom)) / np.sqrt(2 / (9 * freedom))


def counted(power, count, runs, seed=0):
    """Samples per pixel, by direction, of some runs."""
    rng = np.random.default_rng(seed)
    counts = np.zeros(SHAPE)
    for _ in range(runs):
        _, _, directions = draw(power, count, rng)
        ij = equirectangular.pixel_from_uv(equirectangular.uv_from_direction(directions), *SHAPE[::-1])
        columns, rows = np.rint(ij).astype(int).T % [[SHAPE[1]], [SHAPE[0]]]
        np.add.at(counts, (rows, columns), 1)
    return counts


def expected_of(power, total):
    return power.astype(float) * (total / power.sum(dtype=float))


def test_the_density_is_luminance_on_the_sphere():
    power = luminous_power(map_of())
    for count, runs in ((20000, 1), (20, 500), (7, 1000)):
        found = deviation(counted(power, count, runs), expected_of(power, count * runs))
        assert found < MOST_DEVIATION, f"{runs} runs of {count}"


def test_a_density_without_the_area_deformation_fails_the_same_check():
    image = map_of()
    for count, runs in ((20000, 1), (20, 500)):
        found = deviation(
            counted(luminance(image), count, runs), expected_of(luminous_power(image), count * runs)
        )
        assert found > 3 * MOST_DEVIATION, f"{runs} runs of {count}"


def test_a_slightly_wrong_density_fails_too():
    """Many runs of few samples, whose stratification does not cover up for it."""
    power = luminous_power(map_of())
    brighter = power * np.where(np.arange(SHAPE[1]) < SHAPE[1] // 2, 1.5, 1.0)
    assert deviation(counted(brighter, 20, 500), expected_of(power, 10000)) > MOST_DEVIATION


def test_inside_a_pixel_samples_are_even_in_solid_angle():
    """Two pixels over each other: hemispheres."""
    _, _, directions = draw(np.ones((2, 1)), 4000, np.random.default_rng(1))
    heights, _ = np.histogram(directions[:, 2], 40, (-1, 1))
    azimuths, _ = np.histogram(np.arctan2(directions[:, 1], directions[:, 0]), 40, (-np.pi, np.pi))
    even = np.full(40, 100.0)
    assert deviation(heights, even) < MOST_DEVIATION
    assert deviation(azimuths, even) < MOST_DEVIATION
    elevations, _ = np.histogram(np.arcsin(directions[:, 2]), 40, (-np.pi / 2, np.pi / 2))
    assert deviation(elevations, even) > MOST_DEVIATION


def test_samples_lie_in_the_pixel_they_were_drawn_from():
    power = luminous_power(map_of())
    rows, columns, directions = draw(power, 500, np.random.default_rng(2))
    ij = equirectangular.pixel_from_uv(equirectangular.uv_from_direction(directions), *SHAPE[::-1])
    assert np.abs(ij - np.stack([columns, rows], axis=1)).max() <= 0.5 + EXACT


def test_black_pixels_are_never_drawn():
    power = luminous_power(map_of())
    power[:, ::2] = power[:5] = power[12:] = 0
    rows, columns, _ = draw(power, 5000, np.random.default_rng(0))
    assert power[rows, columns].min() > 0


def test_a_seed_repeats_the_samples_and_another_does_not():
    image = map_of()
    first, again, other = (importance_sampling(image, 20, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(first.directions, again.directions)
    assert not np.allclose(first.directions, other.directions)


def test_samples_of_one_pixel_are_one():
    image = map_of()
    image[4, 7] = 1e9
    samples = importance_sampling(image, 100)
    assert len(samples) < 5
