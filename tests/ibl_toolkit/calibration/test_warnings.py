"""Doubtful picks are named in the warnings, with figures; clean ones are not."""

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
    WINDOW,
    angle_deg,
    clicked,
    seen,
    turned,
)

from expanded_panoramas.ibl_toolkit.calibration import (
    CalibrationError,
    CalibrationPicks,
    Parallels,
    Rectangle,
    calibrate,
)
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector

PIXELS = 1.0 / np.array(SIZE)


def warnings_of(*rectangles, **others):
    return calibrate(CalibrationPicks(rectangles, camera_height=CAMERA_HEIGHT, **others), SIZE).warnings


def one(warnings, *words):
    """The single warning that contains all the words."""
    found = [warning for warning in warnings if all(word in warning for word in words)]
    assert len(found) == 1, warnings
    return found[0]


def test_good_picks_pass_without_a_word():
    assert warnings_of(Rectangle(seen(RUG))) == ()
    assert warnings_of(Rectangle(seen(RUG)), Rectangle(seen(WINDOW), "WALL"), verticals=seen(CORNERS)) == ()


def test_careful_clicks_pass_without_a_word():
    rng = np.random.default_rng(5)
    for _ in range(20):
        rug, window = (clicked(seen(points), rng, 1.0) for points in (RUG, WINDOW))
        corners = clicked(seen(CORNERS), rng, 1.0)
        assert warnings_of(Rectangle(rug), Rectangle(window, "WALL"), verticals=corners) == ()


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_misplaced_corner_is_named(number):
    bad = seen(TILE)
    bad[number - 1] += np.array([18.0, -11.0]) * PIXELS
    warnings = warnings_of(
        Rectangle(seen(RUG)), Rectangle(bad), Rectangle(seen(WINDOW), "WALL"), verticals=seen(CORNERS)
    )
    text = one(warnings, "the picks disagree", "pixels")
    assert f"floor rectangle 2, point {number}" in text
    assert "rectangle 1" not in text
    assert "vertical" not in text


def test_a_slanted_vertical_is_named():
    bad = seen(np.concatenate([CORNERS, [[[1.0, -2.0, 0.3], [1.0, -2.0, 2.0]]]]))
    bad[2, 1] += np.array([40.0, 0.0]) * PIXELS
    text = one(warnings_of(Rectangle(seen(RUG)), verticals=bad), "the picks disagree")
    assert text.endswith("without vertical 3")


def test_a_lone_rectangle_that_is_none_is_noticed():
    sheared = RUG + RUG[:, [1]] * [0.7, 0.0, 0.0]
    one(warnings_of(Rectangle(seen(sheared))), "the picks disagree", "too few picks to tell")


@pytest.mark.parametrize("azimuth", [0.3, np.pi / 2])
def test_parallels_at_an_angle_to_the_first_rectangle_are_named(azimuth):
    lines = Parallels("X", seen(turned(LINES_X, azimuth)))
    try:
        warnings = warnings_of(Rectangle(seen(RUG)), Rectangle(seen(WINDOW), "WALL"), parallels=(lines,))
        text = one(warnings, "the picks disagree")
    except CalibrationError as refusal:  # far enough apart that no orientation is near both
        text = str(refusal)
    assert "the rest would agree without" in text
    assert "the X parallels" in text


def test_swapped_axes_are_the_same_room_turned_and_no_contradiction():
    swapped = (Parallels("X", seen(LINES_Y)), Parallels("Y", seen(LINES_X)))
    assert warnings_of(parallels=swapped) == ()


def test_a_small_or_steep_rectangle_is_doubted():
    small = 0.3 * (RUG - RUG.mean(axis=0)) + RUG.mean(axis=0)
    one(warnings_of(Rectangle(seen(small))), "tilt is uncertain by ±", "floor rectangle 1 spans")
    below = small - RUG.mean(axis=0)
    one(warnings_of(Rectangle(seen(below))), "tilt is uncertain by ±", "° below the horizon")


def test_low_picks_are_doubted():
    far = RUG * [16.0, 6.0, 0.0] - [8.0, 0.0, 0.0]  # from 8 to 34 m
    one(
        warnings_of(Rectangle(seen(far)), verticals=seen(CORNERS)),
        "from the horizon",
        "distances are uncertain",
    )


def test_a_poor_azimuth_is_doubted():
    tiny = 0.045 * (RUG - RUG[0]) + RUG[0]
    warnings = warnings_of(Rectangle(seen(tiny)), Rectangle(seen(TILE)), verticals=seen(CORNERS))
    one(warnings, "direction of +x is uncertain by ±")


def test_a_ceiling_called_floor_is_not_silent():
    one(warnings_of(Rectangle(seen(SKYLIGHT), "FLOOR")), "upside down", "ceiling were called floor")


def test_a_lone_wall_tells_what_it_could_not_know():
    warnings = warnings_of(Rectangle(seen(WINDOW), "WALL"))
    one(warnings, "own top was taken for up")
    one(warnings, "the picks fit other verticals as well", "instead of 13°")


def test_a_wall_with_verticals_knows_its_sides_even_if_the_camera_lay_on_its_side():
    on_its_side = rotation_from_vector([np.pi / 2, 0.0, 0.0])
    wall = Rectangle(seen(WINDOW, on_its_side), "WALL")
    rug = Rectangle(seen(RUG, on_its_side))
    result = calibrate(CalibrationPicks((wall, rug), camera_height=CAMERA_HEIGHT), SIZE)
    np.testing.assert_allclose(result.world_from_panorama, on_its_side, atol=1e-9)
    assert result.warnings == ()


def test_without_redundancy_it_says_so():
    one(warnings_of(verticals=seen(CORNERS)), "no pick is redundant")


def test_a_small_far_rectangle_is_not_turned_inside_out():
    """Near and far exchanged it looks almost the same; eq. 5.2 alone starts on the wrong side at times."""
    rng = np.random.default_rng(2)
    small = np.array([[6.48, 0.73, 0.0], [5.67, 1.17, 0.0], [5.41, 0.70, 0.0], [6.22, 0.26, 0.0]])
    level = rotation_from_vector([0.05, -0.1, 0.4])
    rivals = 0
    for _ in range(30):
        picks = CalibrationPicks((Rectangle(clicked(seen(small, level), rng)),), camera_height=CAMERA_HEIGHT)
        result = calibrate(picks, SIZE)
        off_deg = angle_deg(result.world_from_panorama[2], level[2])
        assert off_deg < 5.0 * result.uncertainty_tilt_deg
        rivals += any("fit other verticals as well" in warning for warning in result.warnings)
    assert rivals > 15
