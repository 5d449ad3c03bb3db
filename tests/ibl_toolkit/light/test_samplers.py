"""What all samplers promise: the light of the map, a partition of the mask, evenness on an even map."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light import median_cut as cuts
from expanded_panoramas.ibl_toolkit.light.importance import importance_sampling
from expanded_panoramas.ibl_toolkit.light.light_map import luminous_power
from expanded_panoramas.ibl_toolkit.light.samples import (
    combined,
    samples_from_partition,
    samples_from_sites,
)

ENERGY = 1e-6
"""The issue's; relative, per channel."""
ROUNDING = 1e-12
SAMPLERS = (cuts.median_cut, cuts.variance_cut, importance_sampling)
SHAPE = 15, 32


def light(kind):
    rng = np.random.default_rng(5)
    if kind == "real range":  # five decades between the darkest and the brightest
        image = 10 ** rng.uniform(-3, 2, (*SHAPE, 3))
    elif kind == "hot pixel":
        image = np.full((*SHAPE, 3), 1e-3)
        image[5, 0] = 1e5, 5e4, 1e4
    elif kind == "black but one":
        image = np.zeros((*SHAPE, 3))
        image[5, 0] = 1e5, 5e4, 1e4
    elif kind == "black but two in a row":
        image = np.zeros((*SHAPE, 3))
        image[0, 5:7] = 1, 2, 3
    elif kind == "red":  # luminance follows one channel; the others must close too
        image = rng.random((*SHAPE, 3)) * [1, 1e-6, 0]
    else:
        image = {"constant": np.ones((*SHAPE, 3)), "noise": rng.random((*SHAPE, 3))}[kind]
    return image.astype(np.float32)


KINDS = ("constant", "noise", "real range", "hot pixel", "black but one", "black but two in a row", "red")


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 2, 7, 64, 500])
def test_samples_hold_the_light_of_the_map(sampler, kind, count):
    image = light(kind)
    assert_sound(sampler(image, count), image, np.ones(SHAPE, bool), count)


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize("kind", ["noise", "hot pixel"])
def test_a_mask_is_kept_to(sampler, kind):
    image = light(kind)
    mask = np.zeros(SHAPE, bool)
    mask[3:8, :3] = mask[4:9, -5:] = mask[11, 20] = mask[0] = True
    assert_sound(sampler(image, 12, mask), image, mask, 12)


def assert_sound(samples, image, mask, count):
    solid_angles = equirectangular.row_solid_angles(*SHAPE[::-1])[:, None] * mask
    total = np.einsum("ijk,ij->k", image.astype(float), solid_angles)
    assert samples.irradiance.sum(axis=0) == pytest.approx(total, rel=ENERGY)
    assert samples.solid_angles.sum() == pytest.approx(solid_angles.sum(), rel=ENERGY)
    assert 1 <= len(samples) <= count
    assert np.array_equal(samples.partition >= 0, mask)
    assert np.array_equal(np.unique(samples.partition[mask]), np.arange(len(samples)))
    assert samples.luminance.min() > 0
    assert np.linalg.norm(samples.directions, axis=1) == pytest.approx(1, abs=ROUNDING)
    assert equirectangular.direction_from_uv(samples.uv) == pytest.approx(samples.directions, abs=ROUNDING)
    for number in (0, len(samples) - 1):  # each has the light of its own region
        own = np.einsum("ijk,ij->k", image.astype(float), solid_angles * (samples.partition == number))
        assert samples.irradiance[number] == pytest.approx(own, rel=ENERGY, abs=1e-30)


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_as_many_as_asked_for_where_there_is_light_for_all(sampler):
    assert [len(sampler(light("noise"), count)) for count in (1, 3, 16, 17)] == [1, 3, 16, 17]


@pytest.mark.parametrize("sampler", [cuts.median_cut, cuts.variance_cut])
def test_cuts_go_on_to_the_last_pixel(sampler):
    image = light("noise")[:4, :8]
    samples = sampler(image, 1000)
    assert len(samples) == 32
    ij = np.argwhere(samples.partition >= 0)[np.argsort(samples.partition.ravel())][:, ::-1]
    assert samples.uv == pytest.approx(equirectangular.uv_from_pixel(ij, 8, 4), abs=ROUNDING)


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_one_lamp_is_found_where_it_is(sampler):
    image = light("hot pixel")
    strongest = np.argmax(sampler(image, 50).luminance)
    direction = equirectangular.direction_from_uv(equirectangular.uv_from_pixel([0, 5], *SHAPE[::-1]))
    cosine = sampler(image, 50).directions[strongest] @ direction
    assert cosine > np.cos(np.pi / SHAPE[0])


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_a_lamp_at_the_zenith_shines_down(sampler):
    image = np.full((*SHAPE, 3), 1e-6, np.float32)
    image[0] = 1
    samples = sampler(image, 8)
    assert samples.luminance @ samples.directions[:, 2] > 0.99 * samples.luminance.sum()


def band_counts(directions, bands=8, sectors=8):
    """Samples per field of equal area."""
    uv = equirectangular.uv_from_direction(directions)
    band = np.minimum((directions[:, 2] + 1) / 2 * bands, bands - 1).astype(int)
    return np.bincount(band * sectors + (uv[:, 0] * sectors).astype(int), minlength=bands * sectors)


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_samples_of_an_even_map_are_even_on_the_sphere(sampler):
    counts = band_counts(sampler(np.ones((128, 256, 3), np.float32), 1024).directions)
    assert counts.sum() >= 1000
    assert counts.min() >= 8  # 16 if they were perfectly even
    assert counts.max() <= 24


def test_evenness_in_the_image_is_not_evenness_on_the_sphere():
    """The check above fails for samples that are even in the image."""
    u, v = np.meshgrid((np.arange(46) + 0.5) / 46, (np.arange(23) + 0.5) / 23)
    counts = band_counts(equirectangular.direction_from_uv(np.stack([u, v], axis=2).reshape(-1, 2)))
    assert counts.max() > 24


@pytest.mark.parametrize("sampler", [cuts.median_cut, cuts.variance_cut])
def test_regions_of_an_even_map_are_of_one_size(sampler):
    solid_angles = sampler(np.ones((128, 256, 3), np.float32), 64).solid_angles * 64 / (4 * np.pi)
    assert solid_angles.min() > 1 / 1.6
    assert solid_angles.max() < 1.6


def test_sites_without_pixels_or_light_are_dropped():
    image = light("noise")
    image[:, :16] = 0
    directions = [[0, 1, 0], [0.1, 1, 0], [0, -1, 0], [0, -2, 0], [0, 0, -1]]
    samples = samples_from_sites(image, directions)
    assert samples.directions == pytest.approx(np.array([[0, -1, 0], [0, 0, -1]]))
    assert_sound(samples, image, np.ones(SHAPE, bool), 5)


def test_merged_samples_keep_their_light():
    image = light("noise")
    samples = samples_from_sites(image, np.random.default_rng(0).normal(size=(6, 3)))
    merged = combined(samples, [1, 0, 1, 0, 1, 1], [[0, 0, 2], [1, 0, 0]])
    assert_sound(merged, image, np.ones(SHAPE, bool), 2)
    assert np.array_equal(merged.partition == 0, np.isin(samples.partition, [1, 3]))


def test_dropped_samples_leave_their_pixels():
    image = light("noise")
    samples = samples_from_sites(image, [[1, 0, 0], [-1, 0, 0], [0, 0, 1]])
    rest = combined(samples, [0, -1, 1], [[1, 0, 0], [0, 0, 1]])
    assert_sound(rest, image, samples.partition != 1, 2)


def test_groups_that_fit_nothing_are_refused():
    samples = samples_from_sites(light("noise"), [[1, 0, 0], [-1, 0, 0]])
    with pytest.raises(ValueError, match="groups"):
        combined(samples, [0, 1], [[1, 0, 0]])
    with pytest.raises(ValueError, match="groups"):
        combined(samples, [0], [[1, 0, 0]])


def test_a_partition_must_fit():
    image = light("noise")
    with pytest.raises(ValueError, match="partition has shape"):
        samples_from_partition(image, [[0.5, 0.5]], np.zeros((2, 2), np.int32))
    with pytest.raises(ValueError, match="region 1"):
        samples_from_partition(image, [[0.5, 0.5]], np.ones(SHAPE, np.int32))


def test_power_is_what_the_samples_divide():
    image = light("noise")
    assert cuts.median_cut(image, 9).luminance.sum() == pytest.approx(
        luminous_power(image).sum(dtype=float), rel=ENERGY
    )
