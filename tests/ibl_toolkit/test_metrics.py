"""Errors of pictures with known answers."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import metrics


def test_psnr_of_a_known_difference():
    truth = np.zeros((4, 4, 3))
    image = np.full((4, 4, 3), 1e-3)  # linear part of the curve: display 0.01292
    assert metrics.psnr(image, truth) == pytest.approx(-20 * np.log10(0.01292), abs=1e-9)
    assert metrics.psnr(truth, truth) == float("inf")


def test_psnr_looks_at_the_mask_alone():
    truth, image = np.zeros((4, 4, 3)), np.zeros((4, 4, 3))
    image[0, 0] = 1
    mask = np.zeros((4, 4), bool)
    mask[0, 0] = True
    assert metrics.psnr(image, truth, mask) == pytest.approx(0, abs=1e-9)
    assert metrics.psnr(image, truth, ~mask) == float("inf")
    with pytest.raises(ValueError, match="mask is empty"):
        metrics.psnr(image, truth, np.zeros((4, 4), bool))


def test_changed_pixels_leave_single_ones_out():
    without = np.full((16, 16, 3), 0.2)
    with_objects = without.copy()
    with_objects[4:9, 4:9] = 0.4
    with_objects[12, 12] = 1
    changed = metrics.changed_pixels(with_objects, without)
    assert changed[5:8, 5:8].all()
    assert not changed[12, 12]


def test_white_dots_are_counted_but_lamps_are_not():
    picture = np.full((32, 32, 3), 0.1)
    picture[5, 5] = picture[20, 31] = 20
    picture[10:14, 10:14] = 20
    dots = metrics.white_dots(picture)
    assert {tuple(index) for index in np.argwhere(dots).tolist()} == {(5, 5), (20, 31)}


def test_a_mirrored_lamp_is_no_new_dot():
    truth = np.full((32, 32, 3), 0.1)
    truth[8, 8] = 20
    picture = np.full((32, 32, 3), 0.1)
    picture[9, 8] = picture[20, 20] = 20
    assert np.argwhere(metrics.new_white_dots(picture, truth)).tolist() == [[20, 20]]
