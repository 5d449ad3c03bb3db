"""The sample room of layered panoramas: where its cameras stand, and its two layers, tiny."""

import math

import numpy as np
import pytest

pytest.importorskip("bpy")

from mathutils import Vector

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.sample_scenes.layered_room import capture, scene, sizes, views

WIDTH = 48
ALL_VIEWS = (*views.TABLE_8_1, views.C0, views.C1)
CLEARANCE_M = 0.3
FLAT_M = 0.03
"""Nothing of the room stands out farther from its walls, its floor and its ceiling."""

BARE = (
    ((0, 0.05, -1), 2, 1.15),
    ((0, 0.05, 1), 2, 1.75),
    ((-1, 0.02, 0.02), 0, 4.2),
    ((1, -0.02, 0.02), 0, 4.4),
    ((-0.2, -1, 0.02), 1, 3.6),
    ((0.2, 1, 0.02), 1, 3.6),
)
"""Directions to bare floor, ceiling and walls; the axis across which they lie, and how far [m]."""


@pytest.fixture
def room(fresh_blend):
    return scene.new_room()


def test_every_camera_is_in_the_room_and_clear_of_the_objects(room):
    room.view_layers[0].update()
    boxes = [world_box(thing) for thing in scene.layer_collection_of(room, scene.FRONT).objects]
    low, high = room_box()
    for view in ALL_VIEWS:
        eye = np.array(view.eye)
        assert ((eye > low + CLEARANCE_M) & (eye < high - CLEARANCE_M)).all(), view.name
        assert math.dist(view.eye, sizes.ORIGIN) <= sizes.RADIUS
        for first, last in boxes:
            outside = np.maximum(np.maximum(first - eye, eye - last), 0)
            assert np.linalg.norm(outside) > CLEARANCE_M, view.name


def test_the_table_has_the_views_of_the_thesis(fresh_blend):
    assert [view.name for view in views.TABLE_8_1] == [f"S{k}" for k in range(1, 14)]
    for view in ALL_VIEWS:
        assert np.linalg.norm(view.direction) == pytest.approx(1, abs=0.02)
    camera = views.add_camera(fresh_blend.context.scene, views.C1)
    fresh_blend.context.view_layer.update()
    assert camera.data.angle_x == pytest.approx(math.radians(60))
    looks = camera.matrix_world.to_3x3() @ Vector((0, 0, -1))
    assert np.allclose(looks, Vector(views.C1.direction).normalized(), atol=1e-5)
    assert (camera.matrix_world.to_3x3() @ Vector((1, 0, 0))).z == pytest.approx(0, abs=1e-6)


def test_the_layers_are_the_room_and_what_stands_in_it(room):
    panorama = capture.capture_layers(room, WIDTH, 1, denoise=False)
    back, front = panorama.layers
    empty = empty_room_depth(equirectangular.pixel_directions(WIDTH, WIDTH // 2))
    assert back.mask.all()
    assert (back.depth <= empty + 1e-3).all()
    # What stands out by FLAT_M shortens a slanting ray by more.
    assert (back.depth / empty > 1 - 2.5 * FLAT_M / sizes.ORIGIN[2]).all()
    assert np.mean(np.isclose(back.depth, empty, rtol=1e-4)) > 0.6  # bare wall, floor or ceiling
    weights = np.repeat(equirectangular.row_solid_angles(WIDTH, WIDTH // 2)[:, None], WIDTH, axis=1)
    assert 0.02 < weights[front.mask].sum() / (4 * math.pi) < 0.05  # thesis, 6.2.3: about 3 %
    assert (front.depth < back.depth)[front.mask].all()
    for toward, axis, distance in BARE:
        i, j = np.round(pixel_at(toward)).astype(int)
        pixel_direction = equirectangular.pixel_directions(WIDTH, WIDTH // 2)[j, i]
        assert back.depth[j, i] == pytest.approx(distance / abs(pixel_direction[axis]), rel=1e-4), toward
    again = capture.capture_layers(room, WIDTH, 1, denoise=False)
    bare = capture.capture_layers(room, WIDTH, None)
    for first, second, unlit in zip(panorama.layers, again.layers, bare.layers, strict=True):
        np.testing.assert_array_equal(first.depth, second.depth)
        np.testing.assert_array_equal(first.radiance, second.radiance)
        assert unlit.radiance is None
        at_rim = unlit.mask & ~first.mask  # the centre is covered, and the sample missed
        assert at_rim.mean() < 0.01
        np.testing.assert_array_equal(np.where(at_rim, np.nan, unlit.depth), first.depth)


def test_a_view_is_of_its_size_and_leaves_no_camera_behind(room):
    before = len(room.objects)
    picture = capture.render_view(room, views.C1, (32, 18), 1, denoise=False)
    assert picture.shape == (18, 32, 3)
    assert picture.mean() > 0.01
    assert len(room.objects) == before


def test_matte_is_all_diffuse_and_shiny_is_not(fresh_blend):
    assert not {"BSDF_GLOSSY", "FRESNEL"} & shaders(scene.new_room("matte"))
    assert "BSDF_GLOSSY" in shaders(scene.new_room("shiny"))
    with pytest.raises(ValueError, match="finish is 'wet'; expected one of matte, shiny"):
        scene.new_room("wet")


def room_box():
    room = sizes.ROOM
    return np.array([room.west, room.south, 0]), np.array([room.east, room.north, room.height])


def empty_room_depth(directions):
    """Distance [m] from the origin to the walls of the empty room."""
    low, high = (side - np.array(sizes.ORIGIN) for side in room_box())
    with np.errstate(divide="ignore"):
        return np.abs(np.where(directions > 0, high / directions, low / directions)).min(axis=-1)


def pixel_at(direction):
    uv = equirectangular.uv_from_direction(direction)
    return equirectangular.pixel_from_uv(uv, WIDTH, WIDTH // 2)


def world_box(thing):
    corners = np.array([thing.matrix_world @ Vector(corner) for corner in thing.bound_box])
    return corners.min(axis=0), corners.max(axis=0)


def shaders(made):
    materials = {slot.material for thing in made.collection.all_objects for slot in thing.material_slots}
    return {node.type for material in materials for node in material.node_tree.nodes}
