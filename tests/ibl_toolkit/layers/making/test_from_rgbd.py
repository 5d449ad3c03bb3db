"""Layers of one RGB-D panorama: split, continued behind, whole again."""

import numpy as np
import pytest
from box_layers import BOTH, box_depth, directions
from box_with_object import OBJECT_HIGH, OBJECT_LOW, room_with_box

from expanded_panoramas.ibl_toolkit.layers.making.check import check_layers
from expanded_panoramas.ibl_toolkit.layers.making.from_rgbd import layers_from_rgbd
from expanded_panoramas.ibl_toolkit.metrics import psnr

WIDTHS = {"equirectangular": 512, "cube map": 384}
RADIUS = 0.5
HIDDEN_DEPTH = 0.035  # relative, of the hidden room's depth: the pixels at its creases; most are at 1e-5
HIDDEN_COLOUR = 25.0  # PSNR [dB] of the hidden room's soft waves


def grey(depth):
    return np.full((*depth.shape, 3), 0.5, np.float32)


def made(depth, radius=RADIUS, **options):
    return layers_from_rgbd(grey(depth), depth.astype(np.float32), radius, **options)


def nearest(panorama):
    """What the layers show from the origin: radiance and depth."""
    depths = np.stack([np.where(layer.mask, layer.depth, np.nan) for layer in panorama.layers])
    first = np.nanargmin(np.where(np.isnan(depths), np.inf, depths), axis=0)
    # A pixel all of whose layers lie at infinity: the first that has it.
    first = np.where(np.isinf(np.nanmin(depths, axis=0)), np.argmax(~np.isnan(depths), axis=0), first)
    colours = np.stack([layer.radiance for layer in panorama.layers])
    return (
        np.take_along_axis(colours, first[None, ..., None], axis=0)[0],
        np.take_along_axis(depths, first[None], axis=0)[0],
    )


def assert_alike_but_at_the_foot(front, room):
    """The box's pixels, give or take one where it stands on the floor: there both are as far away."""
    other = front.mask != room.hit
    rows = room.hit | np.roll(room.hit, 1, axis=0) | np.roll(room.hit, -1, axis=0)
    assert np.count_nonzero(other) < 0.06 * np.count_nonzero(room.hit)
    np.testing.assert_allclose(room.depth[other], room.behind_depth[other], rtol=0.03)
    assert (rows | np.roll(rows, 1, axis=1) | np.roll(rows, -1, axis=1))[other].all()


@pytest.mark.parametrize("mapping", BOTH)
def test_a_box_in_a_room(mapping):
    """Behind the box are floor, wall and the edge between them; all of it is known."""
    room = room_with_box(mapping, WIDTHS[mapping])
    panorama = layers_from_rgbd(room.radiance, room.depth, RADIUS)
    back, front = panorama.layers
    assert_alike_but_at_the_foot(front, room)
    assert (back.mask | front.mask).all()
    hidden = back.mask & room.hit
    assert np.count_nonzero(hidden) > 0.4 * np.count_nonzero(room.hit)
    off = np.abs(back.depth[hidden] / room.behind_depth[hidden] - 1)
    assert off.max() < HIDDEN_DEPTH
    assert np.median(off) < 1e-4
    assert psnr(back.radiance, room.behind, hidden) > HIDDEN_COLOUR
    assert check_layers(panorama).sound
    colour, depth = nearest(panorama)
    np.testing.assert_array_equal(colour, room.radiance)
    np.testing.assert_allclose(depth, room.depth, rtol=1e-6)


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("turn", ["seam", "pole"])
def test_over_seam_and_pole(mapping, turn):
    """The same box, behind the viewer, and overhead: nothing is cut where the map is."""
    low, high = {
        "seam": (OBJECT_LOW * (-1, 1, 1) - (0.6, 0, 0), OBJECT_HIGH * (-1, 1, 1) + (0.6, 0, 0)),
        "pole": (np.array([-0.3, -0.5, 0.8]), np.array([0.6, 0.4, 1.1])),
    }[turn]
    low, high = np.minimum(low, high), np.maximum(low, high)
    room = room_with_box(mapping, WIDTHS[mapping], low, high)
    panorama = layers_from_rgbd(room.radiance, room.depth, RADIUS)
    assert len(panorama.layers) == 2
    back, front = panorama.layers
    assert_alike_but_at_the_foot(front, room)
    hidden = back.mask & room.hit
    off = np.abs(back.depth[hidden] / room.behind_depth[hidden] - 1)
    assert hidden.any()
    assert off.max() < HIDDEN_DEPTH
    assert check_layers(panorama).sound


def test_three_surfaces_one_behind_the_other_make_three_layers():
    rays = directions("equirectangular", 256)
    depth = box_depth("equirectangular", 256).astype(float) + 3
    for distance, size in ((2.5, 0.4), (1.5, 0.2)):
        screen = (np.abs(rays[..., 1:] / rays[..., :1]) < size).all(axis=2) & (rays[..., 0] > 0)
        depth[screen] = (distance / rays[..., 0])[screen]
    panorama = made(depth)
    assert [layer.name for layer in panorama.layers] == ["background", "front 1", "front 2"]
    assert check_layers(panorama).sound
    two = made(depth, count=2)
    assert len(two.layers) == 2
    assert check_layers(two).jumps["front 1"] > 0


def test_a_box_on_the_floor_is_cut_off_where_it_stands():
    """There no depth jumps: the crease joins the curve's ends, and the floor stays in the background."""
    room = room_with_box("equirectangular", 256)
    front = layers_from_rgbd(room.radiance, room.depth, RADIUS).layers[1]
    rows = np.flatnonzero(front.mask.any(axis=1))
    assert abs(rows[-1] - np.flatnonzero(room.hit.any(axis=1))[-1]) <= 1


def test_a_lamp_does_not_spread():
    """A wall half of which shines 10^5 times as bright goes on so behind a screen: no mean of both."""
    rays = directions("equirectangular", 256)
    depth = 4 / np.maximum(np.abs(rays).max(axis=2), 1e-6)
    screen = (np.abs(rays[..., 1:] / rays[..., :1]) < 0.2).all(axis=2) & (rays[..., 0] > 0)
    depth[screen] = (2 / rays[..., 0])[screen]
    radiance = np.where(rays[..., 2:] > 0, 1e4, 0.1) * np.ones(3)
    radiance[screen] = 1
    back = layers_from_rgbd(radiance.astype(np.float32), depth.astype(np.float32), RADIUS).layers[0]
    hidden = back.mask & screen & (np.abs(rays[..., 1] / rays[..., 0]) > 0.16)
    bright, dark = (
        back.radiance[hidden & side][:, 0] for side in (rays[..., 2] > 0.05, rays[..., 2] < -0.05)
    )
    assert bright.min() > 300
    assert dark.max() < 30


def test_an_empty_room_is_one_layer():
    for mapping in BOTH:
        panorama = made(box_depth(mapping, WIDTHS[mapping]))
        assert len(panorama.layers) == 1
        assert panorama.layers[0].mask.all()


def test_a_grazing_floor_is_not_cut():
    """Its depth grows from 30 m to 90 m between the last two rows above which the sky begins."""
    rays = directions("equirectangular", 256)
    floor = rays[..., 2] < -0.01
    depth = np.where(floor, 1.5 / np.maximum(-rays[..., 2], 1e-9), np.inf)
    panorama = made(depth)
    assert len(panorama.layers) == 1
    assert panorama.layers[0].mask.all()


def test_sky_behind_a_wall():
    rays = directions("equirectangular", 128)
    wall = (rays[..., 0] > 0.5) & (rays[..., 2] < 0.3)
    depth = np.where(wall, 3 / np.maximum(rays[..., 0], 1e-9), np.inf)
    panorama = made(depth)
    back, front = panorama.layers
    assert np.array_equal(front.mask, wall)
    assert np.isposinf(back.depth[back.mask]).all()
    assert np.count_nonzero(back.mask & wall) > 0
    assert check_layers(panorama).sound


def test_single_pixels_and_a_ring_with_a_hole():
    depth = np.full((64, 128), 5.0)
    depth[20, 40] = depth[0, 0] = depth[63, 127] = depth[30, 0] = 1.0
    depth[40:50, 60:80] = 2.0
    depth[43:46, 66:74] = 5.0  # one looks through
    panorama = made(depth)
    assert len(panorama.layers) == 2
    assert np.array_equal(panorama.layers[1].mask, depth < 5)
    assert check_layers(panorama).sound
    back = panorama.layers[0]
    np.testing.assert_allclose(back.depth[back.mask], 5, rtol=0.04)  # a ball's plane goes off it


def test_a_curve_that_ends_in_a_surface_gets_a_tongue():
    """A ramp beside a wall: its jump fades out, and no crease closes the curve."""
    depth = np.full((128, 256), 4.0)
    depth[60:68] = 4.0
    fading = np.linspace(1.5, 0, 100)
    for row in range(50, 64):
        depth[row, 60:160] = 4 - fading * np.sin((row - 50) / 13 * np.pi / 2) ** 2
    panorama = made(depth)
    assert check_layers(panorama).sound
    assert len(panorama.layers) == 2


@pytest.mark.parametrize("size", [(1, 2), (2, 4), (2, 3), (4, 6)])
def test_tiny_maps(size):
    rng = np.random.default_rng(size)
    depth = rng.choice([1.0, 3.0, np.inf], size)
    panorama = made(depth)
    assert check_layers(panorama).uncovered == 0


def test_depth_with_noise():
    """Of a thousandth, as of a good scanner: the box is cut off as before."""
    room = room_with_box("equirectangular", 512)
    rng = np.random.default_rng(6)
    noisy = room.depth * (1 + 1e-3 * rng.standard_normal(room.depth.shape)).astype(np.float32)
    panorama = layers_from_rgbd(room.radiance, noisy, RADIUS)
    back, front = panorama.layers
    assert np.count_nonzero(front.mask != room.hit) < 0.05 * np.count_nonzero(room.hit)
    hidden = back.mask & room.hit
    assert np.median(np.abs(back.depth[hidden] / room.behind_depth[hidden] - 1)) < 1e-3


def test_noise_at_random():
    rng = np.random.default_rng(5)
    for mapping, shape in (("equirectangular", (32, 64)), ("cube map", (32, 48))):
        depth = np.exp(rng.normal(1, 0.5, shape))
        panorama = made(depth)
        report = check_layers(panorama)
        assert report.uncovered == 0, mapping
        np.testing.assert_allclose(nearest(panorama)[1], depth, rtol=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"depth": 0.0}, r"depth of 1 pixels, the first at \(3, 2\), is 0.0: must be above 0"),
        ({"depth": np.nan}, "NaN is unknown"),
        ({"radiance": np.inf}, "radiance of 1 pixels"),
        ({"shape": (8, 15)}, "15 x 8 px must be 2:1"),
        ({"shape": (0, 0)}, "0 x 0 px must be 2:1"),
        ({"count": 0}, "count 0"),
        ({"radius": -1.0}, "radius -1.0"),
    ],
)
def test_refused(change, message):
    depth = np.ones(change.get("shape", (8, 16)), np.float32)
    radiance = grey(depth)
    if "depth" in change:
        depth[2, 3] = change["depth"]
    if "radiance" in change:
        radiance[2, 3] = change["radiance"]
    with pytest.raises(ValueError, match=message):
        layers_from_rgbd(radiance, depth, change.get("radius", 0.5), count=change.get("count"))


def test_other_shapes_are_refused():
    with pytest.raises(ValueError, match=r"must be \(H, W, 3\)"):
        layers_from_rgbd(np.ones((8, 16)), np.ones((8, 16)), 0.5)
