"""Layers as one picture: what is nearest, of layers of other sizes and mappings."""

import numpy as np
import pytest
from layered_box import layered_box, radiance_in

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.flattened import flattened


def painted(layer, colour):
    radiance = np.broadcast_to(np.float32(colour), (*layer.depth.shape, 3)).copy()
    return Layer(layer.name, layer.mapping, {**layer.attributes, "radiance": radiance})


def test_equirectangular_layers_of_one_size_are_taken_pixel_by_pixel():
    panorama = layered_box(names=("objects", "room"))  # the order doesn't matter, infinity is behind all
    objects, room = painted(panorama.layers[0], (1, 0, 0)), panorama.layers[1]
    got = flattened(LayeredPanorama((objects, room), np.eye(3), np.zeros(3), 0.0))
    expected = np.where(
        objects.mask[..., None], (1, 0, 0), radiance_in(equirectangular.pixel_directions(64, 32))
    )
    np.testing.assert_allclose(got, expected, atol=2e-6)


def test_layers_of_other_sizes_and_mappings():
    large = layered_box("cube map", 96, ("walls",)).layers[0]
    small = painted(layered_box(width=32, names=("objects",)).layers[0], (0, 0, 2))
    got = flattened(LayeredPanorama((large, small), np.eye(3), np.zeros(3), 0.0))
    assert got.shape == (64, 128, 3)
    towards = equirectangular.pixel_directions(128, 64)
    blue = (got == (0, 0, 2)).all(axis=2)
    np.testing.assert_allclose(got[~blue], radiance_in(towards)[~blue], atol=0.01)
    assert blue.mean() == pytest.approx(small.mask.mean(), rel=0.1)


def test_where_nothing_is_it_is_black():
    objects = layered_box(names=("objects",)).layers[0]
    got = flattened(LayeredPanorama((objects,), np.eye(3), np.zeros(3), 0.0))
    assert ((got == 0).all(axis=2) == ~objects.mask).all()


def test_without_radiance():
    bare = Layer("bare", "equirectangular", {"depth": np.ones((2, 4), np.float32)})
    with pytest.raises(ValueError, match="layer 'bare' has no radiance, so it cannot be seen"):
        flattened(LayeredPanorama((bare,), np.eye(3), np.zeros(3), 0.0))
