"""Corners of pixels: which of them are the same point of the sphere."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.meshes.corners import Corners


@pytest.mark.parametrize(
    ("mapping", "size", "points"),
    [
        ("equirectangular", (8, 4), 8 * 3 + 2),
        ("equirectangular", (10, 5), 10 * 4 + 2),
        ("cube map", (3, 2), 8),
        ("cube map", (9, 6), 6 * 9 + 2),
        ("cube map", (24, 16), 6 * 64 + 2),
    ],
)
def test_each_point_has_one_name(mapping, size, points):
    corners = Corners(mapping, *size)
    numbers = np.arange(np.prod(corners.shape))
    names = corners.known_as(numbers)
    assert np.allclose(corners.directions(names), corners.directions(numbers), atol=1e-12)
    assert np.array_equal(corners.known_as(names), names)
    different = np.unique(corners.directions(np.unique(names)).round(9), axis=0)
    assert len(different) == len(np.unique(names)) == points


def test_sheets_are_the_faces():
    image = np.repeat(np.repeat(np.arange(6).reshape(2, 3), 4, axis=0), 4, axis=1)
    sheets = Corners("cube map", 12, 8).as_sheets(image)
    assert sheets.shape == (6, 4, 4)
    assert (sheets == np.arange(6)[:, None, None]).all()
    assert np.array_equal(Corners("equirectangular", 4, 2).as_sheets(np.eye(2, 4))[0], np.eye(2, 4))


def test_a_point_of_the_first_face_and_a_corner_of_the_cube():
    corners = Corners("cube map", 12, 8)
    middle, first = corners.directions(np.array([2 * 5 + 2, 0]))
    assert np.allclose(middle, [1, 0, 0])
    assert np.allclose(first, np.array([1, 1, 1]) / np.sqrt(3))


def test_other_sizes_are_refused():
    with pytest.raises(ValueError, match="12 x 9 px, a cube map must be 3N x 2N"):
        Corners("cube map", 12, 9)
