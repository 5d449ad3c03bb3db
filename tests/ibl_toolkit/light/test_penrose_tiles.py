"""The tiling: triangles that partition, code values that rank, points that lie evenly."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.light import penrose_tiles as tiling
from expanded_panoramas.ibl_toolkit.light.maximum_pyramid import MaximumPyramid

KINDS = [tiling.ACUTE, tiling.ACUTE_MIRRORED, tiling.OBTUSE, tiling.OBTUSE_MIRRORED]
EXACT = 1e-12
GROWTH = 0.01  # relative: counts of one level are whole numbers
EVENNESS = 0.3  # variance of counts in boxes over Poisson's, which is 1; measured below 0.15


def single(kind, turn=3):
    one = np.ones(1, dtype=np.int64)
    return tiling.Triangles(one * kind, np.array([0.3 + 0.1j]), one * turn, one * 0, 0)


def areas(triangles):
    first, second, third = triangles.corners().T
    return ((second - first).conj() * (third - first)).imag / 2


def is_inside(points, triangles, tolerance=0.0):
    """(points, triangles): whether a point lies inside, by more than -tolerance."""
    corners = triangles.corners()
    inside = np.ones((len(points), len(triangles)), dtype=bool)
    for k in range(3):
        start, along = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        distance = (along.conj() * (points[:, None] - start)).imag / np.abs(along)
        inside &= distance > -tolerance
    return inside


def random_points_in(triangle, count):
    weights = np.random.default_rng(1).dirichlet(np.ones(3), count)
    return weights @ triangle.corners()[0]


@pytest.mark.parametrize("kind", KINDS)
def test_smaller_triangles_have_the_area_of_their_parent(kind):
    smaller, _ = tiling.subdivided(single(kind))
    assert (areas(smaller) > 0).all()  # none is turned over
    assert areas(smaller).sum() == pytest.approx(areas(single(kind)).sum(), rel=EXACT)


@pytest.mark.parametrize("kind", KINDS)
def test_a_point_of_a_triangle_lies_in_one_smaller_triangle_at_any_level(kind):
    triangles = single(kind)
    points = random_points_in(triangles, 500)
    for _ in range(4):
        triangles, _ = tiling.subdivided(triangles)
        assert (is_inside(points, triangles).sum(axis=1) == 1).all()


@pytest.mark.parametrize("kind", KINDS)
def test_sampling_tiles_lie_in_their_triangle(kind):
    triangles = single(kind)
    for _ in range(3):
        triangles, points = tiling.subdivided(triangles)
        assert is_inside(points.point, single(kind), EXACT).all()


def test_the_root_has_its_area_and_its_triangles_grow_by_phi_squared():
    triangles = tiling.root()
    assert areas(triangles)[0] == pytest.approx(tiling.ROOT_AREA, rel=EXACT)
    for level in range(1, 9):
        triangles, _ = tiling.subdivided(triangles)
        assert len(triangles) == tiling.FIBONACCI[2 * level + 2]
        assert len(np.unique(triangles.value)) == len(triangles)
        assert triangles.value.max() == len(triangles) - 1  # every number, once


def test_code_values_are_all_different_and_their_number_follows_the_limit():
    limits = 1000 * tiling.PHI ** np.arange(0, 7)
    counts = []
    for limit in limits:
        values = tiling.sampling_tiles_below(limit).value
        assert len(np.unique(values)) == len(values)
        assert values.max() < limit
        counts.append(len(values))
    np.testing.assert_allclose(counts, limits / 2, rtol=GROWTH)
    np.testing.assert_allclose(np.divide(counts[2:], counts[:-2]), tiling.PHI**2, rtol=GROWTH)


def test_what_appears_at_a_level_has_values_above_all_that_were_there():
    tiles = tiling.sampling_tiles_below(5000)
    assert (tiles.value >= tiling.FIBONACCI[2 * tiles.level]).all()
    assert (tiles.value < tiling.FIBONACCI[2 * tiles.level + 2]).all()


def test_a_lower_limit_gives_a_subset():
    few, many = tiling.sampling_tiles_below(300), tiling.sampling_tiles_below(900)
    chosen = many[many.value < 300]
    order = np.argsort(few.value), np.argsort(chosen.value)
    np.testing.assert_array_equal(few.value[order[0]], chosen.value[order[1]])
    np.testing.assert_allclose(few.point[order[0]], chosen.point[order[1]], rtol=EXACT)


def test_points_lie_evenly_at_any_limit():
    for limit in (3000, 4500, 7000):
        points = tiling.sampling_tiles_below(limit).point
        columns, rows = np.floor((points.real - 0.7) * 10), np.floor((points.imag - 0.05) * 10)
        inside = (columns >= 0) & (columns < 12) & (rows >= 0) & (rows < 4)
        counts = np.bincount((columns + 12 * rows)[inside].astype(int), minlength=48)
        expected = limit / 2 / tiling.ROOT_AREA * 0.01
        assert counts.mean() == pytest.approx(expected, rel=0.05)
        assert 0 < counts.var() < EVENNESS * expected


def test_structural_index_reads_the_six_newest_digits():
    values = np.arange(tiling.FIBONACCI[8])
    np.testing.assert_array_equal(tiling.structural_index(values, 3), values)  # a code of six digits
    at_four = tiling.structural_index(np.arange(tiling.FIBONACCI[10]), 4)
    assert (np.diff(at_four) >= 0).all()
    assert sorted(set(at_four)) == list(range(tiling.INDEX_COUNT))
    # 54 - 21 - ... : 54 = 34 + 13 + 5 + 2 has its digits at F9 F7 F5 F3, of which F4 to F9 are the newest.
    assert tiling.structural_index([54], 4)[0] == 13 + 5 + 2


def test_importance_index_is_logarithmic_and_repeats_with_each_level():
    importance = 1000 * tiling.PHI ** (2 * np.arange(0, 3, 0.01))
    index, level = tiling.importance_index(importance), tiling.level_of(importance)
    assert set(index) == set(range(tiling.INDEX_COUNT))
    assert (np.diff(index + tiling.INDEX_COUNT * level) >= 0).all()
    np.testing.assert_array_equal(index[:100], index[200:])
    np.testing.assert_array_equal(level[:100] + 2, level[200:])


def test_a_level_holds_every_value_that_its_importance_asks_for():
    values = np.concatenate([tiling.FIBONACCI[2:60:2] - 1, tiling.FIBONACCI[2:60:2]])
    assert (values < tiling.FIBONACCI[2 * tiling.level_of(values + 0.5) + 2]).all()


def test_a_sampling_tile_turns_by_half_a_turn_every_second_level():
    tiles = tiling.sampling_tiles_below(30)
    at_birth, next_one, second = (tiles.frame_at(tiles.level + k) for k in range(3))
    np.testing.assert_allclose(next_one, at_birth / tiling.PHI, rtol=EXACT)
    np.testing.assert_allclose(second, -at_birth / tiling.PHI**2, rtol=EXACT)


def test_too_deep_a_level_is_refused():
    deepest = tiling.Triangles(*(np.zeros(0, dtype=np.int64),) * 4, tiling.DEEPEST_LEVEL)
    with pytest.raises(ValueError, match="level 44"):
        tiling.subdivided(deepest)


@pytest.mark.parametrize("shape", [(1, 1), (7, 13), (16, 32)])
def test_the_pyramid_bounds_the_maximum_of_any_box(shape):
    rng = np.random.default_rng(2)
    image = rng.random(shape)
    pyramid = MaximumPyramid(image)
    left, top = rng.integers(-5, shape[1] + 5, 200), rng.integers(-5, shape[0] + 5, 200)
    right, bottom = left + rng.integers(0, 12, 200), top + rng.integers(0, 12, 200)
    bounds = pyramid.bound(left, right, top, bottom)

    def maximum(a, b, c, d):
        box = image[max(c, 0):max(d + 1, 0), max(a, 0):max(b + 1, 0)]
        return box.max(initial=0.0)

    for box, bound in zip(zip(left, right, top, bottom, strict=True), bounds, strict=True):
        a, b, c, d = box
        extent = 2 * max(b - a, d - c)
        assert maximum(a, b, c, d) <= bound <= maximum(a - extent, b + extent, c - extent, d + extent)
        if extent <= 2:
            assert bound == maximum(a, b, c, d)
