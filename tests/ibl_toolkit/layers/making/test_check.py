"""The report on layers: what is counted, and in what words."""

import numpy as np
from box_layers import box_depth

from expanded_panoramas.ibl_toolkit.layers.making.check import check_layers
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama


def panorama(*layers, radius=0.5):
    return LayeredPanorama(tuple(layers), np.eye(3), np.zeros(3), radius)


def layer(depth, name="wall", mapping="equirectangular"):
    return Layer(name, mapping, {"depth": np.asarray(depth, np.float32)})


def test_a_room_is_sound():
    for mapping, width in (("equirectangular", 128), ("cube map", 96)):
        report = check_layers(panorama(layer(box_depth(mapping, width), mapping=mapping)))
        assert report.sound
        assert report.warnings == ()


def test_a_jump_is_counted_once_for_each_pair():
    depth = np.full((16, 32), 4.0)
    depth[8, 10] = 1.0
    report = check_layers(panorama(layer(depth)))
    assert report.jumps == {"wall": 4}
    assert not report.sound
    assert "layer 'wall': depth jumps between 4 pairs" in report.warnings[0]


def test_a_jump_out_of_the_domain_is_none():
    depth = np.full((16, 32), 4.0)
    near = depth.copy()
    near[near == 4] = np.nan
    depth[8, 10], near[8, 10] = np.nan, 1.0
    report = check_layers(panorama(layer(depth), layer(near, "dot")))
    assert report.sound


def test_what_is_not_covered():
    """The upper half is in no layer, and says where."""
    depth = np.full((16, 32), 4.0)
    depth[:8] = np.nan
    report = check_layers(panorama(layer(depth)))
    np.testing.assert_allclose(report.uncovered, 0.5, rtol=1e-6)
    assert report.first_uncovered[2] > 0.9
    assert "50 % of the sphere are in no layer's domain" in report.warnings[0]


def test_what_is_within_the_radius():
    depth, near = np.full((16, 32), 4.0), np.full((8, 16), np.nan)
    near[:, :4] = 0.4
    report = check_layers(panorama(layer(depth), layer(near, "post")))
    np.testing.assert_allclose(report.within, 0.25, rtol=1e-6)
    assert "25 % of the sphere show what is nearer than the radius" in report.warnings[-1]
    assert check_layers(panorama(layer(depth), layer(near, "post"), radius=0.3)).within == 0


def test_layers_of_two_mappings_cover_together():
    upper = np.full((16, 32), 4.0)
    upper[9:] = np.nan
    lower = np.full((64, 96), 4.0)
    lower[:, :64][:, :0] = np.nan
    assert check_layers(panorama(layer(upper), layer(lower, "cube", "cube map"))).uncovered == 0
