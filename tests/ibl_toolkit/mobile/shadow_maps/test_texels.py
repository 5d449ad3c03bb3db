"""Storage, filters and bounds: known answers."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import ShadowSettings, evsm, vsm
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.gaussian import along, blurred, kernel
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.lookup import bilinear, box, in_blocks, nearest
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.storage import STEPS, packed, unpacked

RANDOM = np.random.default_rng(1).random((5, 7, 2))


@pytest.mark.parametrize(("storage", "bytes_"), [("float32", 8), ("8+8", 2), ("16+16", 4)])
def test_numbers_come_back_within_half_a_step(storage, bytes_):
    texels = packed(RANDOM, storage)
    assert texels[0, 0].nbytes == bytes_ == ShadowSettings("vsm", storage=storage).bytes_per_texel
    assert np.abs(unpacked(texels, storage) - RANDOM).max() <= (STEPS[storage] or 2.0**-24) * 0.5000001
    ends = np.array([[0.0, 1.0]])
    np.testing.assert_array_equal(unpacked(packed(ends, storage), storage), ends)


def test_sixteen_bits_are_the_high_byte_and_the_low():
    assert packed(np.array([[0x12AB / 65535, 0xFF00 / 65535]]), "16+16").tolist() == [
        [0x12, 0xAB, 0xFF, 0x00]
    ]


def test_what_is_filtered_are_numbers_not_bytes():
    """Between 0x00FF and 0x0100 lies no 0x0180: interpolated bytes would give half of each."""
    texels = packed(np.array([[[0x00FF / 65535], [0x0100 / 65535]]] * 2), "16+16")
    mixed = bilinear(texels, np.array([[0.5, 0.5]]), lambda t: unpacked(t, "16+16"))
    assert mixed[0, 0] * 65535 == pytest.approx(0xFF + 0.5)


def test_lookup_takes_texels_middles_and_clamps_to_the_edge():
    texels = np.arange(16.0).reshape(4, 4, 1)
    places = np.array([[0.375, 0.625], [0.0, 0.0], [1.0, 1.0], [0.5, 0.125]])
    assert nearest(texels, places)[:, 0].tolist() == [9, 0, 15, 2]
    assert bilinear(texels, places, lambda t: t)[:, 0].tolist() == [9, 0, 15, 1.5]


@pytest.mark.parametrize("window", [1, 3, 5])
def test_a_box_is_as_wide_as_its_window_and_even(window):
    places = np.array([[0.5, 0.5], [0.53, 0.61]])
    map_ = np.zeros((2, 32, 32))
    for row, column, weight in box(32, places, window):
        np.add.at(map_, (np.arange(2), row, column), weight)
    np.testing.assert_allclose(map_.sum(axis=(1, 2)), 1)
    assert map_.max() == pytest.approx(1 / window**2 if window > 1 else 0.8976 * 0.5376, rel=0.2)
    middle = (np.arange(32) + 0.5) / 32
    np.testing.assert_allclose((map_.sum(axis=1) * middle).sum(axis=1), places[:, 0])
    np.testing.assert_allclose((map_.sum(axis=2) * middle).sum(axis=1), places[:, 1])


def test_blocks_make_no_difference():
    numbers = np.arange(200_000.0)
    np.testing.assert_array_equal(in_blocks(lambda n: 2 * n, numbers), 2 * numbers)
    assert in_blocks(lambda n: n, np.empty(0)).shape == (0,)


def test_the_gaussian_is_separable_and_keeps_sums():
    dot = np.zeros((15, 15, 1))
    dot[7, 7] = 1
    twice = along(along(dot, 0, 5), 1, 5)[..., 0]
    np.testing.assert_allclose(twice[5:10, 5:10], np.outer(kernel(5), kernel(5)))
    assert twice.sum() == pytest.approx(1)
    even = np.full((6, 6, 2), 0.3)
    np.testing.assert_allclose(along(even, 0, 5), even)


def test_each_pass_of_the_blur_packs():
    counted = []

    def encode(numbers):
        counted.append(numbers.shape)
        return packed(numbers, "8+8")

    blurred(packed(RANDOM[:5, :5], "8+8"), 3, encode, lambda t: unpacked(t, "8+8"))
    assert len(counted) == 2


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_chebyshevs_bound_is_exact_for_two_depths(share):
    """A part of the window sees an occluder at 0.2, the rest the receiver at 0.7: what is seen is lit."""
    moments = np.array([[share * 0.2 + (1 - share) * 0.7, share * 0.2**2 + (1 - share) * 0.7**2]])
    assert vsm.chebyshev(moments, np.array([0.7]), 0.0)[0] == pytest.approx(1 - share)


def test_light_bleeds_through_three_depths_and_less_of_it_when_warped():
    z, shares = np.array([0.1, 0.5, 0.6]), np.array([0.3, 0.7, 0.0])  # the receiver is seen by no part
    plain = np.array([[(shares * z).sum(), (shares * z**2).sum()]])
    bled = vsm.chebyshev(plain, z[2:], 0.0)[0]
    x = evsm.warped(z, 40.0)
    moments = np.array([[(shares * x).sum(), (shares * x**2).sum()]])
    warped = vsm.chebyshev(moments, x[2:], 0.0)[0]
    assert bled > 0.3
    assert warped < 1e-3
    assert vsm.without_bleeding(np.array([bled]), bled)[0] == 0
    assert vsm.without_bleeding(np.array([1.0]), 0.5)[0] == 1


@pytest.mark.parametrize("storage", STEPS)
@pytest.mark.parametrize("exponent", [5.0, 20.0, 40.0])
def test_warped_moments_come_back(storage, exponent):
    """Of an even part of the depths seen, so of means and deviations of every size."""
    if storage == "8+8" and exponent > 20:
        pytest.skip("no one suggests it")
    settings = ShadowSettings("evsm", storage=storage, exponent=exponent)
    near, apart = np.random.default_rng(2).random((2, 500)) * 0.45
    far = near + 0.1 + apart
    share = np.random.default_rng(3).random(500) * 0.9
    x1, x2 = evsm.warped(near, exponent), evsm.warped(far, exponent)
    moments = np.stack([share * x1 + (1 - share) * x2, share * x1**2 + (1 - share) * x2**2], axis=-1)
    back = evsm.decoded(evsm.encoded(moments, settings), settings)
    step = STEPS[storage] or 2.0**-23
    np.testing.assert_allclose(back[:, 0], moments[:, 0], rtol=exponent * step)
    lit = vsm.chebyshev(back, x2, 0.0)
    np.testing.assert_allclose(lit, 1 - share, atol=8 * exponent * step + 1e-4)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("method", "esm"),
        ("storage", "8"),
        ("resolution", 8),
        ("resolution", 512.5),
        ("window", 4),
        ("window", 3.0),
        ("window", 0),
        ("window", 4097),
        ("offset_factor", np.nan),
        ("offset_units", np.inf),
        ("bleeding_reduction", 1.0),
        ("bleeding_reduction", -0.1),
        ("exponent", 0.0),
        ("exponent", 43.0),
    ],
)
def test_settings_refuse(field, value):
    with pytest.raises(ValueError, match=field):
        ShadowSettings(**{field: value})
