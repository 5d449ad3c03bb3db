"""Synthetic pictures of corners whose place is known, anywhere on the sphere."""

import numpy as np

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
    """How far an image point is from another [rows]."""
    return np.linalg.norm(direction_from_uv(found) - direction_from_uv(uv)) / ROW
