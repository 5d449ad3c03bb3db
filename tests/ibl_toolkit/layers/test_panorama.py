"""The model of a layered panorama refuses what no layer can be."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama


def depth(height=4, width=8):
    return np.full((height, width), 2.0, np.float32)


def layer(name="wall", mapping="equirectangular", **attributes):
    return Layer(name, mapping, {"depth": depth(), **attributes})


def test_domain_is_where_depth_is_known_unless_a_mask_says_less():
    values = depth()
    values[0, 3:] = np.nan
    values[1] = np.inf
    assert np.count_nonzero(layer(depth=values).mask) == 32 - 5
    mask = np.zeros((4, 8), bool)
    mask[1, 2] = True
    assert layer(depth=values, mask=mask).mask is mask


def test_cube_map():
    made = Layer("all", "cube map", {"depth": depth(4, 6), "radiance": np.ones((4, 6, 3), np.float32)})
    assert made.size == (6, 4)
    assert made.radiance.shape == (4, 6, 3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": " "}, "name ' '"),
        ({"name": "a\nb"}, "must be printable"),
        ({"mapping": "mercator"}, "'mercator', must be one of equirectangular, cube map"),
        ({"mapping": "cube map"}, "layer 'wall': 8 x 4 px, a cube map must be 3N x 2N"),
        ({"glow": depth()}, "unknown attribute 'glow'"),
        ({"radiance": depth()}, r"radiance of shape \(4, 8\), must be \(H, W, 3\)"),
        ({"radiance": np.ones((4, 8, 4))}, r"radiance of shape \(4, 8, 4\)"),
        ({"reflectivity": np.ones((4, 8, 3))}, r"must be \(H, W\)"),
        ({"reflectivity": np.ones((2, 4))}, "several sizes: depth 8 x 4, reflectivity 4 x 2"),
        ({"depth": np.ones((4, 4))}, "4 x 4 px, an equirectangular map must be 2:1"),
        ({"depth": np.ones((4, 8), int)}, "depth of type int64, must be float"),
        ({"mask": depth()}, "mask of type float32, must be bool"),
        ({"material index": np.full((4, 8), -1)}, "material index of -1"),
        ({"depth": np.full((4, 8), np.nan)}, "empty domain"),
        ({"depth": np.zeros((4, 8))}, r"32 depths .* \(0, 0\): 0.0"),
        ({"depth": np.full((4, 8), np.nan), "mask": np.ones((4, 8), bool)}, "are NaN or not above 0"),
    ],
)
def test_impossible_layers(change, message):
    with pytest.raises(ValueError, match=message):
        layer(**change)


def test_layer_without_depth():
    with pytest.raises(ValueError, match="layer 'x' has no depth"):
        Layer("x", "equirectangular", {"radiance": np.ones((4, 8, 3))})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"layers": ()}, "one layer or more"),
        ({"layers": (layer(), layer())}, "two layers have the name 'wall'"),
        ({"world_from_panorama": np.diag([-1.0, 1, 1])}, "must be a .* rotation"),
        ({"world_from_panorama": 2 * np.eye(3)}, "must be a .* rotation"),
        ({"origin": np.array([0, 0, np.nan])}, "three finite numbers"),
        ({"origin": np.zeros(2)}, "three finite numbers"),
        ({"radius": -0.1}, "radius -0.1 m"),
        ({"radius": np.inf}, "radius inf m"),
    ],
)
def test_impossible_panoramas(change, message):
    right = {"layers": (layer(),), "world_from_panorama": np.eye(3), "origin": np.zeros(3), "radius": 0.5}
    LayeredPanorama(**right)
    with pytest.raises(ValueError, match=message):
        LayeredPanorama(**{**right, **change})
