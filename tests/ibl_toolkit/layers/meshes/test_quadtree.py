"""Quadtrees share out the pixels, whatever the size."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.meshes.quadtree import (
    balanced,
    build_quadtree,
    level_bounds,
    number_of_levels,
    without_strips,
)

SIZES = [(1, 1), (2, 1), (1, 5), (3, 2), (5, 5), (13, 6), (16, 8), (37, 1)]


def owners(tree):
    """(sheets, H, W): which leaf has each pixel; fails if one has none or two."""
    owner = np.full((tree.sheets, tree.height, tree.width), -1)
    for number, (sheet, x0, y0, x1, y1) in enumerate(zip(*tree.leaves(), strict=True)):
        assert (owner[sheet, y0:y1, x0:x1] == -1).all()
        owner[sheet, y0:y1, x0:x1] = number
    assert (owner >= 0).all()
    return owner


def split_at(*pixels):
    """Splits every cell that has one of the pixels (sheet, x, y)."""

    def must_split(cells):
        hits = [
            (cells.sheet == s) & (cells.x0 <= x) & (x < cells.x1) & (cells.y0 <= y) & (y < cells.y1)
            for s, x, y in pixels
        ]
        return np.any(hits, axis=0)

    return must_split


def level_differences(tree, wraps):
    """Largest ratio of the sides of leaves that are neighbours across a side."""
    owner, leaves = owners(tree), tree.leaves()
    pairs = [(owner[:, 1:], owner[:, :-1]), (owner[:, :, 1:], owner[:, :, :-1])]
    if wraps:
        pairs.append((owner[:, :, :1], owner[:, :, -1:]))
    ratios = [1.0]
    for one, other in pairs:
        areas = np.sqrt(leaves.area[np.stack([one.ravel(), other.ravel()])])
        ratios.append((areas.max(axis=0) / areas.min(axis=0)).max())
    return max(ratios)


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_leaves_share_out_the_pixels(width, height):
    random = np.random.default_rng(width * 100 + height)
    tree = build_quadtree(2, width, height, lambda cells: random.random(len(cells.x0)) < 0.7)
    owners(tree)
    owners(without_strips(balanced(tree, np.ones((2, height, width), bool))))


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_all_split_is_all_pixels_and_none_split_is_one_cell(width, height):
    assert len(build_quadtree(1, width, height, lambda cells: cells.area > 0).leaves().x0) == width * height
    assert len(build_quadtree(3, width, height, lambda cells: cells.area < 0).leaves().x0) == 3


def test_the_splits_are_those_printed():
    tree = build_quadtree(1, 3, 2, lambda cells: cells.area == 6)
    assert [tuple(map(int, cell[1:])) for cell in zip(*tree.leaves(), strict=True)] == [
        (0, 0, 1, 1),
        (1, 0, 3, 1),
        (0, 1, 1, 2),
        (1, 1, 3, 2),
    ]
    assert level_bounds(11, 2).tolist() == [0, 2, 5, 8, 11]
    assert [number_of_levels(n, 1) for n in (1, 2, 3, 4, 5)] == [0, 1, 2, 2, 3]


@pytest.mark.parametrize("pixel", [(0, 0, 0), (0, 31, 31), (0, 32, 31), (0, 63, 17)])
@pytest.mark.parametrize("wraps", [False, True])
def test_balance(pixel, wraps):
    tree = build_quadtree(1, 64, 64, split_at(pixel))
    fair = balanced(tree, np.ones((1, 64, 64), bool), wraps)
    in_the_corner = pixel == (0, 0, 0) and not wraps
    assert in_the_corner or level_differences(tree, wraps) > 2
    assert level_differences(fair, wraps) <= 2
    assert all((new >= old).all() for new, old in zip(fair.splits, tree.splits, strict=True))
    again = balanced(fair, np.ones((1, 64, 64), bool), wraps)
    assert all((new == old).all() for new, old in zip(again.splits, fair.splits, strict=True))


def test_balance_leaves_alone_what_is_outside():
    inside = np.zeros((1, 64, 64), bool)
    inside[:, :32, :32] = True
    tree = build_quadtree(1, 64, 64, split_at((0, 31, 31)))
    fair = balanced(tree, inside)
    leaves = fair.leaves()
    assert (leaves.x1 - leaves.x0)[leaves.x0 >= 32].min() == 32


def test_strips_become_pixels():
    tree = without_strips(build_quadtree(1, 8, 2, lambda cells: cells.area == 16))
    assert (tree.leaves().area == 1).all()


def test_nothing_to_share_out():
    with pytest.raises(ValueError, match="1 sheets of 0 x 3 px have no pixels"):
        build_quadtree(1, 0, 3, lambda cells: cells.area > 0)
