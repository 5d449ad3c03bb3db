"""The partition by blocks against the nearest of all sites for each pixel."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.voronoi import voronoi_partition

TIE = 1e-13
"""Cosines closer than this may go either way."""


def pixels(width, height):
    ij = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1)
    return equirectangular.direction_from_uv(equirectangular.uv_from_pixel(ij, width, height))


def assert_nearest(partition, sites):
    height, width = partition.shape
    unit = np.asarray(sites) / np.linalg.norm(sites, axis=1, keepdims=True)
    cosines = pixels(width, height) @ unit.T
    mine = np.take_along_axis(cosines, partition[..., None], axis=2)[..., 0]
    assert np.all(mine >= cosines.max(axis=2) - TIE)


def uniform(count, seed=0):
    return np.random.default_rng(seed).normal(size=(count, 3))


def around(direction, count, spread):
    return np.asarray(direction) + spread * uniform(count, 7)


SITES = {
    "one": uniform(1),
    "two": uniform(2),
    "many": uniform(150),
    "of any length": uniform(20) * 10.0 ** np.arange(-10, 10)[:, None],
    "at the seam": around([-1, 0, 0], 40, 0.02),
    "at the zenith": around([0, 0, 1], 40, 0.02),
    "at the nadir, with others": np.concatenate([around([0, 0, -1], 40, 0.01), uniform(10)]),
    "exactly at the poles": np.array([[0, 0, 1.0], [0, 0, -1], [1, 0, 0]]),
    "a hundredth of a pixel apart": np.array([[1, 0, 0], [1, 1e-4, 0], [1, 0, 1e-4], [-1, 1e-4, 0]]),
}


@pytest.mark.parametrize("name", SITES)
@pytest.mark.parametrize("size", [(2, 1), (64, 32), (90, 301), (530, 40)])
def test_every_pixel_gets_its_nearest_site(name, size):
    partition = voronoi_partition(SITES[name], *size)
    assert partition.dtype == np.int32
    assert partition.shape == size[::-1]
    assert_nearest(partition, SITES[name])


def test_all_blocks_are_looked_at():
    """Several of the largest blocks either way, and neither side a multiple of theirs."""
    assert_nearest(voronoi_partition(SITES["at the seam"], 700, 300), SITES["at the seam"])


def test_a_cell_goes_round_the_seam():
    partition = voronoi_partition([[-1, 0, 0], [1, 0, 0]], 16, 8)
    assert (partition[:, :4] == 0).all()
    assert (partition[:, 12:] == 0).all()
    assert (partition[:, 4:12] == 1).all()


def test_a_cell_goes_over_the_pole():
    """A site beside the zenith has pixels at every azimuth of the top row."""
    partition = voronoi_partition([[0.1, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], 32, 16)
    assert (partition[0] == 0).all()


def test_of_sites_at_one_place_the_first_gets_all():
    sites = uniform(5)
    partition = voronoi_partition(np.concatenate([sites, sites, 3 * sites[:1]]), 40, 20)
    assert (partition == voronoi_partition(sites, 40, 20)).all()


@pytest.mark.parametrize("share", [0.002, 0.5, 1.0])
def test_a_mask_takes_pixels_away_and_changes_no_other(share):
    sites = uniform(30)
    mask = np.random.default_rng(3).random((270, 530)) < share
    partition = voronoi_partition(sites, 530, 270, mask)
    assert (partition[~mask] == -1).all()
    assert (partition[mask] == voronoi_partition(sites, 530, 270)[mask]).all()


def test_an_empty_mask_leaves_nothing():
    assert (voronoi_partition(uniform(3), 8, 4, np.zeros((4, 8), bool)) == -1).all()


@pytest.mark.parametrize(
    ("sites", "said"),
    [(np.zeros((0, 3)), "0 sites"), ([[0, 0, 0]], "points nowhere"), ([[1, 0, np.nan]], "points nowhere")],
)
def test_what_is_no_site_is_refused(sites, said):
    with pytest.raises(ValueError, match=said):
        voronoi_partition(sites, 8, 4)
