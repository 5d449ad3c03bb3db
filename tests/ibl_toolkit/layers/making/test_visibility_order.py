"""Which layer may hide which."""

import numpy as np
import pytest
from box_layers import BOTH, box_layer, directions

from expanded_panoramas.ibl_toolkit.layers.making.geometry import by_geometry
from expanded_panoramas.ibl_toolkit.layers.making.visibility_order import visibility_order
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

SHAPE = (128, 256)


def order_of(radius, **depths):
    layers = tuple(
        Layer(name, "equirectangular", {"depth": depth.astype(np.float32)}) for name, depth in depths.items()
    )
    return visibility_order(LayeredPanorama(layers, np.eye(3), np.zeros(3), radius))


def screen(distance, columns, rows=slice(50, 80)):
    depth = np.full(SHAPE, np.nan)
    depth[rows, columns] = distance
    return depth


def test_one_behind_the_other():
    found = order_of(
        0.5,
        near=screen(1, slice(90, 110)),
        middle=screen(2, slice(80, 120)),
        sky=np.full(SHAPE, np.inf),
    )
    assert found.hides == {"near": ("middle", "sky"), "middle": ("sky",), "sky": ()}
    assert found.order == ("sky", "middle", "near")
    assert found.cycles == ()


def test_beside_each_other_only_from_far_enough_aside():
    """Their gap is 20 px, 28°: parallax of 1 m against 4 m is 8° at 0.2 m, 38° at 0.75 m."""
    sides = {"near": screen(1, slice(60, 80)), "far": screen(4, slice(100, 120))}
    assert order_of(0.2, **sides).hides["near"] == ()
    assert order_of(0.75, **sides).hides["near"] == ("far",)
    assert order_of(0.75, **sides).hides["far"] == ()


def test_two_that_hide_each_other_are_a_cycle():
    one, other = screen(1, slice(60, 90)), screen(2, slice(60, 90))
    one[50:80, 150:180], other[50:80, 150:180] = 3, 1.5
    found = order_of(0.5, one=one, back=np.full(SHAPE, 9.0), other=other)
    assert found.cycles == (("one", "other"),)
    assert found.order[0] == "back"
    assert set(found.hides["one"]) == {"back", "other"}


def test_within_the_radius_the_nearer_is_in_front():
    rows = slice(60, 64)
    found = order_of(
        3.0,
        far=screen(2, slice(80, 96), rows),
        near=screen(1, slice(90, 94), rows),
        touching=screen(1, slice(92, 96), rows),
    )
    assert found.hides == {"near": ("far",), "touching": ("far",), "far": ()}


@pytest.mark.parametrize("mapping", BOTH)
def test_sides_of_a_room_do_not_hide_each_other(mapping):
    room = box_layer(mapping, {"equirectangular": 256, "cube map": 192}[mapping])
    layers = tuple(part for part in by_geometry(room, np.eye(3)) if "rest" not in part.name)
    assert len(layers) == 3
    found = visibility_order(LayeredPanorama(layers, np.eye(3), np.zeros(3), 0.8))
    assert not any(found.hides.values())


def test_a_small_thing_on_a_large_map_is_not_lost():
    rays = directions("equirectangular", 2048)
    depth = np.where(rays @ (1, 0, 0) > 0.99999, 1.0, np.nan)
    assert 0 < np.count_nonzero(~np.isnan(depth)) < 60
    found = order_of(0.5, speck=depth, wall=np.full(SHAPE, 3.0))
    assert found.hides["speck"] == ("wall",)
