import numpy as np
import pytest
from box_layers import BOTH, directions

from expanded_panoramas.ibl_toolkit.layers.views.texels import sheets_of, texel_index

SIZES = [("equirectangular", 16, 8), ("cube map", 15, 10), ("cube map", 3, 2)]


def padded(mapping, width, height):
    sheets, rows, columns = sheets_of(mapping, width, height)
    row, column = np.arange(-1, rows + 1), np.arange(-1, columns + 1)
    return texel_index(mapping, width, height, np.arange(sheets)[:, None, None], row[:, None], column)


@pytest.mark.parametrize(("mapping", "width", "height"), SIZES)
def test_every_pixel_is_there_once(mapping, width, height):
    inner = padded(mapping, width, height)[:, 1:-1, 1:-1]
    assert sorted(inner.ravel()) == list(range(width * height))


@pytest.mark.parametrize("mapping", BOTH)
def test_neighbours_are_near_on_the_sphere(mapping):
    width, height = {"equirectangular": (64, 32), "cube map": (48, 32)}[mapping]
    index = padded(mapping, width, height)
    rays = directions(mapping, width).reshape(-1, 3)
    pixel = {"equirectangular": np.pi / 32, "cube map": 2 / 16}[mapping]
    for one, other in (
        (index[:, 1:-1, :-1], index[:, 1:-1, 1:]),
        (index[:, :-1, 1:-1], index[:, 1:, 1:-1]),
    ):
        angle = np.arccos(np.clip((rays[one] * rays[other]).sum(axis=-1), -1, 1))
        assert (one >= 0).all()
        assert angle.min() > 0
        assert angle.max() < 1.01 * pixel


def test_nothing_is_beyond_a_corner_of_the_cube_alone():
    index = padded("cube map", 15, 10)
    corners = np.zeros(index.shape, dtype=bool)
    corners[:, [0, 0, -1, -1], [0, -1, 0, -1]] = True
    np.testing.assert_array_equal(index < 0, corners)
    assert (padded("equirectangular", 16, 8) >= 0).all()
