"""How far a picture is from the truth, as an eye would see it: on display values, not on radiance."""

from __future__ import annotations

import cv2
import numpy as np

from .light.light_map import LUMINANCE

VISIBLE = 0.02
"""Display values that differ by more than this count as changed."""
WHITE_DOT = 10.0
"""A pixel so many times as bright as the second brightest of its neighbours is a white dot."""


def display_values(image: np.ndarray) -> np.ndarray:
    """Return linear radiance as sRGB display values in [0, 1], clipped at 1.

    >>> display_values(np.array([0.0, 1.0, 9.0])).round(9).tolist()
    [0.0, 1.0, 1.0]
    """
    linear = np.clip(image, 0, 1)
    return np.where(
        linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )


def psnr(image: np.ndarray, truth: np.ndarray, mask: np.ndarray | None = None) -> float:
    """Return the peak signal-to-noise ratio [dB] of display values, over a mask (H, W) or everywhere.

    +inf where they are equal. Raises ValueError for an empty mask or pictures of different shapes.

    >>> round(psnr(np.zeros((2, 2, 3)), np.ones((2, 2, 3))), 6)
    0.0
    """
    if image.shape != truth.shape:
        raise ValueError(f"pictures have shapes {image.shape} and {truth.shape}; expected the same")
    squares = (display_values(image) - display_values(truth)) ** 2
    if mask is not None:
        if not mask.any():
            raise ValueError("the mask is empty: no pixel to compare")
        squares = squares[mask]
    error = float(squares.mean())
    return float("inf") if error == 0 else -10 * np.log10(error)


def changed_pixels(with_objects: np.ndarray, without: np.ndarray) -> np.ndarray:
    """Return where (H, W) objects change a picture visibly; single noisy pixels are left out."""
    differs = np.abs(display_values(with_objects) - display_values(without)).max(axis=2) > VISIBLE
    return cv2.morphologyEx(differs.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8)).astype(bool)


def unchanged_pixels(with_objects: np.ndarray, without: np.ndarray) -> np.ndarray:
    """Return where (H, W) objects change nothing visible, one pixel away from what they change."""
    changed = changed_pixels(with_objects, without).astype(np.uint8)
    return cv2.dilate(changed, np.ones((3, 3), np.uint8)) == 0


def white_dots(image: np.ndarray) -> np.ndarray:
    """Return where (H, W) a pixel stands more than ten times above its eight neighbours.

    The neighbours' second largest luminance counts, so that a pair of dots does not hide itself.

    >>> picture = np.ones((5, 5, 3)); picture[2, 2] = 50
    >>> int(white_dots(picture).sum())
    1
    """
    luminance = image @ LUMINANCE
    padded = np.pad(luminance, 1, mode="edge")
    height, width = luminance.shape
    around = [padded[i : i + height, j : j + width] for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    second = np.sort(around, axis=0)[-2]
    return luminance > WHITE_DOT * np.maximum(second, 1e-3)


def new_white_dots(image: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Return the white dots (H, W) that the truth has not: nothing half as bright within two pixels there.

    A lamp that a mirror ball shows as one pixel is no defect.
    """
    brightest_near = cv2.dilate((truth @ LUMINANCE).astype(np.float32), np.ones((5, 5), np.uint8))
    return white_dots(image) & (image @ LUMINANCE > 2 * brightest_near)
