"""Connected regions of a mask on the sphere against a flood fill over its neighbours."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.light.regions import connected_regions

SIZE = (8, 16)


def mask_of(*pixels, size=SIZE):
    mask = np.zeros(size, bool)
    mask[tuple(np.transpose(pixels))] = True
    return mask


def neighbours(row, column, height, width):
    """The eight of a pixel, round the seam; across a pole, the one pixel that faces it."""
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            if 0 <= row + down < height:
                yield row + down, (column + right) % width
    if row in (0, height - 1):
        yield row, (column + width // 2) % width


def flood_filled(mask):
    """The regions as a set of frozen sets of flat indices."""
    height, width = mask.shape
    waiting, found = {tuple(pixel) for pixel in np.argwhere(mask).tolist()}, set()
    while waiting:
        region, border = set(), [waiting.pop()]
        while border:
            pixel = border.pop()
            region.add(pixel[0] * width + pixel[1])
            reached = waiting.intersection(neighbours(*pixel, height, width))
            waiting -= reached
            border += reached
        found.add(frozenset(region))
    return found


@pytest.mark.parametrize("density", [0.1, 0.25, 0.4])
@pytest.mark.parametrize("size", [(8, 16), (5, 10), (1, 4), (2, 2)])
def test_random_masks(density, size):
    for seed in range(20):
        mask = np.random.default_rng(seed).random(size) < density
        found = connected_regions(mask)
        assert {frozenset(region.tolist()) for region in found} == flood_filled(mask)
        assert sum(map(len, found)) == mask.sum()


@pytest.mark.parametrize(
    ("pixels", "count"),
    [
        (((3, 3), (4, 4)), 1),  # by a corner
        (((3, 3), (3, 5)), 2),
        (((3, 0), (3, 15)), 1),  # across the seam
        (((3, 0), (4, 15)), 1),  # across the seam by a corner, down
        (((3, 0), (2, 15)), 1),  # and up
        (((3, 0), (5, 15)), 2),
        (((0, 2), (0, 10)), 1),  # over the zenith
        (((7, 2), (7, 10)), 1),  # under the nadir
        (((0, 2), (0, 9)), 2),
        (((0, 2), (7, 10)), 2),  # the poles are not one
    ],
)
def test_neighbours(pixels, count):
    assert len(connected_regions(mask_of(*pixels))) == count


def test_a_chain_that_meets_itself_round_the_sphere_is_one():
    """Two stripes that only the seam joins, and that only the zenith joins to a third."""
    mask = mask_of((2, 0), (3, 15), (1, 1), (0, 2), (0, 10), (1, 11))
    assert len(connected_regions(mask)) == 1


def test_all_and_nothing():
    (everything,) = connected_regions(np.ones(SIZE, bool))
    assert len(everything) == 8 * 16
    assert connected_regions(np.zeros(SIZE, bool)) == []
