import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.points.point_filter import filtered
from expanded_panoramas.ibl_toolkit.layers.points.subsampling import Samples


def samples_of(*points):
    """Of (x, y, 1/distance, colour)."""
    x, y, near, colour = np.array(points, dtype=np.float32).T
    return Samples(np.stack([x, y]), near, np.stack([colour] * 3), np.zeros(len(x), np.int64))


def test_a_sample_reaches_as_far_as_the_filter_and_keeps_its_colour():
    colours, near = filtered(samples_of((2.5, 2.5, 0.5, 7)), 0.75, 6, 5)
    assert colours[2, 2] == pytest.approx([7, 7, 7])
    assert np.count_nonzero(colours) == 3
    assert np.count_nonzero(~np.isnan(near)) == 1
    colours, near = filtered(samples_of((2.9, 2.5, 0.5, 7)), 0.75, 6, 5)
    np.testing.assert_allclose(colours[2, 2:4], 7)
    assert near[2, 3] == pytest.approx(0.5)


def test_weights_fall_evenly_to_the_filters_rim():
    """Two samples, 0.2 and 0.4 px beside the pixel's centre, of a filter of 0.75 px."""
    colours, _ = filtered(samples_of((2.7, 2.5, 1, 0), (2.5, 2.1, 1, 1)), 0.75, 5, 5)
    weights = 1 - 0.2 / 0.75, 1 - 0.4 / 0.75
    assert colours[2, 2, 0] == pytest.approx(weights[1] / sum(weights))


def test_distances_are_of_the_pixels_own_samples():
    _, near = filtered(samples_of((2.9, 2.5, 1.0, 0), (3.1, 2.5, 0.1, 1)), 0.75, 6, 5)
    np.testing.assert_allclose(near[2, 2:4], [1.0, 0.1])


def test_samples_outside_of_the_picture_count_where_they_reach_into_it():
    colours, _ = filtered(samples_of((-0.1, 0.5, 1, 3), (9, 9, 1, 3)), 0.75, 4, 4)
    assert colours[0, 0, 0] == pytest.approx(3)
    assert np.count_nonzero(colours) == 3
