"""Layers sorted into classes: which there are, and from back to front."""

import numpy as np
import pytest
from box_layers import HALF, box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.making.sorting import Classes, sorted_layers
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

WIDTH, RADIUS = 128, 0.5
RAYS = directions("equirectangular", WIDTH)
NEAR = RAYS[..., 0] > 0.95


def room(radius=RADIUS):
    """A box room with a window to a mountain at 900 m, and a thing of 1.2 to 1.3 m before it."""
    depth = box_depth("equirectangular", WIDTH)
    depth = np.where(RAYS[..., 1] > 0.9, 900, depth).astype(np.float32)
    thing = np.where(NEAR, 1.2 + 1e-3 * (np.arange(WIDTH) % 2), np.nan).astype(np.float32)
    layers = (
        Layer("thing", "equirectangular", {"depth": thing}),
        Layer("room", "equirectangular", {"depth": depth}),
    )
    return LayeredPanorama(layers, np.eye(3), np.zeros(3), radius)


def names(panorama):
    return [layer.name for layer in panorama.layers]


def test_large_layers_alone_are_parted_by_geometry():
    found, _ = sorted_layers(room(), Classes(geometry=True, infinity=True))
    parts = {"floor", "ceiling", "walls", "rest"}
    assert set(names(found)) == {"thing", "infinity", *(f"room, {part}" for part in parts)}
    (floor,) = (layer for layer in found.layers if layer.name == "room, floor")
    assert (floor.depth * -RAYS[..., 2])[floor.mask] == pytest.approx(HALF[2])


def test_all_classes_together_keep_every_pixel():
    found, order = sorted_layers(room(), Classes((2.0,), geometry=True, infinity=True, flat=True))
    by_name = {layer.name: layer for layer in found.layers}
    assert {"room, walls, from 2 m", "room, floor, to 2 m", "thing, to 2 m"} <= set(by_name)
    assert "room, walls, from 2 m" in order.hides["thing, to 2 m"]
    for name, hidden in order.hides.items():
        assert all(names(found).index(other) < names(found).index(name) for other in hidden)
    covered = np.sum([layer.mask for layer in found.layers], axis=0)
    assert (covered == 1 + NEAR).all()
    assert np.unique(by_name["thing, to 2 m"].depth[NEAR]).size == 1  # thin, so it is flat
    assert np.isinf(by_name["infinity"].depth[by_name["infinity"].mask]).all()


def test_within_a_larger_radius_the_mountain_moves():
    found, _ = sorted_layers(room(radius=60), Classes(infinity=True))
    assert "infinity" not in names(found)


def test_depths_that_do_not_rise_are_refused():
    with pytest.raises(ValueError, match="must be above 0, finite and ascending"):
        sorted_layers(room(), Classes(depths=(3, 2)))
