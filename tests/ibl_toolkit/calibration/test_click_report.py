"""What is said about each click, against simulation and against what the conditions demand."""

import numpy as np
import pytest
from known_room import (
    CAMERA_HEIGHT,
    CORNERS,
    RUG,
    SIZE,
    WINDOW,
    angle_deg,
    clicked,
    seen,
)

from expanded_panoramas.ibl_toolkit.calibration import (
    CalibrationPicks,
    KnownLength,
    Rectangle,
    calibrate,
    calibrate_with_report,
)
from expanded_panoramas.ibl_toolkit.equirectangular import direction_from_uv

TRIALS = 150
RATIO = (0.8, 1.2)  # the spread of a standard deviation over 150 trials is 6 %; this is 3.5 of those


def picks(clicks):
    return CalibrationPicks(
        rectangles=(Rectangle(clicks(RUG)), Rectangle(clicks(WINDOW), "WALL")),
        verticals=clicks(CORNERS),
        camera_height=CAMERA_HEIGHT,
    )


def test_exact_clicks_stay_where_they_are():
    exact = picks(seen)
    calibration, report = calibrate_with_report(exact, SIZE)
    assert np.array_equal(calibration.world_from_panorama, calibrate(exact, SIZE).world_from_panorama)
    assert report.residual_pixels.max() < 1e-6
    assert np.allclose(report.corrected, direction_from_uv(report.uv), atol=1e-9)


def test_corrected_clicks_are_a_rectangle():
    rug = clicked(seen(RUG), np.random.default_rng(5), pixels=2.0)
    noisy = CalibrationPicks(rectangles=(Rectangle(rug),), verticals=seen(CORNERS), camera_height=1.5)
    calibration, report = calibrate_with_report(noisy, SIZE)
    world = report.corrected[report.indices(rug)] @ calibration.world_from_panorama.T
    floor = world[:, :2] / -world[:, 2:]
    sides = np.roll(floor, -1, axis=0) - floor
    assert abs(sides[0] @ sides[1]) < 1e-3 * np.linalg.norm(sides[0]) * np.linalg.norm(sides[1])
    assert np.linalg.norm(sides[0]) == pytest.approx(np.linalg.norm(sides[2]), rel=1e-3)
    moved = report.residual_pixels[report.indices(rug)]
    by_angle = [
        angle_deg(*pair) / (180 / SIZE[1])
        for pair in zip(report.corrected[report.indices(rug)], direction_from_uv(rug), strict=True)
    ]
    assert moved.max() > 0.3
    assert moved == pytest.approx(by_angle, rel=0.5)  # a column is narrower than a row is high, but near it


def test_covariance_of_corrected_clicks_is_that_of_simulation():
    rng = np.random.default_rng(1)
    _, exact = calibrate_with_report(picks(seen), SIZE)
    samples = []
    for _ in range(TRIALS):
        _, report = calibrate_with_report(picks(lambda points: clicked(seen(points), rng)), SIZE)
        offsets = report.corrected - exact.corrected
        samples.append(np.einsum("nij,ni->nj", exact.tangents, offsets) / (exact.tangents**2).sum(axis=1))
    simulated = np.einsum("tni,tnj->nij", samples, samples) / TRIALS
    for predicted, found in zip(exact.covariance, simulated, strict=True):
        for axis in np.linalg.eigh(predicted)[1].T:
            ratio = np.sqrt((axis @ found @ axis) / (axis @ predicted @ axis))
            assert RATIO[0] < ratio < RATIO[1]
    assert (np.linalg.eigvalsh(exact.covariance)[:, 0] < 0.7).any()  # other clicks do help


def test_clicks_that_nothing_checks_keep_their_error():
    ends = seen(np.add(RUG[1:3], (0.3, 0.2, 0)))
    with_length = CalibrationPicks(rectangles=(Rectangle(seen(RUG)),), length=KnownLength(ends, 1.2))
    _, report = calibrate_with_report(with_length, SIZE)
    first, second = report.indices(ends)
    assert np.allclose(report.covariance[[first, second]], np.eye(2))
    assert report.indices([(0.123, 0.456)]).tolist() == [-1]
    axes = report.half_axes()[first]
    assert np.linalg.norm(axes, axis=0).max() == pytest.approx(np.pi / SIZE[1] / 2)
    assert np.abs(axes.T @ report.corrected[first]).max() < 1e-9
