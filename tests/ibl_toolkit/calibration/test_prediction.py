"""The predicted uncertainty against simulation: half a pixel of click error, thrown many times."""

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
    angle_deg,
    clicked,
    seen,
)

from expanded_panoramas.ibl_toolkit.calibration import (
    CalibrationPicks,
    KnownLength,
    Parallels,
    Rectangle,
    calibrate,
)
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector

TRIALS = 200
# The spread of an rms over 200 trials is 1/√(2·200) = 5 % for one direction of error; this is 4 of those.
RATIO = (0.8, 1.2)
# Shares of a normal error within 1σ and 2σ: in one dimension 0.683 and 0.954; of a vector within its rms
# 0.632 (round) to 0.683 (flat), within twice of it 0.982 to 0.954. Spread over 200 trials: 0.034, 0.015.
WITHIN_1, WITHIN_2 = (0.53, 0.78), (0.91, 1.0)


def floor_scene(clicks):
    rug = clicks(RUG)
    return {"rectangles": (Rectangle(rug),), "length": KnownLength(rug[:2], 1.6)}


def wall_scene(clicks):
    window = Rectangle(clicks(WINDOW), "WALL")
    return {"rectangles": (window,), "length": KnownLength(clicks(RUG[1:3]), 1.2)}


def lines_scene(clicks):
    lines = (Parallels("X", clicks(LINES_X)), Parallels("Y", clicks(LINES_Y)))
    return {"parallels": lines, "length": KnownLength(clicks(RUG[:2]), 1.6)}


def verticals_scene(clicks):
    return {"verticals": clicks(CORNERS), "length": KnownLength(clicks(RUG[:2]), 1.6)}


def everything_scene(clicks):
    rectangles = (
        Rectangle(clicks(TILE)),
        Rectangle(clicks(WINDOW), "WALL"),
        Rectangle(clicks(SKYLIGHT), "CEILING"),
        Rectangle(clicks(RUG)),
    )
    return {
        "rectangles": rectangles,
        "verticals": clicks(CORNERS),
        "length": KnownLength(clicks(RUG[:2]), 1.6),
    }


def simulate(scene, camera, seed):
    """The calibration of exact picks, and of TRIALS noisy ones."""
    rng = np.random.default_rng(seed)
    exact = calibrate(CalibrationPicks(**scene(lambda points: seen(points, camera))), SIZE)
    noisy = [
        calibrate(CalibrationPicks(**scene(lambda points: clicked(seen(points, camera), rng))), SIZE)
        for _ in range(TRIALS)
    ]
    return exact, noisy


# A camera on its side puts the floor on the image's equator and its poles in the room, where half a pixel
# sideways means little: the prediction must know.
ON_ITS_SIDE = rotation_from_vector([1.2, 0.3, 0.0])


@pytest.mark.parametrize(
    ("scene", "camera"),
    [
        (floor_scene, WORLD_FROM_PANORAMA),
        (floor_scene, ON_ITS_SIDE),
        (wall_scene, WORLD_FROM_PANORAMA),
        (lines_scene, WORLD_FROM_PANORAMA),
        (verticals_scene, WORLD_FROM_PANORAMA),
        (everything_scene, ON_ITS_SIDE),
    ],
)
def test_tilt_and_scale_spread_as_predicted(scene, camera):
    exact, noisy = simulate(scene, camera, seed=7)
    tilt = np.array([angle_deg(one.world_from_panorama[2], camera[2]) for one in noisy])
    scale = np.array([100.0 * (one.camera_height / CAMERA_HEIGHT - 1.0) for one in noisy])
    for error, name in ((tilt, "uncertainty_tilt_deg"), (scale, "uncertainty_scale_percent")):
        assert RATIO[0] < np.sqrt(np.mean(error**2)) / getattr(exact, name) < RATIO[1], name
        predicted = np.array([getattr(one, name) for one in noisy])
        assert WITHIN_1[0] < np.mean(np.abs(error) < predicted) < WITHIN_1[1], name
        assert WITHIN_2[0] < np.mean(np.abs(error) < 2.0 * predicted) <= WITHIN_2[1], name


def test_lengths_on_the_floor_spread_as_predicted_for_a_given_height():
    def scene(clicks):
        return {"rectangles": (Rectangle(clicks(RUG)),), "camera_height": CAMERA_HEIGHT}

    rng = np.random.default_rng(11)
    exact = calibrate(CalibrationPicks(**scene(seen)), SIZE)
    sides = []
    for _ in range(TRIALS):
        picks = CalibrationPicks(**scene(lambda points: clicked(seen(points), rng)))
        a, b = calibrate(picks, SIZE).floor_point(picks.rectangles[0].points[:2])
        sides.append(np.linalg.norm(b - a))
    spread = 100.0 * np.std(sides) / 1.6
    assert RATIO[0] < spread / exact.uncertainty_scale_percent < RATIO[1]


def test_residuals_have_the_size_that_the_redundancy_leaves():
    """4 conditions on 3 unknowns correct 8 coordinates: Σv² is χ² with one degree of freedom."""
    rng = np.random.default_rng(3)
    pixel_deg = 180.0 / SIZE[1]
    sizes = []
    for _ in range(TRIALS):
        picks = CalibrationPicks(
            (Rectangle(clicked(seen(TILE, np.eye(3)), rng)),), camera_height=CAMERA_HEIGHT
        )
        sizes.append(calibrate(picks, SIZE).residual_deg)
    # Four clicks share one degree of freedom; sideways half a pixel is less than half a pixel of arc.
    rms = np.sqrt(np.mean(np.square(sizes)))
    assert 0.5 * 0.5 * pixel_deg * np.sqrt(1.0 / 4.0) < rms < 1.1 * 0.5 * pixel_deg * np.sqrt(1.0 / 4.0)


@pytest.mark.parametrize("size", [(1024, 512), (2048, 1024), (16384, 8192)])
def test_uncertainty_goes_with_the_pixel(size):
    result = calibrate(CalibrationPicks((Rectangle(seen(RUG)),), camera_height=CAMERA_HEIGHT), size)
    other = calibrate(CalibrationPicks((Rectangle(seen(RUG)),), camera_height=CAMERA_HEIGHT), SIZE)
    ratio = SIZE[0] / size[0]
    assert result.uncertainty_tilt_deg == pytest.approx(ratio * other.uncertainty_tilt_deg, rel=1e-6)
    assert result.uncertainty_scale_percent == pytest.approx(
        ratio * other.uncertainty_scale_percent, rel=1e-6
    )


def test_more_picks_are_never_worse():
    less = calibrate(CalibrationPicks((Rectangle(seen(RUG)),), camera_height=CAMERA_HEIGHT), SIZE)
    more = calibrate(
        CalibrationPicks((Rectangle(seen(RUG)),), verticals=seen(CORNERS), camera_height=CAMERA_HEIGHT), SIZE
    )
    assert more.uncertainty_tilt_deg < less.uncertainty_tilt_deg
