"""Views against un-projection with the whole matrices, which eq. 5.5 inverts."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector
from expanded_panoramas.ibl_toolkit.views import View

SIZE = 800, 600
HEIGHT = 1.5
TURN = rotation_from_vector([0.2, -0.1, 0.7])
SAME = 1e-9
XY = np.array([[0.5, 0.5], [799.5, 0.5], [400.0, 300.0], [12.0, 590.0], [650.0, 450.0]])


def perspective(near=0.1, far=100.0):
    """Off-centre, with unequal scales."""
    depth = [-(far + near) / (far - near), -2 * far * near / (far - near)]
    return np.array([[1.2, 0, 0.1, 0], [0, 2, -0.2, 0], [0, 0, *depth], [0, 0, -1, 0]])


def orthographic():
    return np.array([[0.2, 0, 0, 0.05], [0, 0.3, 0, -0.1], [0, 0, -0.01, 0], [0, 0, 0, 1]])


def looking(turn=(1.2, 0.3, 0.4)):
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = rotation_from_vector(turn), (0.3, 0.2, -4)
    return view


def view_of(window, view):
    return View.from_matrices(window, view, TURN, HEIGHT, SIZE)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def unprojected(window, view, xy, depth):
    """World points (n, 3) at a clip depth."""
    clip = np.column_stack([2 * xy / SIZE - 1, np.full((len(xy), 1), depth), np.ones((len(xy), 1))])
    points = clip @ np.linalg.inv(window @ view).T
    return points[:, :3] / points[:, 3:]


@pytest.mark.parametrize("clip", [(0.1, 100.0), (1e-3, 1e6)], ids=["usual", "wide"])
def test_perspective_rays_are_those_of_the_matrices(clip):
    window, view = perspective(*clip), looking()
    rays = unprojected(perspective(), view, XY, 0.5) - unprojected(perspective(), view, XY, -0.5)
    assert np.allclose(unit(view_of(window, view).directions_at(XY)), unit(rays @ TURN), atol=SAME)


def test_an_orthographic_view_shows_the_floor_as_a_plan():
    window, view = orthographic(), looking()
    directions = view_of(window, view).directions_at(XY)
    floor = directions @ TURN.T + (0, 0, HEIGHT)
    assert np.allclose(floor[:, 2], 0, atol=SAME)
    clip = np.column_stack([floor, np.ones(len(floor))]) @ (window @ view).T
    assert np.allclose((clip[:, :2] + 1) / 2 * SIZE, XY)


def test_along_the_floor_an_orthographic_view_shows_its_own_direction():
    level = np.eye(4)
    level[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # a front view
    directions = view_of(orthographic(), level).directions_at(XY)
    assert np.allclose(directions @ TURN.T, (0, 1, 0))


@pytest.mark.parametrize("window", [perspective(), orthographic()], ids=["perspective", "orthographic"])
def test_there_and_back(window):
    view = view_of(window, looking())
    assert np.allclose(view.pixels_of(3 * view.directions_at(XY)), XY)


def test_what_is_behind_or_above_is_not_shown():
    ahead = view_of(perspective(), looking())
    assert np.isnan(ahead.pixels_of(-ahead.directions_at(XY))).all()
    above = np.array([0, 0, 1.0]) @ TURN
    assert np.isnan(view_of(orthographic(), looking()).pixels_of(above)).all()


def test_points_project_as_through_the_matrices():
    world = np.array([[0.1, 0.2, 0.3], [1, -1, 0]])
    for window in (perspective(), orthographic()):
        clip = np.column_stack([world, np.ones(2)]) @ (window @ looking()).T
        expected = (clip[:, :2] / clip[:, 3:] + 1) / 2 * SIZE
        seen = view_of(window, looking()).pixels_of_points((world - (0, 0, HEIGHT)) @ TURN)
        assert np.allclose(seen[clip[:, 3] > 0], expected[clip[:, 3] > 0])


def test_a_matrix_without_scale_is_refused():
    with pytest.raises(ValueError, match="projects nothing"):
        view_of(np.zeros((4, 4)), looking())
