import numpy as np

from expanded_panoramas.ibl_toolkit.layers.points.point_visibility import Nearest


def test_the_nearest_of_each_cell_and_what_is_of_its_surface():
    nearest = Nearest.of_cells(3)
    behind = np.array([0, 0, 1]), np.array([0.50, 0.48, 0.3], np.float32)
    before = np.array([0, 0, 0]), np.array([1.00, 0.95, 0.6], np.float32)
    nearest.add(0, *behind)
    nearest.add(1, *before)
    assert nearest.layer.tolist() == [1, 0, -1]
    assert nearest.is_nearest(0, *behind).tolist() == [False, False, True]
    assert nearest.is_nearest(1, *before).tolist() == [True, True, False]  # the last lies 1.7 times as far


def test_what_lies_at_infinity_is_nearer_than_nothing():
    nearest = Nearest.of_cells(2)
    sky = np.array([0, 1]), np.zeros(2, np.float32)
    nearest.add(0, np.array([1]), np.array([0.01], np.float32))
    nearest.add(1, *sky)
    assert nearest.is_nearest(1, *sky).tolist() == [True, False]
