"""The cuts: half of the power on either side, the least variance of all cuts, the seam and the poles."""

import importlib.util
import pathlib

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.light_map import luminous_power
from expanded_panoramas.ibl_toolkit.light.median_cut import median_cut, variance_cut
from expanded_panoramas.ibl_toolkit.light.power_tables import PowerTables

ROUNDING = 1e-9
CUTS = (median_cut, variance_cut)


def noise(height=40, width=80, seed=0, sigma=1.5):
    return np.random.default_rng(seed).lognormal(0, sigma, (height, width, 3)).astype(np.float32)


def variance(image, partition):
    """Total variance of the regions on the sphere, from the pixels: Σ P |ω − m|²."""
    height, width = partition.shape
    power = luminous_power(image).astype(float)
    directions = equirectangular.pixel_directions(width, height).astype(float)
    total = 0.0
    for number in range(partition.max() + 1):
        weights, vectors = power[partition == number], directions[partition == number]
        mean = weights @ vectors / weights.sum()
        total += weights @ np.sum((vectors - mean) ** 2, axis=1)
    return total


@pytest.mark.parametrize("seed", range(5))
def test_a_median_cut_halves_the_power_within_one_line(seed):
    image = noise(seed=seed)
    one, other = (luminous_power(image)[median_cut(image, 2).partition == k].sum() for k in (0, 1))
    lines = max(luminous_power(image).sum(axis=axis).max() for axis in (0, 1))
    assert abs(one - other) <= lines


def test_median_cut_samples_are_equally_strong():
    strengths = median_cut(noise(128, 256, sigma=0.5), 64).luminance
    assert strengths.max() < 1.2 * strengths.min()


def test_a_median_cut_goes_across_the_longer_side():
    """First the sphere's girth of 2π · 2/π, then lines of a hemisphere as high as it is wide at most."""
    image = np.ones((64, 128, 3), np.float32)
    halves, quarters = median_cut(image, 2).partition, median_cut(image, 4).partition
    assert (halves == halves[:1]).all()
    assert (quarters != quarters[:1]).any()


def test_near_a_pole_azimuth_counts_little():
    """Of two patches of the top rows, 4 and 7 times as wide in the image as high, one is higher than wide."""
    image = np.zeros((64, 128, 3), np.float32)
    image[1:8, 20:50] = 1
    partition = median_cut(image, 2).partition[1:8, 20:50]
    assert (partition == partition[:, :1]).all()
    image[1:8, 20:70] = 1
    partition = median_cut(image, 2).partition[1:8, 20:70]
    assert (partition == partition[:1]).all()


def test_black_surroundings_do_not_make_a_side_longer():
    """A lamp wider than high, in the half that another lamp's height had made higher than wide."""
    image = np.zeros((40, 80, 3), np.float32)
    image[30:32, 10:20] = image[5:9, 60:64] = 1
    power = luminous_power(image)
    image[5:9, 60:64] *= 0.99 * power[30:32].sum() / power[5:9].sum()  # so that the first cut parts the lamps
    lamp = median_cut(image, 3).partition[30:32, 10:20]
    assert len(np.unique(lamp)) == 2
    assert (lamp == lamp[:1]).all()


@pytest.mark.parametrize("cut", CUTS)
def test_a_cut_between_two_lamps_keeps_off_both(cut):
    image = np.zeros((40, 80, 3), np.float32)
    image[18:22, 10:14] = image[18:22, 50:54] = 1
    partition = cut(image, 2).partition
    assert (partition[:, :32] == partition[18, 10]).all()
    assert (partition[:, 32:60] == partition[18, 50]).all()


@pytest.mark.parametrize("seed", range(5))
def test_the_first_variance_cut_is_the_best_of_all(seed):
    image = noise(12, 24, seed)
    shift = PowerTables(image).shift
    rows, columns = np.mgrid[:12, :24]
    turned = (columns - shift) % 24
    every = [rows < line for line in range(1, 12)] + [turned < line for line in range(1, 24)]
    best = min(variance(image, part.astype(int)) for part in every)
    assert variance(image, variance_cut(image, 2).partition) == pytest.approx(best, rel=ROUNDING)


def test_a_variance_cut_parts_two_lamps_where_a_median_cut_halves_one():
    image = np.zeros((40, 80, 3), np.float32)
    image[18:22, 10:14], image[18:22, 50:54] = 9, 1
    weak = image[..., 0] == 1
    for cut, is_parted in ((median_cut, False), (variance_cut, True)):
        partition = cut(image, 2).partition
        strong = np.unique(partition[image[..., 0] == 9])
        assert (len(strong) == 1 and strong[0] not in partition[weak]) == is_parted


@pytest.mark.parametrize("name", ["interior", "city", "studio"])
def test_variance_cuts_vary_less_on_real_maps(name):
    spec = importlib.util.find_spec("bpy")
    found = (
        pathlib.Path(spec.origin).parent.glob(f"*/datafiles/studiolights/world/{name}.exr") if spec else ()
    )
    path = next(iter(found), None)
    if path is None:
        pytest.skip("no bpy wheel")
    image = read_panorama(path)[::4, ::4].copy()
    for count in (8, 64):
        least, median = (variance(image, cut(image, count).partition) for cut in (variance_cut, median_cut))
        assert least < 0.9 * median


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("columns", [1, 39, 60])
def test_a_turned_panorama_has_turned_samples(cut, columns):
    """So nothing depends on where the image was cut open."""
    image = noise()
    image[10:14, 38:46] += 1000  # a lamp across the edge once turned by 39 columns
    one, other = cut(image, 21), cut(np.roll(image, columns, axis=1), 21)
    assert np.array_equal(np.roll(one.partition, columns, axis=1), other.partition)
    turned = (one.uv[:, 0] + columns / 80) % 1
    assert other.uv == pytest.approx(np.column_stack([turned, one.uv[:, 1]]), abs=1e-6)


@pytest.mark.parametrize("cut", CUTS)
def test_regions_are_rectangles_that_may_pass_the_images_edge(cut):
    image = noise()
    shift = PowerTables(image).shift
    partition = np.roll(cut(image, 33).partition, -shift, axis=1)
    for number in range(33):
        rows, columns = np.nonzero(partition == number)
        assert len(rows) == (np.ptp(rows) + 1) * (np.ptp(columns) + 1)


@pytest.mark.parametrize("cut", CUTS)
def test_a_sample_lies_at_the_mean_direction_of_its_power(cut):
    image = noise()
    samples = cut(image, 10)
    power, directions = luminous_power(image), equirectangular.pixel_directions(80, 40)
    for number in range(10):
        chosen = samples.partition == number
        mean = power[chosen] @ directions[chosen]
        assert samples.directions[number] == pytest.approx(mean / np.linalg.norm(mean), abs=1e-5)


def test_light_without_a_mean_direction_goes_to_its_brightest_pixel():
    image = np.ones((8, 16, 3), np.float32)
    image[3, 5] *= 1 + 2e-6
    image[4, 13] *= 1 + 1e-6
    expected = equirectangular.uv_from_pixel([5, 3], 16, 8)
    assert median_cut(image, 1).uv[0] == pytest.approx(expected, abs=ROUNDING)


@pytest.mark.parametrize("masked", [False, True])
def test_profiles_of_any_rectangle(masked):
    """Against sums of the pixels, also where whole steps of the tables are in it and round the edge."""
    image = noise(100, 90)
    mask = np.random.default_rng(1).random((100, 90)) < 0.5 if masked else None
    tables = PowerTables(image, mask)
    power = np.roll(luminous_power(image, mask), -tables.shift, axis=1).astype(float)
    vectors = np.roll(equirectangular.pixel_directions(90, 100), -tables.shift, axis=1).astype(float)
    sums = np.concatenate([power[..., None], power[..., None] * vectors], axis=2)
    for top, bottom, left, right in [(0, 100, 0, 90), (3, 99, 1, 80), (40, 50, 60, 90), (32, 64, 5, 6)]:
        part = sums[top:bottom, left:right]
        assert tables.by_row((top, bottom, left, right)) == pytest.approx(
            part.sum(axis=1), rel=1e-4, abs=1e-6
        )
        assert tables.by_column((top, bottom, left, right)) == pytest.approx(
            part.sum(axis=0), rel=1e-4, abs=1e-6
        )
