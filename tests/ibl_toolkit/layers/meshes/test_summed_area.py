"""Sums of rectangles from a table, against sums of slices."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.meshes.summed_area import rectangle_sums, summed_area_table

RANDOM = np.random.default_rng(5)


@pytest.mark.parametrize("image", [RANDOM.random((7, 11)), RANDOM.random((7, 11)) < 0.5])
def test_every_rectangle(image):
    table = summed_area_table(image)
    assert table.dtype == (np.int32 if image.dtype == bool else np.float64)
    for y0, y1 in ((0, 7), (2, 3), (4, 4)):
        x0, x1 = np.triu_indices(12)
        sums = [image[y0:y1, a:b].sum() for a, b in zip(x0, x1, strict=True)]
        assert np.allclose(rectangle_sums(table, x0, y0, x1, y1), sums, atol=1e-12)


def test_sheets_do_not_mix():
    image = np.stack([np.full((2, 3), 1.0), np.full((2, 3), 10.0)])
    sums = rectangle_sums(summed_area_table(image), 1, 0, 3, 2, np.array([0, 1]))
    assert sums.tolist() == [4.0, 40.0]


def test_the_table_obeys_the_recurrence_of_the_thesis():
    image = RANDOM.random((5, 4))
    table = summed_area_table(image)
    right = image + table[1:, :-1] + table[:-1, 1:] - table[:-1, :-1]  # eq. 7.4
    assert np.allclose(table[1:, 1:], right)


def test_counts_of_a_large_map_are_exact():
    assert summed_area_table(np.ones((2048, 4096), dtype=bool))[-1, -1] == 2048 * 4096
