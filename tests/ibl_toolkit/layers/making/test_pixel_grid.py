"""Pixels of a map: neighbours, directions and rims, whichever way they are found."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.making.grid import PixelGrid, rim

MAPS = [("equirectangular", 64, 32), ("equirectangular", 2, 1), ("cube map", 24, 16)]


@pytest.mark.parametrize("size", MAPS)
def test_few_pixels_have_the_neighbours_and_directions_of_the_whole_map(size):
    whole, bare = PixelGrid(*size), PixelGrid(*size)
    few = max(1, whole.size // 16)
    for start in range(0, whole.size, few):
        pixels = np.arange(start, min(start + few, whole.size))
        np.testing.assert_array_equal(bare.beside(pixels), whole.neighbours[:, pixels])
        np.testing.assert_allclose(bare.directions_of(pixels), whole.directions[pixels], atol=1e-7)


def test_few_pixels_of_an_equirectangular_map_make_nothing_of_the_whole():
    grid = PixelGrid("equirectangular", 64, 32)
    pixels = np.array([0, 63, 700, 2047])
    assert grid.beside(pixels).shape == (4, 4)
    assert grid.directions_of(pixels).shape == (4, 3)
    assert not {"neighbours", "directions"} & set(vars(grid))


@pytest.mark.parametrize("size", MAPS)
def test_neighbours_are_neighbours_from_both_sides(size):
    grid = PixelGrid(*size)
    pixels = np.arange(grid.size)
    for beside in grid.neighbours:
        assert (grid.neighbours[:, beside] == pixels).any(axis=0).all()


@pytest.mark.parametrize("size", MAPS)
def test_rim_pixels_are_those_of_the_sheets_rims(size):
    grid = PixelGrid(*size)
    numbers = np.arange(grid.size).reshape(grid.sheet_shape)
    for slot in range(4):
        np.testing.assert_array_equal(grid.rim_pixels(slot), numbers[rim(slot)].reshape(-1))
