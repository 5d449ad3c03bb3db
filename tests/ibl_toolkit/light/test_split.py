"""The split against a sort of all pixels, and maps whose bright part is known."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.light_map import luminance
from expanded_panoramas.ibl_toolkit.light.split import split, two_trapezoid_curves

SHARE = 1e-9
"""Shares of light and areas, relative."""
SHAPE = 24, 48


def noisy(kind, seed):
    rng = np.random.default_rng(seed)
    values = {
        "lognormal": rng.lognormal(0, 1.5, SHAPE),
        "nearly flat": 1 + 0.01 * rng.random(SHAPE),
        "half floats": rng.lognormal(0, 1, SHAPE).astype(np.float16),
        "few levels": rng.integers(1, 5, SHAPE) ** 3,
        "half black": np.maximum(rng.normal(0, 1, SHAPE), 0),
        "hot pixel": 1 + 1e6 * (np.arange(SHAPE[0] * SHAPE[1]) == 500).reshape(SHAPE),
        "nine decades": 10 ** rng.uniform(-6, 3, SHAPE),
        "straight line": 1 + np.arange(SHAPE[0] * SHAPE[1]).reshape(SHAPE),
    }[kind]
    return values[..., None].astype(np.float32) * np.array([1, 0.9, 0.8], np.float32)


KINDS = (
    "lognormal", "nearly flat", "half floats", "few levels", "half black", "hot pixel", "nine decades",
)  # fmt: skip


def sorted_pixels(image):
    """Flat indices, luminance and solid angles, brightest first: M̄ of section 3.2.1.1."""
    brightness = luminance(image).ravel().astype(np.float64)
    order = sorted(range(brightness.size), key=lambda k: (-brightness[k], k))
    solid_angles = np.repeat(equirectangular.row_solid_angles(SHAPE[1], SHAPE[0]), SHAPE[1])
    return np.array(order), brightness[order], solid_angles[order]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("share", [0.05, 0.5, 0.93])
def test_a_given_share_is_reached_by_the_last_pixel_and_not_before(kind, share):
    image = noisy(kind, 1)
    order, brightness, solid_angles = sorted_pixels(image)
    power = np.cumsum(brightness * solid_angles)
    count = int(np.argmax(power >= share * power[-1])) + 1
    found = split(image, share)
    assert set(np.flatnonzero(found.mask)) == set(order[:count])
    assert found.share == pytest.approx(power[count - 1] / power[-1], rel=SHARE)
    assert found.level == brightness[count - 1]
    assert found.solid_angle == pytest.approx(solid_angles[:count].sum(), rel=SHARE)


@pytest.mark.parametrize("kind", KINDS)
def test_the_rule_takes_the_smallest_area_of_least_trapezoids(kind):
    image = noisy(kind, 2)
    order, f, solid_angles = sorted_pixels(image)
    x = np.cumsum(solid_angles)
    zeta = (f[0] + f) / 2 * x + (f + f[-1]) / 2 * (x[-1] - x)
    count = int(np.argmin(zeta)) + 1
    found = split(image)
    assert set(np.flatnonzero(found.mask)) == set(order[:count])
    assert found.share == pytest.approx(
        (f * solid_angles)[:count].sum() / (f * solid_angles).sum(), rel=SHARE
    )


def test_the_curves_are_those_of_the_figure():
    image = noisy("lognormal", 3)
    x, f, g, zeta = two_trapezoid_curves(image)
    assert x[-1] == pytest.approx(4 * np.pi)
    assert (np.diff(f) <= 0).all()
    assert g[-1] == pytest.approx(float(luminance(image).sum(1) @ equirectangular.row_solid_angles(48, 24)))
    assert zeta[-1] == pytest.approx((f[0] + f[-1]) / 2 * x[-1])
    assert split(image).solid_angle == pytest.approx(x[zeta.argmin()], rel=SHARE)


def test_two_lamps_on_a_dim_map_are_the_bright_part():
    image = noisy("nearly flat", 4)
    lamps = np.zeros(SHAPE, bool)
    lamps[3:5, 46:] = lamps[3:5, :1] = lamps[20, 10:14] = True  # one over the seam
    image[lamps] *= 500
    found = split(image)
    assert found.mask[lamps].all()
    assert found.mask.sum() <= lamps.sum() + 1  # x̄ ends with the first pixel of the lower level


def test_on_a_flat_map_nothing_stands_out_but_a_given_share_is_taken():
    image = np.full((*SHAPE, 3), 0.7, np.float32)
    assert not split(image).mask.any()
    assert (split(image).share, split(image).solid_angle) == (0, 0)
    half = split(image, 0.5)
    assert half.share == pytest.approx(0.5, abs=2e-3)
    assert half.area == pytest.approx(half.share)
    assert half.mask[:11].all()
    assert not half.mask[13:].any()


def test_one_hot_pixel_is_the_bright_part():
    found = split(noisy("hot pixel", 0), 0.9)
    assert np.flatnonzero(found.mask).tolist() == [500]
    assert found.level == pytest.approx(1e6, rel=0.1)


def test_a_straight_line_is_solved_too():
    """Every area is almost equally good: no bin can be ruled out."""
    image = noisy("straight line", 0)
    x, _, _, zeta = two_trapezoid_curves(image)
    assert split(image).solid_angle == pytest.approx(x[zeta.argmin()], rel=SHARE)


@pytest.mark.parametrize("share", [0, 1, -0.1, 1.5, float("nan")])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises(ValueError, match="share is .*above 0 and below 1"):
        split(noisy("lognormal", 0), share)


def test_a_black_map_is_refused():
    with pytest.raises(ValueError):
        split(np.zeros((*SHAPE, 3), np.float32))
