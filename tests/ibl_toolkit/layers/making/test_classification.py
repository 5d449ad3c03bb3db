"""Parts by depth, at infinity, made flat."""

import numpy as np
import pytest
from box_layers import BOTH, box_depth, box_layer, directions

from expanded_panoramas.ibl_toolkit.layers.making.classification import (
    by_depth,
    flattened,
    infinite_from,
    parted,
    with_infinity,
)
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama


def layer(depth, name="all", **attributes):
    depth = np.asarray(depth, np.float32)
    return Layer(name, "equirectangular", {"depth": depth, **attributes})


def panorama(*layers, radius=0.5):
    return LayeredPanorama(tuple(layers), np.eye(3), np.zeros(3), radius)


def test_parts_by_depth_are_the_layer_again():
    room = box_layer("equirectangular", 128)
    parts = by_depth(room, [1.6, 2.5])
    assert [part.name for part in parts] == [
        "room, to 1.6 m",
        "room, from 1.6 m to 2.5 m",
        "room, from 2.5 m",
    ]
    assert (sum(part.mask.astype(int) for part in parts) == 1).all()
    for part, (low, high) in zip(parts, ((0, 1.6), (1.6, 2.5), (2.5, np.inf)), strict=True):
        assert (part.depth[part.mask] >= low).all()
        assert (part.depth[part.mask] < high).all()


def test_a_mask_stays_the_domain_and_empty_parts_are_left_out():
    mask = np.zeros((4, 8), bool)
    mask[1, 2:5] = True
    masked = layer(np.ones((4, 8)), mask=mask)
    half = np.arange(8) < 4
    (part,) = parted(masked, {"left": np.broadcast_to(half, (4, 8)), "none": np.zeros((4, 8), bool)})
    assert np.array_equal(part.mask, mask & half)
    assert np.isnan(part.depth[~part.mask]).all()


@pytest.mark.parametrize("limits", [[0], [-1], [2, 1], [np.inf], [np.nan], [1, 1]])
def test_other_limits_are_refused(limits):
    with pytest.raises(ValueError, match="must be above 0, finite and ascending"):
        by_depth(layer(np.ones((2, 4))), limits)


def test_infinity_begins_where_parallax_ends():
    """From anywhere within the radius a point there is seen within a pixel of its direction, and at half the
    distance from somewhere it is not."""
    radius, pixel = 0.7, 2 * np.pi / 512
    turn = np.linspace(0, 2 * np.pi, 10001)
    eyes = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)

    def widest(distance):
        seen = np.array([distance, 0.0]) - eyes
        return np.abs(np.arctan2(seen[:, 1], seen[:, 0])).max() / pixel

    distance = infinite_from(radius, pixel)
    assert widest(1.001 * distance) < 1 < widest(0.999 * distance)


def test_what_is_far_goes_to_infinity():
    depth = np.full((32, 64), 3.0)
    depth[:10], depth[10:14] = np.inf, 1e4
    radiance = np.random.default_rng(2).random((32, 64, 3)).astype(np.float32)
    found = with_infinity(panorama(layer(depth, radiance=radiance)))
    near, far = found.layers
    assert far.name == "infinity"
    assert np.array_equal(far.mask, depth > 3)
    assert np.isposinf(far.depth[far.mask]).all()
    assert np.array_equal(near.mask, depth == 3)
    np.testing.assert_array_equal(far.radiance, radiance)


def test_of_two_far_layers_the_nearer_is_seen():
    hills, sky = np.full((8, 16), np.nan), np.full((8, 16), np.inf)
    hills[4:] = 1e5
    colour = {name: np.full((8, 16, 3), value, np.float32) for name, value in (("hills", 1), ("sky", 2))}
    both = panorama(
        layer(sky, "sky", radiance=colour["sky"]), layer(hills, "hills", radiance=colour["hills"])
    )
    (far,) = with_infinity(both).layers
    assert np.array_equal(far.radiance[..., 0] == 1, ~np.isnan(hills))


def test_nothing_far_changes_nothing():
    room = panorama(box_layer("cube map", 48))
    found = with_infinity(room)
    assert [one.name for one in found.layers] == ["room"]
    np.testing.assert_array_equal(found.layers[0].depth, room.layers[0].depth)


def test_a_thin_range_becomes_one_distance():
    """Bumps of 1 cm at 3 m, seen at 256 px from within 0.5 m: less than a pixel."""
    rng = np.random.default_rng(4)
    depth = 3 + 0.01 * rng.random((128, 256))
    flat = flattened(layer(depth), 0.5)
    assert np.unique(flat.depth).size == 1
    assert abs(flat.depth[0, 0] - 3.005) < 1e-3
    rough = 3 + np.sin(np.arange(256) / 256 * 10 * np.pi) * np.ones((128, 1))
    np.testing.assert_allclose(flattened(layer(rough), 0.5).depth, rough, rtol=1e-6)


def test_what_views_may_touch_is_not_made_flat():
    """Bumps of 1 cm and of 1 m from within 4 m, a rough plane at 0.5 m from within 1 m."""
    rng = np.random.default_rng(4)
    for middle, size, radius in ((3.0, 0.01, 4.0), (2.5, 1.0, 4.0)):
        rough = middle + size * rng.random((64, 128))
        np.testing.assert_allclose(flattened(layer(rough), radius).depth, rough, rtol=1e-6)
    down = -directions("equirectangular", 128)[..., 2]
    floor = np.where(down > 0.4, 0.5 / np.maximum(down, 0.4), np.nan) * (1 + 0.002 * rng.random(down.shape))
    np.testing.assert_allclose(flattened(layer(floor), 1.0).depth, floor, rtol=1e-6)


def test_a_rough_floor_becomes_a_plane_and_a_hill_stays():
    down = -directions("equirectangular", 256)[..., 2]
    rng = np.random.default_rng(4)
    floor = np.where(down > 0.2, 1.5 / np.maximum(down, 0.2), np.nan)
    rough = floor * (1 + 0.004 * rng.standard_normal(floor.shape))
    flat = flattened(layer(rough), 0.5)
    known = ~np.isnan(floor)
    assert np.array_equal(flat.mask, known)
    assert np.abs(flat.depth / floor - 1)[known].max() < 5e-4
    ball = np.where(down > 0.2, 1.5 + down, np.nan)
    np.testing.assert_allclose(flattened(layer(ball), 0.5).depth, ball, rtol=1e-6)


@pytest.mark.parametrize("mapping", BOTH)
def test_flat_stays_as_it_is(mapping):
    depth = box_depth(mapping, 96)
    depth[:4] = np.inf
    room = Layer("room", mapping, {"depth": depth})
    np.testing.assert_allclose(flattened(room, 0.5).depth, depth, rtol=1e-5)
