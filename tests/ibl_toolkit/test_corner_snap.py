"""Corners of a synthetic picture whose place is known, anywhere on the sphere."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.corner_snap import snap_to_corner
from expanded_panoramas.ibl_toolkit.equirectangular import (
    direction_from_uv,
    pixel_from_uv,
    uv_from_direction,
    uv_from_pixel,
)

WIDTH, HEIGHT = 512, 256
ROW = np.pi / HEIGHT  # [rad]
REACH = 24  # rows around the corner that are drawn
FINE = 4  # samples per pixel and direction
PLACES = {"middle": (0.3, 0.6), "seam": (0.9995, 0.55), "low": (0.71, 0.85), "near the pole": (0.2, 0.955)}


def tangents(ahead):
    """Two directions (3,) across another."""
    right = np.cross(ahead, (0, 0, 1.0))
    right /= np.linalg.norm(right)
    return right, np.cross(right, ahead)


def picture(uv, turn_deg=0.0, kind="checker", contrast=3.0, blur_rows=0.7, noise=0.0, seed=0):
    """(H, W, 3): where two edges cross at a place, blurred, with noise relative to the radiance."""
    ahead, image = direction_from_uv(uv), np.ones((HEIGHT, WIDTH))
    right, up = tangents(ahead)
    turn = np.radians(turn_deg)
    x_axis, y_axis = np.cos(turn) * right + np.sin(turn) * up, np.cos(turn) * up - np.sin(turn) * right
    row = int(pixel_from_uv(uv, WIDTH, HEIGHT)[1])
    rows = np.arange(max(row - REACH, 0), min(row + REACH, HEIGHT))
    offsets = (np.arange(FINE) + 0.5) / FINE - 0.5
    i, j = np.arange(WIDTH)[:, None] + offsets, rows[:, None] + offsets
    ij = np.stack(np.meshgrid(i.ravel(), j.ravel()), axis=-1)
    directions = direction_from_uv(uv_from_pixel(ij, WIDTH, HEIGHT))
    in_front = directions @ ahead > 0.1
    plane = [np.where(in_front, directions @ axis / np.where(in_front, directions @ ahead, 1), 9.0)
             for axis in (x_axis, y_axis)]  # fmt: skip
    x, y = (np.tanh(offset / ROW / blur_rows) for offset in plane)
    share = (
        (1 + x * y) / 2 if kind == "checker" else (1 + x) * (1 + y) / 4 if kind == "corner" else (1 + x) / 2
    )
    fine = 1 + (contrast - 1) * share
    image[rows] = fine.reshape(len(rows), FINE, WIDTH, FINE).mean(axis=(1, 3))
    image *= 1 + noise * np.random.default_rng(seed).normal(size=image.shape)
    return np.repeat(image[..., None], 3, axis=2).astype(np.float32)


def moved(uv, rows_right, rows_up):
    """An image point beside another [rows]."""
    ahead = direction_from_uv(uv)
    right, up = tangents(ahead)
    return uv_from_direction(ahead + ROW * (rows_right * right + rows_up * up))


def error_rows(found, uv):
    return np.linalg.norm(direction_from_uv(found) - direction_from_uv(uv)) / ROW


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
