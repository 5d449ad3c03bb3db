"""Surfaces along each ray, against boxes whose distances are known."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import small_scenes as small  # noqa: E402
from boxed_scene import (  # noqa: E402
    DIRECTIONS,
    EMISSION,
    LEVEL,
    METRES,
    ORIGIN,
    RADIUS,
    TINY,
    WALL,
    box_depth,
    room_depth,
    surfaces,
)
from mathutils import Matrix, Vector  # noqa: E402

from expanded_panoramas.cycles_integration.layer_capture import capture_surfaces  # noqa: E402
from expanded_panoramas.cycles_integration.layer_render import LayerCapture  # noqa: E402
from expanded_panoramas.ibl_toolkit import equirectangular  # noqa: E402


def test_the_second_surface_is_the_wall_behind_with_its_own_colour(furnished_room):
    panorama = capture_surfaces(furnished_room, LEVEL, RADIUS, TINY)
    first, _, second = panorama.layers
    front = np.minimum(box_depth(DIRECTIONS), room_depth(DIRECTIONS))
    assert first.mask.all()
    np.testing.assert_allclose(first.depth, front, atol=METRES)
    assert second.mask.any()
    assert not (second.mask & ~np.isfinite(box_depth(DIRECTIONS))).any()
    np.testing.assert_allclose(second.depth[second.mask], room_depth(DIRECTIONS)[second.mask], atol=METRES)
    np.testing.assert_allclose(
        second.radiance[second.mask], np.broadcast_to(WALL, (second.mask.sum(), 3)), rtol=1e-3
    )
    np.testing.assert_allclose(panorama.origin, ORIGIN, atol=1e-6)


def test_all_that_a_view_in_the_radius_sees_is_in_a_layer_and_not_much_else(furnished_room):
    width = 256
    _, second = surfaces(furnished_room, LEVEL, RADIUS, LayerCapture(width, samples=1))
    uncovered = np.zeros((width // 2, width), bool)
    rng = np.random.default_rng(5)
    for _ in range(100):
        eye = rng.normal(size=3)
        eye *= RADIUS / np.linalg.norm(eye)
        rays = rng.normal(size=(20000, 3))
        seen = room_depth(rays, eye) < box_depth(rays, eye)
        points = eye + rays[seen] * room_depth(rays[seen], eye)[:, None]
        uv = equirectangular.uv_from_direction(points)
        column, row = np.floor(uv * (width, width // 2)).astype(int).T
        uncovered[row, column] = True
    is_hidden = np.isfinite(box_depth(equirectangular.pixel_directions(width, width // 2).astype(float)))
    uncovered &= is_hidden
    assert 250 < uncovered.sum() < 0.8 * is_hidden.sum()
    assert second.mask[uncovered].all()
    assert second.mask.sum() < 1.3 * uncovered.sum()


def test_open_surfaces_are_seen_from_behind(hollow_room):
    for distance in (1.0, 2.0):
        place = Vector(ORIGIN) + Vector((distance, 0, 0))
        small.add_plane(hollow_room, small.material(EMISSION), 0.5, place, normal=(1, 0, 0))
    layers = surfaces(hollow_room, LEVEL, 0.9, TINY)
    assert [round(float(np.nanmin(layer.depth)), 1) for layer in layers[1:]] == [2.0, 3.0]


def test_sky_lies_at_infinity_before_and_behind(fresh_blend):
    scene = fresh_blend.context.scene
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
    small.add_ball(scene, small.material(EMISSION), 0.4, (2, 0, 0))
    first, second = surfaces(scene, Matrix(), 0.3, TINY)
    assert first.mask.all()
    assert np.isinf(first.depth[:, 0]).all()
    assert np.isinf(second.depth[second.mask]).all()
    np.testing.assert_allclose(second.radiance[second.mask].mean(axis=0), (0.1, 0.2, 0.4), rtol=1e-3)


def test_other_options_and_radii_are_refused(furnished_room):
    with pytest.raises(ValueError, match="radius -1 m: must be finite and above 0"):
        capture_surfaces(furnished_room, LEVEL, -1, TINY)
    with pytest.raises(ValueError, match="0 layers of width 64 px"):
        LayerCapture(64, most=0)
