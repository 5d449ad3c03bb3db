"""Clustering against one that looks at every pair each time, and its two criteria for stopping."""

import time

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.light.clustering import FREQUENCIES, cluster
from expanded_panoramas.ibl_toolkit.light.light_map import LUMINANCE
from expanded_panoramas.ibl_toolkit.light.samples import LightSamples, samples_from_sites

ENERGY = 1e-9
ANGLE = 1e-6  # [rad]
SECONDS = 2.0  # the aim of the issue; five times as long where the machine is busy


def scattered(count, seed=0):
    """Samples with one pixel each: the partition then tells who was merged."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    partition = np.arange(count, dtype=np.int32).reshape(2, -1)
    power = rng.lognormal(0, 1.5, (count, 3))
    return LightSamples(np.zeros((count, 2)), directions, power, rng.uniform(0.1, 1, count), partition)


def pairwise_by_force(samples, count, frequency):
    """The printed method: E of all pairs, again after each merging."""
    power = samples.irradiance @ LUMINANCE
    above = {"F1": np.ones(len(samples)), "F2": power, "F3": power}[frequency]
    below = samples.solid_angles if frequency == "F3" else np.ones(len(samples))
    clusters = [
        (c, a, b, {k}) for k, (c, a, b) in enumerate(zip(samples.directions, above, below, strict=True))
    ]
    while len(clusters) > count:
        _, i, j = min(
            (printed_error(clusters[i], clusters[j], frequency), i, j)
            for i in range(len(clusters))
            for j in range(i + 1, len(clusters))
        )
        (ci, ai, bi, who_i), (cj, aj, bj, who_j) = clusters[i], clusters.pop(j)
        mean = ai / bi * ci + aj / bj * cj
        kept = bi + bj if frequency == "F3" else 1
        clusters[i] = mean / np.linalg.norm(mean), ai + aj, kept, who_i | who_j
    return clusters


def printed_error(one, other, frequency):
    """E(c_i, c_j) as section 3.2.3 prints it."""
    (ci, ai, bi, _), (cj, aj, bj, _) = one, other
    f, g = ai / bi, aj / bj
    return (f * g**2 + g * f**2) / (f + g) ** 2 * np.arccos(np.clip(ci @ cj, -1, 1)) ** 2


@pytest.mark.parametrize("frequency", FREQUENCIES)
@pytest.mark.parametrize("count", [30, 9, 1])
def test_it_merges_the_pairs_that_the_printed_error_chooses(frequency, count):
    many = scattered(40)
    few = cluster(many, count, frequency=frequency)
    expected = {frozenset(who): c for c, _, _, who in pairwise_by_force(many, count, frequency)}
    groups = [frozenset(np.flatnonzero(few.partition.ravel() == k).tolist()) for k in range(count)]
    assert set(groups) == set(expected)
    for group, direction, irradiance, solid_angle in zip(
        groups, few.directions, few.irradiance, few.solid_angles, strict=True
    ):
        members = sorted(group)
        assert np.allclose(direction, expected[group], atol=ANGLE)
        assert np.allclose(irradiance, many.irradiance[members].sum(axis=0), rtol=ENERGY)
        assert solid_angle == pytest.approx(many.solid_angles[members].sum(), rel=ENERGY)


def test_a_least_angle_leaves_none_nearer_and_keeps_those_that_are_apart():
    few = cluster(scattered(200, 3), least_angle=0.4)
    angles = np.arccos(np.clip(few.directions @ few.directions.T, -1, 1))[~np.eye(len(few), dtype=bool)]
    assert angles.min() >= 0.4
    assert 20 < len(few) < 120
    apart = LightSamples(
        np.zeros((3, 2)), np.eye(3), np.ones((3, 3)), np.ones(3), np.array([[0, 1], [2, 2]], np.int32)
    )
    assert len(cluster(apart, least_angle=1.5)) == 3
    assert len(cluster(apart, least_angle=1.6)) < 3


def test_with_both_criteria_the_first_that_is_met_ends_it():
    many = scattered(200, 3)
    by_angle = len(cluster(many, least_angle=0.4))
    assert len(cluster(many, by_angle + 20, least_angle=0.4)) == by_angle + 20
    assert len(cluster(many, by_angle - 10, least_angle=0.4)) == by_angle


def test_f2_joins_dim_samples_and_f1_near_ones():
    directions = np.array([[1, 0, 0], [1, 0.2, 0], [-1, 0, 0], [-1, 0.3, 0]])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    power = np.array([[10.0], [10.0], [0.1], [0.1]]) * np.ones(3)
    samples = LightSamples(
        np.zeros((4, 2)), directions, power, np.ones(4), np.arange(4, dtype=np.int32).reshape(2, 2)
    )
    assert cluster(samples, 3, frequency="F1").partition.tolist() == [[0, 0], [1, 2]]
    assert cluster(samples, 3, frequency="F2").partition.tolist() == [[0, 1], [2, 2]]


def test_very_strong_samples_are_merged_too():
    many = scattered(30)
    strong = LightSamples(many.uv, many.directions, many.irradiance * 1e60, many.solid_angles, many.partition)
    assert np.array_equal(cluster(strong, 5).partition, cluster(many, 5).partition)


def test_opposite_samples_of_equal_power_become_one():
    pair = LightSamples(
        np.zeros((2, 2)), np.array([[1.0, 0, 0], [-1, 0, 0]]), np.ones((2, 3)), np.ones(2),
        np.array([[0, 1]], np.int32),
    )  # fmt: skip
    assert np.linalg.norm(cluster(pair, 1).directions) == pytest.approx(1)


def test_what_is_outside_the_mask_stays_there():
    image = np.random.default_rng(0).random((16, 32, 3), dtype=np.float32)
    mask = np.zeros((16, 32), bool)
    mask[4:9, 28:] = mask[4:9, :6] = True
    rng = np.random.default_rng(1)
    few = cluster(samples_from_sites(image, rng.normal((-3, 0, 0), size=(30, 3)), mask), 4)
    assert ((few.partition >= 0) == mask).all()
    assert set(np.unique(few.partition)) == {-1, 0, 1, 2, 3}


def test_4096_samples_become_64_in_two_seconds():
    many = scattered(4096)
    start = time.perf_counter()
    few = cluster(many, 64)
    assert time.perf_counter() - start < 5 * SECONDS
    assert len(few) == 64
    assert np.allclose(few.irradiance.sum(axis=0), many.irradiance.sum(axis=0), rtol=ENERGY)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frequency": "F4", "count": 2}, "frequency is 'F4': must be one of F1, F2, F3"),
        ({}, "neither count nor least_angle"),
        ({"count": 0}, "count is 0: at least 1"),
        ({"least_angle": 0}, "least_angle is 0 rad: must be above 0"),
        ({"least_angle": 4}, "at most π"),
    ],
)
def test_what_makes_no_sense_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        cluster(scattered(4), **changes)
