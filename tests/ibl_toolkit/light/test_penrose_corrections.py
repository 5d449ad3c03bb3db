"""The table of correction vectors: made anew it is the same, and it does what it is for."""

import numpy as np
import penrose_corrections
import pytest

from expanded_panoramas.ibl_toolkit.light import penrose, penrose_tiles

SAME = 1e-3  # tile scales: OpenCV's float32 after ten steps
AREA_SPREAD = 0.12  # of uniform points' Voronoi cells over their mean; Poisson's is 0.53
NEAREST = 0.83  # mean distance to the nearest over a hexagonal lattice's; Poisson's is 0.47
LEAST = 0.6  # least distance, likewise
QUIET = 0.15  # power of the spectrum at low frequencies; Poisson's is 1


def uniform(fraction, level=9):
    """Points of uniform importance between two levels, raw and corrected, and which are away from the rim."""
    importance = penrose_tiles.PHI ** (2 * (level + fraction)) / np.sqrt(5)
    tiles = penrose_tiles.sampling_tiles_below(importance)
    table = np.load(penrose_corrections.TABLE) @ (1, 1j)
    structure = penrose_tiles.structural_index(tiles.value, level)
    corrections = table[penrose_tiles.importance_index(importance), structure] * tiles.frame_at(level)
    inner = penrose_corrections._is_inside(tiles.point, 4 * np.sqrt(penrose_tiles.ROOT_AREA / len(tiles)))
    return tiles.point, tiles.point + corrections, inner


def evenness(points, inner):
    """Spread of Voronoi areas, and mean and least distance to the nearest over a hexagonal lattice's."""
    area = penrose_corrections.voronoi_cells(points)[0][inner]
    distance = np.abs(points[inner][:, None] - points)
    distance[distance == 0] = np.inf
    nearest = distance.min(axis=1) / np.sqrt(area.mean() * 2 / np.sqrt(3))
    return area.std() / area.mean(), nearest.mean(), nearest.min()


def low_frequencies(points):
    """Mean power at a quarter to half of the frequency of the mean distance, in a window without edges."""
    middle, radius = complex(1.309, 0.425), 0.36
    offset = points[np.abs(points - middle) < radius] - middle
    window = np.cos(np.abs(offset) / radius * np.pi / 2) ** 2
    per_distance = np.sqrt(len(offset) / np.pi) / radius
    rings = np.linspace(0.25, 0.5, 8) * per_distance
    waves = (rings[:, None] * np.exp(1j * np.linspace(0, np.pi, 40, endpoint=False))).ravel()
    phases = 2 * np.pi * (offset[:, None] * waves.conj()).real
    return (np.abs((window[:, None] * np.exp(1j * phases)).sum(axis=0)) ** 2).mean() / (window**2).sum()


def test_the_script_makes_the_same_table_again():
    again = penrose_corrections.relaxed(penrose_corrections.all_fields())
    table = np.load(penrose_corrections.TABLE) @ (1, 1j)
    assert table.shape == (penrose_tiles.INDEX_COUNT, penrose_tiles.INDEX_COUNT)
    assert np.count_nonzero(table) > 290
    np.testing.assert_allclose(again, table, atol=SAME)


@pytest.mark.parametrize("fraction", [0.05, 0.3, 0.55, 0.8, 0.97])
def test_uniform_points_become_more_even(fraction):
    raw, corrected, inner = uniform(fraction)
    spread, nearest, least = evenness(corrected, inner)
    assert spread < AREA_SPREAD
    assert spread < 0.9 * evenness(raw, inner)[0]
    assert nearest > NEAREST
    assert least > LEAST


@pytest.mark.parametrize("fraction", [0.1, 0.4, 0.9])
def test_the_noise_is_blue(fraction):
    raw, corrected, _ = uniform(fraction)
    assert low_frequencies(corrected) < QUIET
    rng = np.random.default_rng(3)
    scattered = rng.uniform(0.8, 1.8, len(raw)) + 1j * rng.uniform(0, 0.9, len(raw))
    assert low_frequencies(scattered) > 0.5  # the measure itself


def test_the_sampler_reads_this_table():
    table = np.load(penrose_corrections.TABLE) @ (1, 1j)
    np.testing.assert_array_equal(penrose._corrections(), table)
