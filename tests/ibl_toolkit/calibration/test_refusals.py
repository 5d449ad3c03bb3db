"""What can't be calibrated is refused, with the pick and the reason; every refusal has a test here."""

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
    WORLD_FROM_PANORAMA,
    seen,
)

from expanded_panoramas.ibl_toolkit.calibration import (
    CalibrationError,
    CalibrationPicks,
    KnownLength,
    Parallels,
    Rectangle,
    calibrate,
)
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector

PIXEL = 1.0 / SIZE[1]


def refused(match, *rectangles, size=SIZE, **others):
    """calibrate() refuses these picks in one line that matches."""
    scale = {} if "length" in others else {"camera_height": CAMERA_HEIGHT}
    with pytest.raises(CalibrationError, match=match) as caught:
        calibrate(CalibrationPicks(rectangles, **scale, **others), size)
    assert "\n" not in str(caught.value)


def rug_with(index, uv):
    points = seen(RUG)
    points[index] = uv
    return Rectangle(points)


def square(distance, size, plane_height=0.0):
    half = size / 2.0
    return seen(
        np.array([[-half, -half], [half, -half], [half, half], [-half, half]]) @ np.eye(2, 3)
        + [distance, 0, 0]
    )


@pytest.mark.parametrize("bad", [np.nan, np.inf, -0.001, 1.001])
def test_a_pick_outside_the_image(bad):
    refused("floor rectangle 1, point 3: pick .* within 0 to 1", rug_with(2, [0.5, bad]))
    refused(
        "vertical 2, point 1: pick",
        Rectangle(seen(RUG)),
        verticals=[seen(CORNERS[0]), [[bad, 0.5], [0.5, 0.6]]],
    )


def test_a_shape_that_is_none():
    with pytest.raises(
        CalibrationError, match=r"rectangle: needs 4 × 2 numbers, got an array of shape \(3, 2\)"
    ):
        Rectangle(seen(RUG)[:3])
    with pytest.raises(CalibrationError, match="parallels X: needs n × 2 × 2"):
        Parallels("X", seen(LINES_X)[0])
    with pytest.raises(CalibrationError, match="picks must be numbers"):
        Rectangle([["left", "top"]] * 4)
    with pytest.raises(CalibrationError, match="'TABLE' must be one of FLOOR, CEILING, WALL"):
        Rectangle(seen(RUG), "TABLE")
    with pytest.raises(CalibrationError, match="axis 'Z' must be X or Y"):
        Parallels("Z", seen(LINES_X))


@pytest.mark.parametrize("metres", [0.0, -1.0, np.nan, np.inf, "tall", None])
def test_a_length_that_is_none(metres):
    with pytest.raises(CalibrationError, match="length: metres must be a number"):
        KnownLength(seen(RUG[:2]), metres)
    if metres is not None:
        with pytest.raises(CalibrationError, match="camera_height must be a number of metres above 0"):
            CalibrationPicks((Rectangle(seen(RUG)),), camera_height=metres)


def test_no_scale_and_two_scales():
    rug = (Rectangle(seen(RUG)),)
    with pytest.raises(
        CalibrationError, match="exactly one of camera_height and length must be given, got neither"
    ):
        calibrate(CalibrationPicks(rug), SIZE)
    both = CalibrationPicks(rug, camera_height=1.5, length=KnownLength(seen(RUG[:2]), 1.6))
    with pytest.raises(
        CalibrationError, match="exactly one of camera_height and length must be given, got both"
    ):
        calibrate(both, SIZE)


@pytest.mark.parametrize("size", [(0, 512), (np.nan, 512), (1024, -1)])
def test_an_image_without_pixels(size):
    refused("image_size", Rectangle(seen(RUG)), size=size)


def test_coincident_picks():
    near = seen(RUG)[0] + [0.3 * PIXEL, 0.3 * PIXEL]
    refused("floor rectangle 1: points 1 and 2 coincide", rug_with(1, near))
    refused(
        "vertical 1: points 1 and 2 coincide",
        verticals=[[near, np.add(near, [0, 0.1 * PIXEL])], seen(CORNERS[1])],
    )
    refused("length: points 1 and 2 coincide", Rectangle(seen(RUG)), length=KnownLength([near, near], 1.0))
    around_seam = [[0.0001 * PIXEL, 0.6], [1.0 - 0.0001 * PIXEL, 0.6]]
    refused("length: points 1 and 2 coincide", Rectangle(seen(RUG)), length=KnownLength(around_seam, 1.0))


def test_opposite_picks_give_no_line():
    refused("vertical 1: its two points are opposite", verticals=[[[0.2, 0.4], [0.7, 0.6]], seen(CORNERS[1])])


@pytest.mark.parametrize("corner", range(4))
def test_three_collinear_picks(corner):
    between = (
        0.6 * RUG[corner - 3] + 0.4 * RUG[corner - 1]
        if corner % 2
        else 0.5 * (RUG[corner - 3] + RUG[corner - 1])
    )
    refused("lie on one line", rug_with(corner, seen(between)))


@pytest.mark.parametrize("order", [[0, 2, 1, 3], [0, 1, 3, 2], [2, 0, 1, 3]])
def test_a_crossed_quadrilateral(order):
    refused("sides cross", Rectangle(seen(RUG)[order]))
    refused("sides cross", Rectangle(seen(WINDOW)[order], "WALL"))


def test_a_corner_that_points_inwards():
    inside = 0.3 * RUG[0] + 0.5 * RUG[2] + 0.1 * (RUG[1] + RUG[3])
    refused("is not convex", rug_with(0, seen(inside)))


def test_a_wall_seen_edge_on():
    edge_on = np.array([[1.0, 1.0, 0.5], [3.0, 3.0, 0.5], [3.0, 3.0, 2.0], [1.0, 1.0, 2.0]])
    refused("wall rectangle 1: is seen edge-on", Rectangle(seen(edge_on), "WALL"))
    refused("wall rectangle 2: is seen edge-on", Rectangle(seen(RUG)), Rectangle(seen(edge_on), "WALL"))


def test_floor_and_ceiling_on_one_side_of_the_horizon():
    refused("picks on the", Rectangle(seen(RUG)), Rectangle(seen(SKYLIGHT)))
    refused("picks on the", Rectangle(seen(RUG)), Rectangle(seen(TILE), "CEILING"))


def test_a_floor_line_above_the_horizon():
    high = np.add(LINES_X[:1], [0.0, 0.0, 2.0])
    refused(
        "X parallel 1, point 1: lies .*° above the horizon; picks on the floor must lie below",
        Rectangle(seen(RUG)),
        parallels=(Parallels("X", seen(high)),),
    )


def test_a_length_above_or_at_the_horizon():
    rug = Rectangle(seen(RUG))
    refused(
        r"length, point 2: lies .*° above the horizon",
        rug,
        length=KnownLength(seen([[2, 0, 0], [2, 0, 2.0]]), 1.0),
    )
    refused(
        r"length, point 2: lies only 0\.29° below the horizon",
        rug,
        length=KnownLength(seen([[2.0, 0.0, 0.0], [300.0, 0.0, 0.0]]), 298.0),
    )


def test_a_floor_pick_in_the_sky_is_no_floor_point():
    result = calibrate(CalibrationPicks((Rectangle(seen(RUG)),), camera_height=CAMERA_HEIGHT), SIZE)
    with pytest.raises(CalibrationError, match=r"lies -.*° below the horizon"):
        result.floor_point(seen([[2.0, 0.0, 0.0], [2.0, 0.0, 3.0]]))
    with pytest.raises(CalibrationError, match=r"lies 0\.29° below the horizon"):
        result.floor_point(seen([300.0, 0.0, 0.0]))


@pytest.mark.parametrize(
    ("others", "match"),
    [
        ({}, "no picks"),
        ({"verticals": seen(CORNERS[:1])}, "a single vertical leaves the tilt open"),
        ({"parallels": (Parallels("X", seen(LINES_X)),)}, "2 parallels along X, 0 along Y and 0 verticals"),
        ({"parallels": (Parallels("Y", seen(LINES_Y)),)}, "0 parallels along X, 2 along Y and 0 verticals"),
        ({"parallels": (Parallels("X", seen(LINES_X)), Parallels("Y", seen(LINES_X)))}, "leave the tilt"),
    ],
)
def test_too_little_to_know_the_vertical(others, match):
    refused(match, **others)


def test_verticals_in_one_plane_with_the_camera():
    refused(
        "leave the tilt undetermined",
        verticals=seen([[[2.0, 1.0, 0.2], [2.0, 1.0, 2.5]], [[-4.0, -2.0, 0.3], [-4.0, -2.0, 2.0]]]),
    )


def test_parallels_on_one_line():
    one_line = seen([[[1.0, 1.0, 0.0], [2.0, 1.0, 0.0]], [[-1.0, 1.0, 0.0], [0.5, 1.0, 0.0]]])
    refused("tilt undetermined", parallels=(Parallels("X", one_line), Parallels("Y", seen(LINES_Y[:1]))))


@pytest.mark.parametrize(("distance", "size"), [(0.0, 0.15), (2.0, 0.2), (6.0, 0.4)])
def test_rectangles_too_small_near_the_nadir_and_far_away(distance, size):
    refused(
        r"tilt undetermined \(±.*° for half a pixel.*spans .*°, .*° below|lie on one line",
        Rectangle(square(distance, size)),
    )


def test_a_length_too_short_and_far_to_give_a_scale():
    refused(
        "length: leaves the scale undetermined",
        Rectangle(seen(RUG)),
        length=KnownLength(seen([[12.0, 0.0, 0.0], [12.4, 0.0, 0.0]]), 0.4),
    )


def test_contradictory_picks_have_no_solution_or_a_warning():
    """Two floors at right angles: whatever comes out must not come out quietly."""
    other = rotation_from_vector([np.pi / 2, 0, 0]) @ WORLD_FROM_PANORAMA
    picks = CalibrationPicks((Rectangle(seen(RUG)), Rectangle(seen(TILE, other))), camera_height=1.5)
    try:
        result = calibrate(picks, SIZE)
    except CalibrationError:
        return
    assert any("disagree" in warning for warning in result.warnings)
