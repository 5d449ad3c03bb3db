"""Penrose samples of tiny maps: how many, where, how evenly, with what light."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light import penrose
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance, luminous_power
from expanded_panoramas.ibl_toolkit.light.penrose import penrose_points, penrose_sampling

WIDTH, HEIGHT = 256, 128
CLOSED = 1e-6  # energy, relative
SHARE = 0.05  # number of samples in a part of the map, relative: 3 sigma of 4,000 random ones
BLUE = 0.5  # chi square per cell, which is 1 for random samples of the right density
NEAREST_ON_SPHERE = 0.77  # mean angle to the nearest over that of a hexagonal lattice; random: 0.46


def grey(values):
    return np.repeat(np.asarray(values, dtype=np.float32)[..., None], 3, axis=2)


def constant():
    return np.ones((HEIGHT, WIDTH, 3), dtype=np.float32)


def smooth():
    """Two bright hills, 30 times above the ground, on a map whose density is known."""
    u, v = np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH, (np.arange(HEIGHT) + 0.5) / HEIGHT)
    narrow = np.exp(-((u - 0.3) ** 2 * 4 + (v - 0.4) ** 2) / 0.02)
    wide = np.exp(-((u - 0.7) ** 2 + (v - 0.6) ** 2) / 0.03)
    return grey(1 + 30 * (narrow + wide))


def two_levels():
    """The right half ten times as bright."""
    return grey(np.where(np.arange(WIDTH) < WIDTH // 2, 1.0, 10.0) * np.ones((HEIGHT, 1)))


def pixels(uv, image):
    height, width = image.shape[:2]
    return tuple(np.floor(np.asarray(uv) * (width, height)).astype(int).T[::-1])


def counts_and_expected(image, uv, density, cells=(8, 4)):
    """Samples per cell, cells of equal extent in u and v, and what the density would have on average."""
    u_cell, v_cell = (np.minimum((uv * cells).astype(int), np.subtract(cells, 1))).T
    counts = np.bincount(v_cell * cells[0] + u_cell, minlength=cells[0] * cells[1])
    blocks = density.astype(float).reshape(cells[1], HEIGHT // cells[1], cells[0], WIDTH // cells[0])
    expected = blocks.sum(axis=(1, 3)).ravel()
    return counts, expected / expected.sum() * len(uv)


def chi_square_per_cell(counts, expected):
    return ((counts - expected) ** 2 / expected).mean()


def nearest_angles(directions):
    cosine = directions @ directions.T
    np.fill_diagonal(cosine, -1)
    return np.arccos(np.clip(cosine.max(axis=1), -1, 1))


@pytest.mark.parametrize("count", [1, 2, 3, 10, 77, 500])
@pytest.mark.parametrize("image", [constant(), smooth()], ids=["constant", "smooth"])
def test_as_many_samples_as_asked_for_with_all_the_light(image, count):
    samples = penrose_sampling(image, count)
    assert len(samples) == count
    assert (samples.solid_angles > 0).all()
    np.testing.assert_allclose(samples.irradiance.sum(axis=0), irradiance(image), rtol=CLOSED)
    assert samples.solid_angles.sum() == pytest.approx(4 * np.pi, rel=CLOSED)
    assert set(np.unique(samples.partition)) == set(range(count))


@pytest.mark.parametrize("image", [smooth(), two_levels()], ids=["smooth", "two levels"])
@pytest.mark.parametrize("count", [700, 4000])
def test_density_follows_luminance_times_solid_angle(image, count):
    power = luminous_power(image)
    uv = penrose_points(power, count)
    assert chi_square_per_cell(*counts_and_expected(image, uv, power)) < BLUE
    # The same counts against the map without area deformation, or another map: the test can tell.
    assert chi_square_per_cell(*counts_and_expected(image, uv, image[..., 0])) > 2 * BLUE
    assert chi_square_per_cell(*counts_and_expected(image, uv, luminous_power(constant()))) > 2 * BLUE


def test_the_share_of_a_bright_half_is_its_share_of_light():
    uv = penrose_points(luminous_power(two_levels()), 4000)
    assert np.count_nonzero(uv[:, 0] >= 0.5) == pytest.approx(4000 * 10 / 11, rel=SHARE)
    assert np.count_nonzero(uv[:, 0] < 0.5) == pytest.approx(4000 / 11, rel=SHARE)


@pytest.mark.parametrize("count", [300, 1000, 2000])
def test_on_a_constant_map_samples_are_even_on_the_sphere(count):
    samples = penrose_sampling(constant(), count)
    angles = nearest_angles(samples.directions) / np.sqrt(4 * np.pi / count * 2 / np.sqrt(3))
    scattered = np.random.default_rng(4).normal(size=(count, 3))
    scattered /= np.linalg.norm(scattered, axis=1, keepdims=True)
    at_random = nearest_angles(scattered) / np.sqrt(4 * np.pi / count * 2 / np.sqrt(3))
    assert angles.mean() > NEAREST_ON_SPHERE > 1.5 * at_random.mean()
    assert angles.std() / angles.mean() < 0.5 * at_random.std() / at_random.mean()
    bands = np.histogram(samples.directions[:, 2], bins=10, range=(-1, 1))[0]  # of equal area
    assert chi_square_per_cell(bands, np.full(10, count / 10)) < BLUE
    assert samples.solid_angles.std() * count / (4 * np.pi) < 0.25  # 0.5 for random ones


def test_samples_are_ranked(monkeypatch):
    monkeypatch.setattr(penrose, "_corrections", lambda: np.zeros((21, 21)))
    power = luminous_power(smooth())
    np.testing.assert_array_equal(penrose_points(power, 1000)[:300], penrose_points(power, 300))
    half = penrose_points(power, 1000)[:500]
    assert chi_square_per_cell(*counts_and_expected(smooth(), half, power)) < BLUE


def test_a_bright_sun_gets_its_share_at_a_range_of_one_to_1e5():
    image = np.full((HEIGHT, WIDTH, 3), 0.01, dtype=np.float32)
    image[30:50, 60:80] = 1e3
    image[90:110, 150:170] = 1.0  # 1e-3 of the light: a byte would not see it
    power = luminous_power(image)
    uv = penrose_points(power, 300)
    in_sun = (image[pixels(uv, image)] == 1e3).all(axis=1)
    assert in_sun.sum() == pytest.approx(300 * power[30:50, 60:80].sum() / power.sum(), abs=2)
    dim = penrose_points(np.where(image[..., 0] < 1e3, power, 0), 100)
    in_window = (image[pixels(dim, image)] == 1.0).all(axis=1)
    assert 0 < in_window.sum() < 100
    share = power[90:110, 150:170].sum() / (power.sum() - power[30:50, 60:80].sum())
    assert in_window.sum() == pytest.approx(100 * share, rel=0.15)


@pytest.mark.parametrize(("row", "column"), [(0, 0), (HEIGHT - 1, 7), (40, WIDTH - 1), (64, 100)])
def test_a_hot_pixel_takes_one_sample_and_leaves_the_others_to_the_map(row, column):
    image = constant()
    image[row, column] = 1e8
    samples = penrose_sampling(image, 200)
    assert len(samples) == 200
    hot = samples.partition[row, column]
    assert np.array_equal(np.ravel(pixels(samples.uv[hot][None], image)), [row, column])
    assert samples.luminance[hot] == pytest.approx(luminous_power(image)[row, column], rel=0.01)
    others = np.delete(samples.directions, hot, axis=0)
    bands = np.histogram(others[:, 2], bins=5, range=(-1, 1))[0]
    assert chi_square_per_cell(bands, np.full(5, 199 / 5)) < BLUE


def test_no_pixel_has_two_samples_and_each_sample_keeps_its_own_pixel():
    image = np.full((32, 64, 3), 1e-3, dtype=np.float32)
    image[10:16, 20:30] = 100.0  # 60 pixels with nearly all the light
    samples = penrose_sampling(image, 150)
    rows, columns = pixels(samples.uv, image)
    assert len(set(zip(rows, columns, strict=True))) == len(samples) == 150
    np.testing.assert_array_equal(samples.partition[rows, columns], np.arange(150))
    assert (image[rows, columns, 0] == 100).sum() == 60


@pytest.mark.parametrize("shape", [(8, 16), (4, 12), (6, 8)])
def test_every_pixel_has_a_sample_when_there_are_as_many(shape):
    assert len(penrose_sampling(np.ones((*shape, 3)), shape[0] * shape[1] + 5)) == shape[0] * shape[1]


def test_a_mask_keeps_samples_and_light_inside():
    image = smooth()
    mask = image[..., 0] > 8
    samples = penrose_sampling(image, 60, mask)
    assert len(samples) == 60
    assert mask[pixels(samples.uv, image)].all()
    np.testing.assert_array_equal(samples.partition >= 0, mask)
    np.testing.assert_allclose(samples.irradiance.sum(axis=0), irradiance(image, mask), rtol=CLOSED)


@pytest.mark.parametrize(
    "chosen", [[(0, 0)], [(127, 255)], [(64, 0), (64, 255)], [(5, 9), (5, 10), (90, 200)]]
)
@pytest.mark.parametrize("count", [1, 2, 20])
def test_a_mask_of_a_few_pixels_gives_as_many_samples_as_it_has(chosen, count):
    mask = np.zeros((HEIGHT, WIDTH), dtype=bool)
    mask[tuple(np.transpose(chosen))] = True
    samples = penrose_sampling(smooth(), count, mask)
    assert len(samples) == min(count, len(chosen))
    assert mask[pixels(samples.uv, smooth())].all()
    np.testing.assert_allclose(samples.irradiance.sum(axis=0), irradiance(smooth(), mask), rtol=CLOSED)


def test_a_panorama_turned_by_whole_columns_has_its_samples_turned():
    image = smooth()
    image[:, 3] = 0.1  # the darkest meridian, where the seam goes
    plain, turned = (penrose_sampling(np.roll(image, k, axis=1), 50).uv for k in (0, 100))
    difference = (turned - plain - (100 / WIDTH, 0) + 0.5) % 1.0 - 0.5
    np.testing.assert_allclose(difference, 0, atol=1e-9)


def test_each_direction_is_nearest_to_its_own_pixel_once_settled():
    uv = np.array([[0.499, 0.51], [0.5005, 0.5], [0.7, 0.001], [0.2, 0.001]])  # crowded, and about a pole
    own = equirectangular.direction_from_uv((np.floor(uv * (32, 16)) + 0.5) / (32, 16))
    settled = penrose._settled(uv, 32, 16)
    np.testing.assert_array_equal(np.argmax(own @ settled.T, axis=1), np.arange(4))
    assert np.abs(settled - equirectangular.direction_from_uv(uv)).max() > 0  # and somebody had to move


def test_refusals():
    image = constant()
    with pytest.raises(ValueError, match="count is 0"):
        penrose_sampling(image, 0)
    with pytest.raises(ValueError, match="no light"):
        penrose_sampling(image, 5, np.zeros((HEIGHT, WIDTH), dtype=bool))
    with pytest.raises(ValueError, match="mask has shape"):
        penrose_sampling(image, 5, np.ones((3, 4), dtype=bool))
    with pytest.raises(ValueError, match="black"):
        penrose_sampling(0 * image, 5)
    with pytest.raises(ValueError, match="importance has shape"):
        penrose_points(image, 5)
    for wrong in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match=r"importance .* expected finite"):
            penrose_points(np.array([[1.0, wrong]]), 5)
    with pytest.raises(ValueError, match=r"importance is 0.0 to 0.0"):
        penrose_points(np.zeros((2, 4)), 5)
