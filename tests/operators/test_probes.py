"""Cameras and balls for a first look at a place."""

import numpy as np
import pytest
from room_job import calibrated


@pytest.fixture
def place(fresh_blend, tmp_path):
    calibrated(fresh_blend, tmp_path)
    return fresh_blend.context.scene.panorama_place


@pytest.mark.parametrize("lens", [50, 24])
def test_a_camera_that_sees_what_the_view_sees(fresh_blend, place, lens):
    """A lens of 2·f in a view is one of f on a camera; at the point of capture only the direction is kept."""
    from mathutils import Euler

    bpy = fresh_blend
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "VIEW_3D"
    space = area.spaces.active
    view = space.region_3d
    view.view_perspective, view.view_location, view.view_distance = "PERSP", (1, 2, 3), 4
    view.view_rotation = Euler((0.5, 0, 0)).to_quaternion()  # looks down, half a radian off the vertical
    space.lens = lens
    with bpy.context.temp_override(window=window, area=area, space_data=space):
        bpy.ops.panorama.camera_from_view(at_origin=False)
        camera = bpy.context.scene.camera
        eye = np.array([1, 2 - 4 * np.sin(0.5), 3 + 4 * np.cos(0.5)])
        assert np.allclose(camera.location, eye, atol=1e-5)
        assert camera.rotation_euler.x == pytest.approx(0.5)
        assert camera.data.lens == lens / 2
        bpy.ops.panorama.camera_from_view()
        camera = bpy.context.scene.camera
        assert tuple(camera.location) == pytest.approx(tuple(place.origin.location))
        assert camera.rotation_euler.x == pytest.approx(0.5)
        view.view_perspective = "ORTHO"
        with pytest.raises(RuntimeError, match="turn it to perspective"):
            bpy.ops.panorama.camera_from_view()
    with pytest.raises(RuntimeError, match="Only in a 3D View"):
        bpy.ops.panorama.camera_from_view()
