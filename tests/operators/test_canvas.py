"""What an editor shows where: rays and curves of its pixels."""

import numpy as np
import pytest

pytest.importorskip("bpy")
from drawing_hand import FLAT, STAND, look_from

from expanded_panoramas.ibl_toolkit.views import View
from expanded_panoramas.operators.canvas import ViewCanvas

BESIDE = look_from((4.0, -7.0, 5.0), (0.5, 0.0, 0.5))


@pytest.mark.parametrize("canvas", [FLAT, BESIDE])
def test_a_ray_goes_through_the_point_shown_there(canvas):
    point = STAND.from_origin(np.array([[1.0, 0.5, 0.3]]))
    start, direction = canvas.ray_at(canvas.curve_of(point)[0])
    across = np.cross(point[0] - start, direction) / np.linalg.norm(direction)
    assert across == pytest.approx(np.zeros(3), abs=1e-9)
    assert (point[0] - start) @ direction > 0


@pytest.mark.parametrize("height", [-1.0, 0.0, 1e-9, 1.0])
def test_a_plan_meets_the_floor_on_both_sides_of_its_own_plane(height):
    view_from_world = np.eye(4)
    view_from_world[2, 3] = -height
    matrices = np.diag([0.2, 0.2, 0.01, 1]), view_from_world
    plan = ViewCanvas(
        View.from_matrices(*matrices, STAND.world_from_panorama, STAND.camera_height, (500, 500))
    )
    xy = plan.curve_of(STAND.from_origin(np.array([[1.0, 2.0, 0.0]])))[0]
    assert STAND.floor_under(*plan.ray_at(xy)) == pytest.approx([1, 2])


def test_outside_of_the_image_there_is_no_ray():
    assert FLAT.ray_at(np.array([5.0, 60.0])) is None


def test_a_curve_breaks_at_the_seam():
    around = np.radians([170, 175, 185, 190])
    pixels = FLAT.curve_of(np.column_stack([np.cos(around), np.sin(around), np.zeros(4)]))
    assert np.isnan(pixels[2]).all()
    assert np.isfinite(pixels[[0, 1, 3, 4]]).all()
    assert np.abs(np.diff(pixels[[3, 4], 0])) < 100


def test_what_is_behind_the_eye_is_not_shown():
    behind = STAND.from_origin(np.array([[5.0, -9.0, 5.0], [0.5, 0.0, 0.5]]))
    shown = np.isfinite(BESIDE.curve_of(behind)).all(axis=1)
    assert shown.tolist() == [False, True]
