"""Look Around: the eye where the panorama was captured; direction and a chosen lens stay. Plan."""

import pytest
from room_job import calibrated


@pytest.fixture
def in_view(fresh_blend):
    """A context with a 3D View; gives bpy, a temp_override to enter, and its space."""
    bpy = fresh_blend
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "VIEW_3D"
    space = area.spaces.active
    return bpy, bpy.context.temp_override(window=window, area=area, space_data=space), space


def test_it_says_why_not(in_view):
    bpy, override, space = in_view
    with override, pytest.raises(RuntimeError, match="Open a panorama first"):
        bpy.ops.panorama.look_around()
    bpy.context.scene.panorama_set.image = bpy.data.images.new("panorama", 8, 4)
    with pytest.raises(RuntimeError, match="Only in a 3D View"):
        bpy.ops.panorama.look_around()
    space.region_3d.lock_rotation = True
    with override, pytest.raises(RuntimeError, match="rotation is locked"):
        bpy.ops.panorama.look_around()


def test_the_eye_moves_and_nothing_else(in_view, tmp_path):
    bpy, override, space = in_view
    from mathutils import Vector

    view = space.region_3d
    calibrated(bpy, tmp_path)
    origin = bpy.context.scene.panorama_place.origin
    origin.location.z = 1.75
    bpy.context.view_layer.update()
    view.view_perspective, view.view_rotation = "ORTHO", (0.5, 0.5, 0.5, 0.5)
    space.lens, rotation = 35, view.view_rotation.copy()
    with override:
        assert bpy.ops.panorama.look_around() == {"FINISHED"}
    assert view.view_perspective == "PERSP"
    assert (space.lens, view.view_rotation) == (35, rotation)
    eye = view.view_location + view.view_rotation @ Vector((0, 0, view.view_distance))
    assert tuple(eye) == pytest.approx((0, 0, 1.75), abs=2e-4)


def test_a_lens_that_nobody_has_set_becomes_wide(in_view, tmp_path):
    bpy, override, space = in_view
    calibrated(bpy, tmp_path)
    space.lens = 50
    with override:
        bpy.ops.panorama.look_around()
    assert space.lens == 24


def test_the_plan_is_seen_from_above_at_the_size_of_a_room(in_view, tmp_path):
    bpy, override, space = in_view
    calibrated(bpy, tmp_path)
    view = space.region_3d
    with override:
        bpy.ops.panorama.look_around()
        assert bpy.ops.panorama.look_at_plan() == {"FINISHED"}
    assert view.view_perspective == "ORTHO"
    assert tuple(view.view_rotation) == (1, 0, 0, 0)
    assert 3 < view.view_distance < 20


def test_before_calibration_the_eye_is_where_the_picture_is_shown_from(in_view):
    bpy, override, space = in_view
    bpy.context.scene.panorama_set.image = bpy.data.images.new("panorama", 8, 4)
    with override:
        bpy.ops.panorama.look_around()
    assert tuple(space.region_3d.view_location) == (0, 0, 1.5)


def test_views_that_look_around_follow_the_camera_height_and_others_stay(in_view, tmp_path):
    bpy, override, space = in_view
    state, view = bpy.context.scene.panorama_set, space.region_3d
    calibrated(bpy, tmp_path)
    with override:
        bpy.ops.panorama.look_around()
    state.camera_height = 1.2
    assert tuple(view.view_location) == pytest.approx((0, 0, 1.2))
    view.view_location, view.view_distance = (1, 2, 3), 4
    state.camera_height = 1.4
    assert tuple(view.view_location) == (1, 2, 3)
