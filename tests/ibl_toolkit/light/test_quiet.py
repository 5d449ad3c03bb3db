"""The quiet map keeps what the lamps leave, at any size; its noise is the number it says."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance
from expanded_panoramas.ibl_toolkit.light.quiet import WIDTH, noise, quiet_map

SIZES = [(64, 32), (128, 64), (256, 128), (500, 250), (642, 321), (1000, 500), (300, 100), (130, 64)]
ENERGY = 1e-5  # relative, float32 maps
ODD_ENERGY = 1e-4  # where a coarse pixel's solid angle is the mean of parts of rows
AREA = 0.01  # of a coarse pixel's solid angle, where its rows are averaged


def noisy_map(width, height):
    """Uneven radiance with some lamps: at a pole, round the seam, of one pixel, as large as coarse pixels."""
    rng = np.random.default_rng(3)
    image = rng.uniform(0.1, 1, (height, width, 3)).astype(np.float32)
    lamps = np.zeros((height, width), bool)
    lamps[: height // 10] = True
    lamps[height // 2 : height // 2 + 3, [0, 1, -1]] = True
    lamps[height // 3, width // 3] = True
    lamps[-height // 4 :, width // 2 : width // 2 + width // 8] = True
    return image, lamps


@pytest.mark.parametrize("size", SIZES)
def test_power_beside_the_lamps_is_kept(size):
    """Lamps in the sky: their pixels are black."""
    image, lamps = noisy_map(*size)
    quiet = quiet_map(image, lamps, behind_lamps=False)
    assert quiet.shape == (min(WIDTH, size[0]) * size[1] // size[0], min(WIDTH, size[0]), 3)
    assert irradiance(quiet) == pytest.approx(irradiance(image, ~lamps), rel=ODD_ENERGY)


@pytest.mark.parametrize("size", SIZES)
def test_a_constant_map_stays_constant_behind_lamps(size):
    """Whatever they hide, also where coarse pixels are hidden whole and with all their neighbours."""
    _, lamps = noisy_map(*size)
    image = np.broadcast_to(np.float32([0.2, 0.5, 3]), (*lamps.shape, 3))
    assert np.allclose(quiet_map(image, lamps, behind_lamps=True), (0.2, 0.5, 3), rtol=ENERGY)


@pytest.mark.parametrize("size", SIZES)
def test_power_that_lamps_do_not_hide_is_kept(size):
    """Lamps before a surface: over what they leave uncovered, the map holds the power it had there."""
    image, lamps = noisy_map(*size)
    quiet = quiet_map(image, lamps, behind_lamps=True)
    height, width = quiet.shape[:2]
    rows, columns = np.indices(lamps.shape)
    coarse = rows * height // lamps.shape[0] * width + columns * width // lamps.shape[1]
    solid_angles = np.repeat(equirectangular.row_solid_angles(*size), size[0])
    left = np.bincount(coarse.ravel(), np.where(lamps, 0, solid_angles.reshape(lamps.shape)).ravel())
    if size[0] % width == 0 and size[1] % height == 0:
        shown = left @ quiet.reshape(-1, 3)
        assert shown == pytest.approx(irradiance(image, ~lamps), rel=ENERGY)
    else:  # pixels lie across the coarse pixels' borders
        shown = left @ quiet.reshape(-1, 3)
        assert shown == pytest.approx(irradiance(image, ~lamps), rel=AREA)


@pytest.mark.parametrize("behind_lamps", [True, False])
def test_no_lamps_and_nothing_but_lamps(behind_lamps):
    image, lamps = noisy_map(256, 128)
    whole = quiet_map(image, np.zeros_like(lamps), behind_lamps=behind_lamps)
    assert irradiance(whole) == pytest.approx(irradiance(image), rel=ENERGY)
    nothing = quiet_map(image, np.ones_like(lamps), behind_lamps=behind_lamps)
    assert not nothing.any()


def test_a_small_map_is_not_blown_up():
    image, lamps = noisy_map(64, 32)
    quiet = quiet_map(image, lamps, behind_lamps=False)
    assert np.allclose(quiet[~lamps], image[~lamps], rtol=ENERGY)
    assert not quiet[lamps].any()


def test_noise():
    """Half of the sphere at twice the radiance is twice as noisy; a map against itself, constant, is 1."""
    image = np.ones((64, 128, 3), np.float32)
    assert noise(image, image) == pytest.approx(1)
    half = image.copy()
    half[:32], half[32:] = 2, 0
    assert noise(half, image) == pytest.approx(2, rel=1e-4)
    assert noise(half[:, ::2] * 0, image) == 0
    assert noise(0.1 * image, image) == pytest.approx(0.01)
