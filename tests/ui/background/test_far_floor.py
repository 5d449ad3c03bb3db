"""Where the panorama goes over the grid: beyond six eye heights, one and a half pixels above the floor."""

import numpy as np
import pytest

from expanded_panoramas.ui.background.far_floor import corners

EYE, PIXEL = np.array([2.0, -1.0, 1.6]), 0.002


def test_it_reaches_from_six_eye_heights_to_the_horizon():
    triangles = corners(EYE, PIXEL)
    distances = np.linalg.norm(triangles[:, :2] - EYE[:2], axis=1)
    assert distances.min() == pytest.approx(9.6)
    assert triangles[:, 2].max() == pytest.approx(EYE[2])


def test_it_is_so_many_pixels_above_the_floor():
    rays = corners(EYE, PIXEL) - EYE
    distances = np.linalg.norm(rays[:, :2], axis=1)
    on_the_floor = -EYE[2] / distances
    assert (rays[:, 2] / distances - on_the_floor) / PIXEL == pytest.approx(1.5)


def test_it_goes_all_around():
    triangles = corners(EYE, PIXEL).reshape(-1, 3, 3)[..., :2]
    one, other = (triangles[:, i] - triangles[:, 0] for i in (1, 2))
    doubled = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    outer, inner = EYE[2] / (1.5 * PIXEL), 9.6
    assert (doubled > 0).all()
    assert doubled.sum() / 2 == pytest.approx(np.pi * (outer**2 - inner**2), rel=2e-3)  # of 64 segments
