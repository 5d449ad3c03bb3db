"""Previews: sRGB transfer, exposure, channel order."""

import cv2
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import exposure_for, write_png
from expanded_panoramas.ibl_toolkit.images.png import srgb_from_linear

# IEC 61966-2-1: linear -> 8-bit code
KNOWN = {0.0: 0, 0.0031308: 10, 0.18: 118, 0.5: 188, 1.0: 255, 7.0: 255, -1.0: 0}


def test_known_values(tmp_path):
    image = np.array(list(KNOWN), dtype=np.float32)[None, :, None].repeat(3, axis=2)
    write_png(tmp_path / "a.png", image)
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "a.png"))[0, :, 0], list(KNOWN.values()))


def test_order_of_channels_and_rows(tmp_path):
    image = np.zeros((2, 4, 3), dtype=np.float32)
    image[0, 0] = (1, 0, 0)
    image[1, 3] = (0, 0, 1)
    write_png(tmp_path / "a.png", image)
    got = cv2.imread(str(tmp_path / "a.png"))[..., ::-1]
    np.testing.assert_array_equal(got, image.astype(np.uint8) * 255)


def test_grey(tmp_path):
    write_png(tmp_path / "a.png", np.array([[0.0, 1.0]]))
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED), [[0, 255]])


def test_exposure_is_a_factor(tmp_path):
    write_png(tmp_path / "a.png", np.full((1, 2), 0.09), exposure=2)
    assert cv2.imread(str(tmp_path / "a.png"))[0, 0, 0] == KNOWN[0.18]


def test_transfer_is_continuous_at_its_knee():
    below, above = srgb_from_linear(np.array([0.0031308, 0.0031309]))
    assert 0 < above - below < 1e-5


def test_exposure_brings_the_median_to_mid_grey():
    image = np.full((8, 16, 3), 0.02, dtype=np.float32)
    image[0, :3] = 1e4  # lamps
    image[6:] = 0  # no light from below
    assert exposure_for(image) == pytest.approx(9, rel=1e-6)


def test_darkness_has_an_exposure():
    assert exposure_for(np.zeros((4, 8, 3), dtype=np.float32)) == 1.0


def test_nan_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"a\.png: 1 values of the image are NaN"):
        write_png(tmp_path / "a.png", np.array([[np.nan, 1.0]]))
    assert not (tmp_path / "a.png").exists()
