"""The panorama behind the scene arrives in the window as numpy and sRGB say; a turning head stays there."""

import cv2
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.equirectangular import sample
from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.views import View

JOBS = "jobs_background.py"
MEAN, LARGEST = 0.5, 1.5
"""Of the difference [1/255]; rounding to 8 bits alone makes a mean of 0.25 and 0.5 at most."""
RIM = 40
"""Rounded corners and the handles of hidden regions [px]."""
STEP = 4
"""Every so many pixels in each direction is enough."""
EXPOSURES = {"perspective": 0, "wires": 0, "plan": 0, "camera": -1}


def inner(array):
    return array[RIM:-RIM:STEP, RIM:-RIM:STEP]


def picture(found):
    """The 3D view's part of a picture of the window (H, W, 3), RGB."""
    window = cv2.imread(found["file"])[..., ::-1].astype(float)
    x, y, width, height = found["box"]
    below = len(window) - y
    return window[below - height : below, x : x + width]


def expected(image, found, exposure):
    _, _, width, height = found["box"]
    origin = np.array(found["origin"])
    view = View.from_matrices(found["window"], found["view"], origin[:3, :3], origin[2, 3], (width, height))
    rows, columns = np.mgrid[height:0:-1, :width]
    radiance = sample(image, view.directions_at(inner(np.stack([columns + 0.5, rows - 0.5], axis=-1))))
    linear = np.clip(radiance * 2.0**exposure, 0, 1)
    return 255 * np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize("name", EXPOSURES)
def test_window_shows_the_panorama(notes, name):
    found = notes["every_kind_of_view"]
    reference = expected(read_panorama(found["image"]), found[name], EXPOSURES[name])
    difference = np.abs(inner(picture(found[name])) - reference)
    assert difference.mean() < MEAN
    assert difference.max() < LARGEST


def test_switched_off_there_is_the_theme(notes):
    assert np.ptp(inner(picture(notes["every_kind_of_view"]["none"])).reshape(-1, 3), axis=0).max() == 0


def test_turning_the_view_turns_the_head(notes):
    found = notes["the_head_turns"]
    assert found["turned_deg"] > 10
    assert found["eye"] == pytest.approx([0, 0, 1.32], abs=1e-3)
