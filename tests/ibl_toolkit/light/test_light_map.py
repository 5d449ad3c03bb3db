"""What a light map holds, against sums written out; what is no light map is refused."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.importance import importance_sampling
from expanded_panoramas.ibl_toolkit.light.light_map import (
    LUMINANCE,
    check_light_map,
    irradiance,
    luminance,
    luminous_power,
)
from expanded_panoramas.ibl_toolkit.light.median_cut import median_cut, variance_cut

SINGLE = 1e-6
"""Of float32 values, relative."""
DOUBLE = 1e-12
SAMPLERS = (median_cut, variance_cut, importance_sampling)
LIT = np.ones((4, 8, 3), np.float32)


def noise(height=37, width=50, seed=1):
    return np.random.default_rng(seed).lognormal(0, 2, (height, width, 3)).astype(np.float32)


def summed(image, mask=True):
    solid_angles = equirectangular.row_solid_angles(image.shape[1], image.shape[0])
    return np.einsum("ijk,i,ij->k", image.astype(float), solid_angles, np.broadcast_to(mask, image.shape[:2]))


def test_irradiance_is_radiance_over_solid_angle():
    image = noise()
    assert irradiance(image) == pytest.approx(summed(image), rel=DOUBLE)


def test_irradiance_inside_a_mask():
    image, mask = noise(), np.random.default_rng(2).random((37, 50)) < 0.3
    assert irradiance(image, mask) == pytest.approx(summed(image, mask), rel=DOUBLE)


def test_luminance_and_power():
    image, mask = noise(), np.arange(37 * 50).reshape(37, 50) % 3 == 0
    assert luminance(image) == pytest.approx(image @ LUMINANCE, rel=SINGLE)
    solid_angles = equirectangular.row_solid_angles(50, 37)[:, None]
    assert luminous_power(image, mask) == pytest.approx(image @ LUMINANCE * solid_angles * mask, rel=SINGLE)
    assert luminous_power(image).dtype == np.float32


def test_a_good_map_is_handed_on_without_a_copy():
    assert np.shares_memory(check_light_map(LIT), LIT)
    assert check_light_map(LIT.astype(np.float16)).dtype == np.float32


def spoilt(value):
    image = LIT.copy()
    image[1, 2, 1] = value
    return image


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize(
    ("image", "said"),
    [
        (spoilt(np.nan), "1 values that are not finite"),
        (spoilt(np.inf), "1 values that are not finite"),
        (spoilt(-np.inf), "1 values that are not finite"),
        (LIT.astype(float) * 1e39, "96 values that are not finite"),
        (spoilt(-0.5), "1 values of negative radiance, the least -0.5"),
        (0 * LIT, "the light map is black"),
        (LIT[..., 0], "shape (4, 8)"),
        (LIT[..., :2], "shape (4, 8, 2)"),
        (LIT[:, :7], "even width"),
        (LIT[:0], "shape (0, 8, 3)"),
    ],
)
def test_what_is_no_light_map_is_refused(sampler, image, said):
    with pytest.raises(ValueError) as refusal:
        sampler(image, 4)
    assert said in str(refusal.value)


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize("count", [0, -1, 2.5, True])
def test_a_bad_count_is_refused(sampler, count):
    with pytest.raises(ValueError, match=f"count is {count}"):
        sampler(LIT, count)


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_a_bad_mask_is_refused(sampler):
    with pytest.raises(ValueError, match="mask has shape"):
        sampler(LIT, 4, np.ones((8, 4), bool))
    with pytest.raises(ValueError, match="no light"):
        sampler(LIT, 4, np.zeros((4, 8), bool))
    image = LIT.copy()
    image[:2] = 0
    with pytest.raises(ValueError, match="no light"):
        sampler(image, 4, np.arange(4)[:, None] < [2] * 8)
