"""Mip levels: what a halved pixel is made of."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.files.mip import halved, mip_levels
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer

FLOOR = 2e-3  # relative, of a floor's depth at 128 x 64; plain means err five times as much


def block_layer(**attributes):
    """2 x 1 blocks; of the first one pixel is missing, of the second all."""
    depth = np.full((2, 4), np.nan, np.float32)
    depth[:, :2] = [[1, 3], [np.nan, np.inf]]
    return Layer("block", "equirectangular", {"depth": depth, **attributes})


def test_block_of_the_domain_only():
    normals = np.zeros((2, 4, 3), np.float32)
    normals[0, 0], normals[0, 1], normals[1, 0], normals[1, 1] = (1, 0, 0), (0, 1, 0), (9, 9, 9), (0, 0, 1)
    radiance = np.full((2, 4, 3), np.nan, np.float32)
    radiance[:, :2] = np.array([[3, 6], [1e9, 9]])[..., None]
    index = np.array([[7, 8, 1, 1], [9, 9, 1, 1]], np.uint32)
    small = halved(block_layer(normals=normals, radiance=radiance, **{"material index": index}))
    assert small.size == (2, 1)
    np.testing.assert_allclose(small.depth, [[3 / (1 + 1 / 3 + 0), np.nan]], rtol=1e-6)
    np.testing.assert_array_equal(small.radiance, [[[6, 6, 6], [0, 0, 0]]])
    np.testing.assert_allclose(small.attributes["normals"][0, 0], np.full(3, 3**-0.5), rtol=1e-6)
    assert small.attributes["material index"].tolist()[0][0] == 7
    assert small.mask.tolist() == [[True, False]]


def test_mask_smaller_than_the_depth():
    mask = np.zeros((4, 8), bool)
    mask[0, 0] = True
    small = halved(Layer("m", "equirectangular", {"depth": np.ones((4, 8), np.float32), "mask": mask}))
    assert np.argwhere(small.mask).tolist() == [[0, 0]]


def test_sky_stays_at_infinity():
    sky = Layer("sky", "equirectangular", {"depth": np.full((4, 8), np.inf, np.float32)})
    assert np.isposinf(halved(sky).depth).all()


def test_depth_of_a_floor():
    """A floor 1.5 m below, seen at half the resolution, is where it was."""

    def floor(width):
        down = -equirectangular.pixel_directions(width, width // 2)[..., 2].astype(np.float64)
        return np.where(down > 0.2, 1.5 / np.maximum(down, 0.2), np.nan)

    small = halved(Layer("floor", "equirectangular", {"depth": floor(256)}))
    relative = small.depth / floor(128) - 1
    assert np.nanmax(np.abs(relative)) < FLOOR


def test_count_of_levels():
    layer = Layer("all", "cube map", {"depth": np.ones((24, 36), np.float32)})
    assert [level.size for level in mip_levels(layer, 9)] == [(36, 24), (18, 12), (9, 6)]  # faces of 12, 6, 3
    assert len(mip_levels(layer, 2)) == 2
    with pytest.raises(ValueError, match="layer 'all' of 9 x 6 px cannot be halved"):
        halved(mip_levels(layer, 9)[-1])
