"""Exact picks of a known room give back its camera, whatever mixture of them there is."""

import json

import numpy as np
import pytest
from known_room import (
    CAMERA_HEIGHT,
    CORNERS,
    LINES_X,
    LINES_Y,
    RUG,
    SIZE,
    SKYLIGHT,
    TILE,
    UPSIDE_DOWN,
    WINDOW,
    WORLD_FROM_PANORAMA,
    angle_deg,
    seen,
    turned,
)

from expanded_panoramas.ibl_toolkit.calibration import (
    CalibrationPicks,
    KnownLength,
    Parallels,
    Rectangle,
    calibrate,
)
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector

UPSIDE_DOWN_TILT_DEG = np.degrees(np.arccos(UPSIDE_DOWN[2, 2]))
EXACT = 1e-9  # elements of a rotation, relative lengths
ROOM = {"camera_height": CAMERA_HEIGHT}


def picks(rectangles=(), x=(), y=(), verticals=(), scale=ROOM, camera=WORLD_FROM_PANORAMA):
    """Picks of world points; rectangles are (points, plane) pairs."""
    lines = [Parallels(axis, seen(lines, camera)) for axis, lines in (("X", x), ("Y", y)) if len(lines)]
    boxes = tuple(Rectangle(seen(points, camera), plane) for points, plane in rectangles)
    verticals = seen(verticals, camera) if len(verticals) else ()
    return CalibrationPicks(boxes, tuple(lines), verticals, **scale)


MIXTURES = {
    "floor": {"rectangles": [(RUG, "FLOOR")]},
    "floor, other way round": {"rectangles": [(RUG[[1, 0, 3, 2]], "FLOOR")]},
    "ceiling": {"rectangles": [(SKYLIGHT, "CEILING")]},
    "wall": {"rectangles": [(WINDOW, "WALL")]},
    "wall from an upright side": {"rectangles": [(np.roll(WINDOW, 1, axis=0), "WALL")]},
    "floor and another": {"rectangles": [(RUG, "FLOOR"), (TILE, "FLOOR")]},
    "wall before floor": {"rectangles": [(turned(WINDOW, 1.1), "WALL"), (RUG, "FLOOR")]},
    "ceiling before floor": {"rectangles": [(turned(SKYLIGHT, 0.4), "CEILING"), (RUG, "FLOOR")]},
    "two walls": {"rectangles": [(WINDOW, "WALL"), (turned(WINDOW, 1.9), "WALL")]},
    "parallels": {"x": LINES_X, "y": LINES_Y},
    "one line across": {"x": LINES_X, "y": LINES_Y[:1]},
    "parallels and a vertical": {"x": LINES_X, "verticals": CORNERS[:1]},
    "parallels Y and a vertical": {"y": LINES_Y, "verticals": CORNERS[:1]},
    "verticals and a line": {"x": LINES_X[:1], "verticals": CORNERS},
    "turned wall and a line": {"rectangles": [(turned(WINDOW, 0.5), "WALL")], "x": LINES_X[:1]},
    "all": {
        "rectangles": [(TILE, "FLOOR"), (WINDOW, "WALL"), (SKYLIGHT, "CEILING")],
        "verticals": CORNERS,
    },
}
ANCHORED_ELSEWHERE = {"all": TILE, "floor, other way round": RUG[[1, 0]], "wall": WINDOW}
ANCHORED_ELSEWHERE["wall from an upright side"] = WINDOW[[0, 1]]
ANCHORED_ELSEWHERE["two walls"] = WINDOW


@pytest.mark.parametrize("name", MIXTURES)
def test_any_mixture_gives_back_the_camera(name):
    result = calibrate(picks(**MIXTURES[name]), SIZE)
    expected = WORLD_FROM_PANORAMA
    if name in ANCHORED_ELSEWHERE:
        side = ANCHORED_ELSEWHERE[name][1] - ANCHORED_ELSEWHERE[name][0]
        expected = rotation_from_vector([0.0, 0.0, -np.arctan2(side[1], side[0])]) @ WORLD_FROM_PANORAMA
    got = result.world_from_panorama
    if name.startswith("wall from"):  # a level side may be taken either way along
        got = got * np.sign(got[0] @ expected[0]) if got[0] @ expected[0] > 0 else got * [[-1], [-1], [1]]
    np.testing.assert_allclose(got, expected, atol=EXACT)
    np.testing.assert_allclose(got @ got.T, np.eye(3), atol=EXACT)
    assert result.residual_deg < EXACT
    assert result.camera_height == CAMERA_HEIGHT
    assert result.tilt_deg == pytest.approx(angle_deg(WORLD_FROM_PANORAMA[2], np.array([0.0, 0.0, 1.0])))
    assert 0.0 < result.uncertainty_tilt_deg < 3.0
    assert 0.0 < result.uncertainty_scale_percent < 10.0
    assert result.condition >= 1.0


@pytest.mark.parametrize("start", range(4))
@pytest.mark.parametrize("winding", [1, -1])
def test_x_runs_along_the_first_side_in_either_winding(start, winding):
    corners = np.roll(RUG[::winding], start, axis=0)
    result = calibrate(picks([(corners, "FLOOR")]), SIZE)
    p0, p1 = result.floor_point(seen(corners[:2]))
    assert p1[0] - p0[0] == pytest.approx(np.linalg.norm(corners[1] - corners[0]))
    assert p1[1] - p0[1] == pytest.approx(0.0, abs=EXACT)
    assert result.world_from_panorama[2] == pytest.approx(WORLD_FROM_PANORAMA[2], abs=EXACT)


@pytest.mark.parametrize("first", [1, -1])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_parallels_point_as_the_first_was_clicked(axis, first):
    lines = {"x": LINES_X, "y": LINES_Y}
    lines[axis] = lines[axis].copy()
    lines[axis][0] = lines[axis][0][::first]
    if axis == "y":  # X decides where there is X
        lines["x"], lines["verticals"] = (), CORNERS
    result = calibrate(picks(**lines), SIZE)
    expected = WORLD_FROM_PANORAMA * np.array([[first], [first], [1]])
    np.testing.assert_allclose(result.world_from_panorama, expected, atol=EXACT)


@pytest.mark.parametrize("azimuth", np.linspace(0.0, 2.0 * np.pi, 9))
def test_the_seam_makes_no_difference(azimuth):
    camera = WORLD_FROM_PANORAMA @ rotation_from_vector([0.0, 0.0, azimuth])
    result = calibrate(picks([(RUG, "FLOOR"), (WINDOW, "WALL")], camera=camera), SIZE)
    np.testing.assert_allclose(result.world_from_panorama, camera, atol=EXACT)
    assert result.warnings == ()


def test_the_seam_column_may_be_written_as_0_or_1():
    on_seam = np.array([[-2.0, 0.0, 0.0], [-2.0, 1.0, 0.0], [-3.5, 1.0, 0.0], [-3.5, 0.0, 0.0]])
    uv = seen(on_seam, np.eye(3))
    uv[[0, 3], 0] = [0.0, 1.0]
    result = calibrate(CalibrationPicks((Rectangle(uv),), **ROOM), SIZE)
    np.testing.assert_allclose(result.world_from_panorama[2], [0.0, 0.0, 1.0], atol=EXACT)


def test_a_rectangle_around_the_nadir_works():
    around = np.array([[-1.0, -0.7, 0.0], [0.8, -0.7, 0.0], [0.8, 0.9, 0.0], [-1.0, 0.9, 0.0]])
    result = calibrate(picks([(around, "FLOOR")]), SIZE)
    np.testing.assert_allclose(result.world_from_panorama, WORLD_FROM_PANORAMA, atol=EXACT)


@pytest.mark.parametrize("kind", ["floor", "ceiling", "parallels", "parallels and a vertical", "all"])
def test_an_upside_down_capture_is_righted_and_named(kind):
    result = calibrate(picks(**MIXTURES[kind], camera=UPSIDE_DOWN), SIZE)
    np.testing.assert_allclose(result.world_from_panorama[2], UPSIDE_DOWN[2], atol=EXACT)
    assert result.tilt_deg == pytest.approx(UPSIDE_DOWN_TILT_DEG)
    assert any(f"upside down (tilt {result.tilt_deg:.1f}°)" in warning for warning in result.warnings)


def test_verticals_alone_level_the_panorama_by_the_shortest_turn():
    result = calibrate(picks(verticals=CORNERS), SIZE)
    rotation = result.world_from_panorama
    np.testing.assert_allclose(rotation[2], WORLD_FROM_PANORAMA[2], atol=EXACT)
    # The angle of the whole rotation is no more than the tilt: nothing was turned about the vertical.
    assert np.degrees(np.arccos((np.trace(rotation) - 1.0) / 2.0)) == pytest.approx(result.tilt_deg)
    assert any("azimuth" in warning for warning in result.warnings)
    assert any("own top" in warning for warning in result.warnings)


def test_a_length_on_the_floor_tells_verticals_which_way_is_up():
    length = KnownLength(seen(RUG[:2], UPSIDE_DOWN), 1.6)
    result = calibrate(picks(verticals=CORNERS, scale={"length": length}, camera=UPSIDE_DOWN), SIZE)
    np.testing.assert_allclose(result.world_from_panorama[2], UPSIDE_DOWN[2], atol=EXACT)
    assert result.camera_height == pytest.approx(CAMERA_HEIGHT, rel=EXACT)


@pytest.mark.parametrize("ends", [RUG[:2], RUG[[0, 2]], [[-1.0, 0.5, 0.0], [0.7, 2.0, 0.0]]])
def test_a_known_length_gives_the_camera_height(ends):
    ends = np.array(ends)
    length = KnownLength(seen(ends), float(np.linalg.norm(ends[1] - ends[0])))
    result = calibrate(picks([(RUG, "FLOOR")], scale={"length": length}), SIZE)
    assert result.camera_height == pytest.approx(CAMERA_HEIGHT, rel=EXACT)


def test_floor_points_and_world_directions_have_the_shape_of_their_picks():
    result = calibrate(picks([(RUG, "FLOOR")]), SIZE)
    np.testing.assert_allclose(result.floor_point(seen(LINES_X)), LINES_X[..., :2], atol=EXACT)
    np.testing.assert_allclose(result.floor_point(seen(TILE[0])), TILE[0, :2], atol=EXACT)
    ray = WINDOW - [0.0, 0.0, CAMERA_HEIGHT]
    expected = ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    np.testing.assert_allclose(result.world_direction(seen(WINDOW)), expected, atol=EXACT)


def test_json_has_the_keys_of_the_command_line():
    result = calibrate(picks([(RUG, "FLOOR")]), SIZE)
    printed = json.loads(json.dumps(result.to_json()))
    assert set(printed) == {
        "world_from_panorama",
        "camera_height",
        "tilt_deg",
        "residual_deg",
        "uncertainty",
        "condition",
        "warnings",
    }
    assert set(printed["uncertainty"]) == {"tilt_deg", "scale_percent"}
    assert np.shape(printed["world_from_panorama"]) == (3, 3)


def test_a_click_that_serves_twice_is_one_click():
    """A wall's foot on the side of a floor rectangle, its edge a vertical too: nothing gets singular."""
    wall = RUG[[0, 1, 1, 0]] + [[0, 0, 0], [0, 0, 0], [0, 0, 2], [0, 0, 2]]
    result = calibrate(picks([(RUG, "FLOOR"), (wall, "WALL")], verticals=wall[None, [1, 2]]), SIZE)
    np.testing.assert_allclose(result.world_from_panorama, WORLD_FROM_PANORAMA, atol=EXACT)
    apart = calibrate(picks([(RUG, "FLOOR")]), SIZE)
    assert result.uncertainty_tilt_deg < apart.uncertainty_tilt_deg


def test_picks_are_kept_as_read_only_copies():
    uv = seen(RUG)
    rectangle = Rectangle(uv)
    uv[:] = 0.0
    assert rectangle.points.min() > 0.0
    with pytest.raises(ValueError, match="read-only"):
        rectangle.points[0, 0] = 0.5
