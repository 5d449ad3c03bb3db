"""Where brightness changes most along short lines across an expected edge, to a part of a pixel."""

from __future__ import annotations

import cv2
import numpy as np

_STEP = 0.25  # px
_OUTERMOST = 0.25  # of the greatest slope, from which on an outer edge counts
_SMOOTH, _MOST_SMOOTH = 0.7, 1.8  # px, of a picture without noise, and of one with much
_QUIET = 0.01  # noise that needs no more smoothing
_NOISE = 1.6  # times the picture's noise, of which the smoothing leaves 0.4
_LEAST = 1e-3  # of white, per pixel
_LAPLACE = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)


class EdgePicture:
    """A picture's linear luminance (H, W) float32, about 1 at white, as edges are measured in it."""

    def __init__(self, luminance):
        noise = noise_of(luminance)
        sigma = float(np.clip(_SMOOTH * np.sqrt(noise / _QUIET), _SMOOTH, _MOST_SMOOTH))
        self.smooth = cv2.GaussianBlur(luminance, (0, 0), sigma)
        # Noise of a slope falls with the square of the smoothing.
        self.least = max(_NOISE * noise * (_SMOOTH / sigma) ** 2, _LEAST)


def noise_of(luminance) -> float:
    """Standard deviation of the noise of a picture (H, W), whatever it shows.

    Source: Immerkær, Fast noise variance estimation (1996), with the median for the mean.

    >>> noise_of(np.random.default_rng(0).normal(0, 0.1, (200, 200)).astype(np.float32)).__round__(2)
    0.1
    """
    second = np.abs(cv2.filter2D(luminance, -1, _LAPLACE))
    return float(np.median(second)) * 1.4826 / 6


def steepest(picture, points, outward, reach, *, rising=False, outermost=False):
    """Points (n, 2) [px] on the edge, its slope (n,) per px, and where one was found (n,) bool.

    picture: an EdgePicture. points (n, 2) [px], outward (n, 2) unit normals; edges are
    looked for up to `reach` px to both sides. rising: only where it is brighter outside. outermost: the
    outermost clear edge, else the clearest one.
    """
    half = max(int(np.ceil(reach / _STEP)), 2) + 2
    offsets = np.arange(-half, half + 1) * _STEP
    places = (points[:, None] + offsets[:, None] * outward[:, None] - 0.5).astype(np.float32)
    places = np.nan_to_num(places, nan=-1e4)
    values = cv2.remap(
        picture.smooth, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    slopes = values[:, 4:] - values[:, :-4]  # over a pixel
    slopes = np.maximum(slopes, 0) if rising else np.abs(slopes)
    rows = np.arange(len(points))
    best = np.argmax(slopes, axis=1)
    if outermost:
        best = _outermost(slopes, best, picture.least)
    inner = np.clip(best, 1, slopes.shape[1] - 2)
    before, at, after = (slopes[rows, inner + k] for k in (-1, 0, 1))
    bend = before - 2 * at + after
    shift = np.where(bend < 0, 0.5 * (before - after) / np.where(bend < 0, bend, -1), 0)
    moved = offsets[2:-2][inner] + _STEP * np.clip(shift, -1, 1)
    height, width = picture.smooth.shape
    inside = (points >= 1).all(axis=1) & (points <= (width - 1, height - 1)).all(axis=1)
    return points + moved[:, None] * outward, at, (at > picture.least) & (inner == best) & inside


def _outermost(slopes, best, least):
    """Index (n,) of the outermost clear local maximum of slopes (n, m); `best` where there is none."""
    peaks = np.zeros(slopes.shape, bool)
    peaks[:, 1:-1] = (slopes[:, 1:-1] >= slopes[:, :-2]) & (slopes[:, 1:-1] > slopes[:, 2:])
    limit = np.maximum(_OUTERMOST * slopes.max(axis=1, keepdims=True), least)
    clear = peaks & (slopes >= limit)
    last = slopes.shape[1] - 1 - np.argmax(clear[:, ::-1], axis=1)
    return np.where(clear.any(axis=1), last, best)
