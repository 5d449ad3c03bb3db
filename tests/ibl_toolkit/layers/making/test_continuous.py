"""Successive surfaces become continuous layers that keep what was found behind."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.making.check import check_layers
from expanded_panoramas.ibl_toolkit.layers.making.continuous import continuous_layers
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

WIDTH, RADIUS = 128, 0.5
DIRECTIONS = equirectangular.pixel_directions(WIDTH, WIDTH // 2).astype(np.float64)
CARD = (DIRECTIONS[..., 0] > 0.85) & (np.abs(DIRECTIONS[..., 2]) < 0.3)
WALL, FRONT, FLAP = 5.0, 2.0, 3.5
HIDDEN = np.array([0.2, 0.9, 0.4], np.float32)
SURFACES = ("surface 1", "surface 2")


def layer(name, depth, colour=(0.5, 0.5, 0.5)):
    radiance = np.broadcast_to(np.array(colour, np.float32), (*depth.shape, 3)).copy()
    return Layer(name, "equirectangular", {"radiance": radiance, "depth": depth.astype(np.float32)})


def captured(*more):
    """A card before a wall, and the wall behind it in another colour."""
    first = layer("surface 1", np.where(CARD, FRONT, WALL))
    second = layer("surface 2", np.where(CARD, WALL, np.nan), HIDDEN)
    return LayeredPanorama((first, second, *more), np.eye(3), np.array([1.0, 2.0, 3.0]), RADIUS)


def test_what_was_found_behind_goes_to_the_background():
    made = continuous_layers(captured(), SURFACES)
    background, front = made.layers
    assert check_layers(made).sound
    assert background.mask.all()
    np.testing.assert_allclose(background.depth, WALL, rtol=1e-5)
    np.testing.assert_array_equal(background.radiance[CARD], np.broadcast_to(HIDDEN, (CARD.sum(), 3)))
    np.testing.assert_array_equal(front.mask, CARD)
    assert (made.radius, made.origin.tolist()) == (RADIUS, [1, 2, 3])


def test_what_is_between_stays_where_something_is_behind():
    """Behind the card a flap, of which the wall is behind one half only."""
    left = CARD & (DIRECTIONS[..., 1] > 0)
    first = captured().layers[0]
    flap = layer("surface 2", np.where(CARD, FLAP, np.nan), (1, 0, 0))
    wall = layer("surface 3", np.where(left, WALL, np.nan), HIDDEN)
    found = LayeredPanorama((first, flap, wall), np.eye(3), np.zeros(3), RADIUS)
    made = continuous_layers(found, ("surface 1", "surface 2", "surface 3"))
    background, _, between = made.layers
    np.testing.assert_allclose(background.depth[left], WALL, rtol=1e-5)
    np.testing.assert_allclose(background.depth[CARD & ~left], FLAP, rtol=1e-5)
    assert between.name == "surface 2"
    np.testing.assert_array_equal(between.mask, left)
    np.testing.assert_array_equal(between.depth[left], np.float32(FLAP))


def test_other_layers_are_dealt_until_no_depth_jumps():
    upper = CARD & (DIRECTIONS[..., 2] > 0)
    back = layer("back of surface 1", np.where(upper, FLAP, np.where(CARD, FRONT, np.nan)))
    made = continuous_layers(captured(back), SURFACES)
    assert check_layers(made).sound
    parts = made.layers[2:]
    assert [part.name for part in parts] == ["back of surface 1", "back of surface 1, part 2"]
    np.testing.assert_array_equal(parts[0].mask | parts[1].mask, CARD)
    assert not (parts[0].mask & parts[1].mask).any()


def test_surfaces_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="'surface 2' must cover the whole sphere"):
        continuous_layers(captured(), SURFACES[::-1])
    small = layer("surface 3", np.full((4, 8), 3.0))
    with pytest.raises(ValueError, match="must have one size"):
        continuous_layers(captured(small), (*SURFACES, "surface 3"))
