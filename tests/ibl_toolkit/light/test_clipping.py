"""A clipped sun is found, and gets back the light it had; what only looks a little like one is left alone."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.clipping import find_clipping, irradiance_from_shadow, restored
from expanded_panoramas.ibl_toolkit.light.light_map import LUMINANCE, irradiance

SIZE = 256, 128
CEILING = 60.0
DIRECTION = 0.02  # [rad]
SUN = 1e-3  # relative: pixels below the ceiling hold a little of it
FROM_SHADOW = 0.01


def sky_with_sun(towards, sharpness=2000.0):
    """A sky brighter than the ground, and a sun with soft edges; nothing clipped. -> image, unit vector."""
    directions = equirectangular.pixel_directions(*SIZE).astype(np.float64)
    towards = np.asarray(towards, float) / np.linalg.norm(towards)
    sky = np.where(directions[..., 2:] > 0, 1.0, 0.2) * (0.6, 0.8, 1.0)
    sun = 5000 * np.exp(sharpness * (directions @ towards - 1))[..., None] * np.array([1, 0.9, 0.7])
    return (sky + sun).astype(np.float32), towards


def clipped(image, ceiling=CEILING):
    return np.minimum(image, np.float32(ceiling))


@pytest.mark.parametrize("towards", [(1, 1, 1), (-1, 0, 0.3), (-1, 0.01, 0.8), (0.01, 0, 1)])
def test_a_clipped_sun_is_found_where_it_is(towards):
    image, towards = sky_with_sun(towards)
    found = find_clipping(clipped(image))
    assert found.is_clipped
    assert np.arccos(min(found.direction @ towards, 1)) < DIRECTION
    assert np.allclose(found.level, CEILING, rtol=0.03)  # the dimmest channel's plateau is a little smaller
    solid_angles = equirectangular.row_solid_angles(*SIZE)
    assert found.solid_angle == pytest.approx(np.count_nonzero(found.mask, axis=1) @ solid_angles)
    assert (image[found.mask].max(axis=1) >= CEILING * (1 - 1e-3)).all()


def test_each_channel_may_have_its_own_ceiling():
    found = find_clipping(clipped(sky_with_sun((1, 1, 1))[0]) * np.array([2, 1, 1.6], np.float32))
    assert found.is_clipped
    assert np.allclose(found.level, np.array([2, 1, 1.6]) * CEILING, rtol=0.03)


def test_with_two_clipped_lamps_it_is_the_larger():
    image = np.full((64, 128, 3), 0.1, np.float32)
    image[20:23, 10:14] = image[30:34, 60:66] = 7
    found = find_clipping(image)
    assert found.mask.sum() == 24
    assert found.mask[31, 62]


@pytest.mark.parametrize(
    "image",
    [
        np.full((16, 32, 3), 0.8, np.float32),
        np.where(np.arange(32)[:, None, None] < 20, 0.8, 0.1) * np.ones((32, 64, 3)),
        np.where(np.arange(2048).reshape(32, 64, 1) == 700, 1e6, 1.0) * np.ones(3),
        sky_with_sun((1, 1, 1))[0],
        np.random.default_rng(0).lognormal(0, 2, (64, 128, 3)).astype(np.float16),
    ],
    ids=["constant", "a white ceiling above the horizon and below", "hot pixel", "whole sun", "noise"],
)
def test_what_is_not_clipped_is_not_taken_for_it(image):
    found = find_clipping(image.astype(np.float32))
    assert not found.is_clipped
    assert not found.mask.any()
    with pytest.raises(ValueError, match="no clipped light was found"):
        restored(image, found, 5)


def test_a_given_irradiance_is_restored():
    whole, _ = sky_with_sun((1, 1, 1))
    found = find_clipping(clipped(whole))
    truth = irradiance(whole, found.mask)
    again = restored(clipped(whole), found, truth)
    assert np.allclose(irradiance(again), irradiance(whole), rtol=SUN)
    assert np.array_equal(again[~found.mask], clipped(whole)[~found.mask])


def test_a_luminance_keeps_the_plateaus_colour():
    image = clipped(sky_with_sun((1, 1, 1))[0])
    found = find_clipping(image)
    sun = irradiance(restored(image, found, 20), found.mask)
    assert LUMINANCE @ sun == pytest.approx(20)
    assert np.allclose(sun / sun[0], found.irradiance / found.irradiance[0])


def test_a_channel_that_is_black_gets_its_light_too():
    image = np.full((32, 64, 3), 0.1, np.float32)
    image[8:10, 20:23] = 16, 2, 0
    found = find_clipping(image)
    assert np.allclose(irradiance(restored(image, found, (9, 5, 3)), found.mask), (9, 5, 3))


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0.2, 0.1)])
def test_the_shadow_tells_the_suns_irradiance(normal):
    """Lit and shadowed radiance of a diffuse surface, from the whole map, with and without its sun."""
    whole, _ = sky_with_sun((1, 1, 1))
    found = find_clipping(clipped(whole))
    cosines = np.maximum(
        equirectangular.pixel_directions(*SIZE) @ (np.array(normal) / np.linalg.norm(normal)), 0
    )
    weights = cosines * equirectangular.row_solid_angles(*SIZE)[:, None]
    lit = np.einsum("rc,rck->k", weights, whole)
    shadow = np.einsum("rc,rck->k", weights * ~found.mask, whole)
    sun = irradiance_from_shadow(clipped(whole), found, lit / shadow, normal)
    assert np.allclose(sun, irradiance(whole, found.mask), rtol=FROM_SHADOW)


def test_what_cannot_be_is_refused():
    image = clipped(sky_with_sun((1, 1, 1))[0])
    found = find_clipping(image)
    with pytest.raises(ValueError, match=r"irradiance is 0.001: the clipped light brings .* already"):
        restored(image, found, 0.001)
    with pytest.raises(ValueError, match="one finite number, or three"):
        restored(image, found, (1, 2))
    with pytest.raises(ValueError, match="lit over shadow is 0.9: must be one number above 1"):
        irradiance_from_shadow(image, found, 0.9)
    with pytest.raises(ValueError, match="behind it: choose a surface that it lights"):
        irradiance_from_shadow(image, found, 3, normal=(0, 0, -1))
