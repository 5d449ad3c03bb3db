"""Corners are found where they are, and only where there are some."""

import numpy as np
import pytest
from corner_pictures import HEIGHT, PLACES, WIDTH, error_rows, moved, picture

from expanded_panoramas.ibl_toolkit.corner_snap import snap_to_corner
from expanded_panoramas.ibl_toolkit.equirectangular import pixel_from_uv


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("kind", "most"), [("checker", 0.05), ("corner", 0.3)])
def test_it_finds_the_corner_anywhere(place, kind, most):
    for turn_deg in (0, 25, 70):
        image = picture(PLACES[place], turn_deg, kind)
        for click in ((2.5, 1.0), (-1.5, 3.0), (0.3, -0.2)):
            snap = snap_to_corner(image, moved(PLACES[place], *click))
            assert snap.is_corner
            assert error_rows(snap.uv, PLACES[place]) < most


def test_noise_and_exposure_hardly_matter():
    uv = PLACES["middle"]
    click = moved(uv, 2, -2)
    clean = picture(uv, 30, noise=0.05)
    errors = [error_rows(snap_to_corner(picture(uv, 30, noise=0.05, seed=n), click).uv, uv) for n in range(8)]
    assert max(errors) < 0.25
    bright = snap_to_corner(clean * 1000, click)
    assert np.allclose(bright.uv, snap_to_corner(clean, click).uv, atol=1e-6)


@pytest.mark.parametrize("kind", ["flat", "noise", "edge", "far corner"])
def test_without_a_corner_the_click_stays(kind):
    uv = PLACES["middle"]
    image = np.ones((HEIGHT, WIDTH, 3), np.float32)
    if kind == "noise":
        image = picture(uv, contrast=1.0, noise=0.3)
    elif kind == "edge":
        image = picture(uv, 25, "edge")
    elif kind == "far corner":
        image = picture(moved(uv, 12, 0), 25)
    snap = snap_to_corner(image, uv)
    assert not snap.is_corner
    assert snap.uv == pytest.approx(uv)


def test_bright_and_broken_pixels_do_no_harm():
    uv = PLACES["middle"]
    image = picture(uv, 25)
    column, row = np.round(pixel_from_uv(moved(uv, 10, 10), WIDTH, HEIGHT)).astype(int)
    image[row, column] = np.inf
    image[row, column + 1] = np.nan
    assert error_rows(snap_to_corner(image, moved(uv, 1, 1)).uv, uv) < 0.1
