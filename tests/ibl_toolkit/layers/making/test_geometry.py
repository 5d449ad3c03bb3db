"""Floor, ceiling, walls and lights of a box room."""

import numpy as np
import pytest
from box_layers import BOTH, HALF, box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.making.geometry import by_geometry
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer

WIDTHS = {"equirectangular": 256, "cube map": 192}


def classes_of(layer, turn, **options):
    return {part.name.split(", ")[1]: part.mask for part in by_geometry(layer, turn, **options)}


def room(mapping, lamp=None):
    rays = directions(mapping, WIDTHS[mapping])
    depth = box_depth(mapping, WIDTHS[mapping])
    radiance = np.full((*depth.shape, 3), 0.3, np.float32)
    shines = np.zeros(depth.shape, bool)
    if lamp:
        points = rays * depth[..., None]
        shines = (points[..., 2] > HALF[2] - 1e-4) & (np.abs(points[..., :2]) < 0.3).all(axis=2)
        radiance[shines] = lamp
    sides = np.argmax(np.abs(rays) / HALF, axis=2)
    return Layer("room", mapping, {"depth": depth, "radiance": radiance}), rays, sides, shines


@pytest.mark.parametrize("mapping", BOTH)
def test_a_room_with_a_lamp(mapping):
    layer, rays, sides, shines = room(mapping, 50)
    found = classes_of(layer, np.eye(3))
    assert np.array_equal(found["lights"], shines)
    truth = {
        "floor": (sides == 2) & (rays[..., 2] < 0),
        "ceiling": (sides == 2) & (rays[..., 2] > 0) & ~shines,
        "walls": sides < 2,
    }
    for name, mask in truth.items():
        assert not (found[name] & ~mask).any(), name
        assert np.count_nonzero(found[name]) > 0.93 * np.count_nonzero(mask), name  # creases are `rest`
    assert (sum(mask.astype(int) for mask in found.values()) == 1).all()


def test_a_tilted_camera():
    """The world's up is the panorama's +x: what was a wall is the ceiling."""
    layer, rays, sides, _ = room("equirectangular")
    turn = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])
    found = classes_of(layer, turn)
    ceiling = (sides == 0) & (rays[..., 0] > 0)
    assert np.count_nonzero(found["ceiling"] & ceiling) > 0.9 * np.count_nonzero(ceiling)
    assert not (found["ceiling"] & ~ceiling).any()


def test_a_table_is_not_the_floor():
    rays = directions("equirectangular", 256)
    depth = box_depth("equirectangular", 256).astype(float)
    down = np.maximum(-rays[..., 2], 1e-6)
    table = (rays[..., 2] < 0) & (np.abs(rays[..., :2] / down[..., None] - 0.2) < 0.5).all(axis=2)
    depth[table] = (0.6 / down)[table]
    layer = Layer("room", "equirectangular", {"depth": depth.astype(np.float32)})
    found = classes_of(layer, np.eye(3))
    assert np.count_nonzero(found["rest"] & table) > 0.9 * np.count_nonzero(table)
    assert not (found["floor"] & table).any()


def test_sky_is_the_rest_and_the_sun_a_light():
    depth = np.full((32, 64), np.inf, np.float32)
    radiance = np.ones((32, 64, 3), np.float32)
    radiance[5, 7] = 1e5
    found = classes_of(Layer("sky", "equirectangular", {"depth": depth, "radiance": radiance}), np.eye(3))
    assert set(found) == {"lights", "rest"}
    assert np.argwhere(found["lights"]).tolist() == [[5, 7]]


def test_own_normals_and_threshold():
    depth = np.full((16, 32), 2.0, np.float32)
    normals = np.zeros((16, 32, 3), np.float32)
    normals[..., 2] = -1
    radiance = np.full((16, 32, 3), 0.5, np.float32)
    layer = Layer("dome", "equirectangular", {"depth": depth, "normals": normals, "radiance": radiance})
    assert "ceiling" in classes_of(layer, np.eye(3))
    assert set(classes_of(layer, np.eye(3), light_luminance=0.4)) == {"lights"}
    with pytest.raises(ValueError, match="light_luminance 0 must be above 0"):
        by_geometry(layer, np.eye(3), 0)


def test_a_single_pixel():
    depth = np.full((16, 32), np.nan, np.float32)
    depth[0, 3] = 2
    (part,) = by_geometry(Layer("dot", "equirectangular", {"depth": depth}), np.eye(3))
    assert part.mask.sum() == 1
