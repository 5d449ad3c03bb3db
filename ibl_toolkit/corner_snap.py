"""Corners near a click, to a fraction of a pixel: where an artist meant to click.

Worked out on a small gnomonic patch around the click, in which straight lines of the place are straight, so
that neither the seam nor the poles of the image are special; brightness counts relative to the patch, so that
the exposure does not matter.

Accuracy, rms in rows of the image, of synthetic corners blurred by 0.7 rows: where four fields meet 0.01,
with 5 % noise 0.07; a single bright field's corner 0.13 towards its inside (blur rounds it), with 5 % noise
0.17. With 10 % noise, or blurred by 2 rows, up to 0.8 off, or not found. Edges alone are not taken for a
corner, noise alone is in 4 of 100 clicks (`tests/benchmarks/corner_snap.py`).
"""

from dataclasses import dataclass

import cv2
import numpy as np

from .equirectangular import direction_from_uv, sample, uv_from_direction

RADIUS_PIXELS = 8.0
STEPS_PER_PIXEL = 2
"""Resolution of the patch: rows of the image are taken twice, so that bilinear look-up blurs little."""
WINDOW_PIXELS = 4
"""Half the width of the window whose edges make a corner: it must hold the corner and nothing else."""
BLUR_PIXELS = 0.5
ROUND_PIXELS = 1
"""Half the width of the middle that is left out: blur rounds a corner there."""
BRIGHT = 0.95
"""Share of a window's pixels up to whose luminance it is taken linearly."""
LEAST_CONTRAST = 0.02
"""Least range of brightness of a patch, of 1: less is taken for noise."""
LEAST_COHERENCE = 0.6
LEAST_SPREAD = 0.04
"""Ratio of the structure's smaller to its larger eigenvalue: below it the window holds an edge alone."""
CANDIDATES = 6
REC709 = np.array([0.2126, 0.7152, 0.0722])
_STOP = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 60, 1e-3)


@dataclass(frozen=True)
class Snap:
    """uv (2,) of the corner, or of the click where there is none; coherence: how well all edges of the
    window meet in it, 1 for a perfect corner, 0 where there is none.
    """

    uv: np.ndarray
    coherence: float

    @property
    def is_corner(self):
        """Whether there was one."""
        return self.coherence > 0


def snap_to_corner(image, uv, radius_pixels=RADIUS_PIXELS):
    """The Snap of a click (2,) on an equirectangular image (H, W, C ≥ 3), linear: the nearest clear corner.

    radius_pixels: how far from the click to look, in rows of the image.

    Source: cv2.cornerSubPix, and for the coherence W. Förstner, E. Gülch: A fast operator for detection and
    precise location of distinct points, corners and centres of circular features, ISPRS 1987.
    """
    patch = _Patch(uv, image.shape[0], radius_pixels + 2 * WINDOW_PIXELS)
    luminance = _luminance(sample(image, patch.directions))
    mapped = _mapped(luminance)
    if np.ptp(mapped) < LEAST_CONTRAST:
        return Snap(np.asarray(uv, np.float64), 0.0)
    radius, window, middle = (n * STEPS_PER_PIXEL for n in (radius_pixels, WINDOW_PIXELS, ROUND_PIXELS))
    for start in _candidates(mapped, radius, window):
        # A film's curve moves a blurred edge to its dark side; the corner itself is sought in linear light.
        linear = _clipped(luminance, start[0, 0], window)
        found = cv2.cornerSubPix(linear, start.copy(), (window, window), (middle, middle), _STOP)[0, 0]
        coherence = _coherence(linear, found, window)
        if np.linalg.norm(found - patch.centre) <= radius and coherence >= LEAST_COHERENCE:
            return Snap(patch.uv_at(found), coherence)
    return Snap(np.asarray(uv, np.float64), 0.0)


class _Patch:
    """Directions (n, n, 3) of a square patch of the tangent plane at a click, a few steps per image row."""

    def __init__(self, uv, height, half_pixels):
        self.half = int(np.ceil(half_pixels * STEPS_PER_PIXEL))
        self.centre = np.array([self.half, self.half], np.float64)
        self.ahead = direction_from_uv(uv)
        self.right = np.array([self.ahead[1] + 1e-12, -self.ahead[0], 0.0])
        self.right /= np.linalg.norm(self.right)
        self.down = np.cross(self.ahead, self.right)
        self.step = np.pi / height / STEPS_PER_PIXEL
        offsets = np.arange(-self.half, self.half + 1) * self.step
        x, y = np.meshgrid(offsets, offsets)
        self.directions = self.ahead + x[..., None] * self.right + y[..., None] * self.down

    def uv_at(self, xy):
        """The image point (2,) of a point (2,) [steps] of the patch."""
        x, y = (np.asarray(xy, np.float64) - self.centre) * self.step
        return uv_from_direction(self.ahead + x * self.right + y * self.down)


def _luminance(radiance):
    """Luminance (n, n) of radiance (n, n, C), slightly blurred; what is not finite is as bright as a lamp."""
    luminance = radiance[..., :3] @ REC709
    usable = np.isfinite(luminance) & (luminance >= 0)
    brightest = luminance[usable].max() if usable.any() else 0.0
    luminance = np.where(usable, luminance, brightest).astype(np.float64)
    return cv2.GaussianBlur(luminance, (0, 0), BLUR_PIXELS * STEPS_PER_PIXEL)


def _mapped(luminance):
    """Brightness (n, n) float32 in [0, 1), as of a film whose middle grey is the patch's own."""
    grey = np.median(luminance) or luminance.mean() or 1.0
    return (luminance / (luminance + grey)).astype(np.float32)


def _clipped(luminance, xy, window):
    """Luminance (n, n) float32, 1 at what is bright around a point: lamps count no more than their wall."""
    column, row = xy.astype(int)
    around = luminance[max(row - window, 0) : row + window + 1, max(column - window, 0) : column + window + 1]
    bright = np.quantile(around, BRIGHT) or 1.0
    return (np.minimum(luminance, bright) / bright).astype(np.float32)


def _candidates(mapped, radius, window):
    """Starts (1, 1, 2) float32, the nearest first: where gradients run two ways, and more than around."""
    strength = cv2.cornerMinEigenVal(mapped, window | 1)
    middle = (np.array(mapped.shape) - 1) / 2
    i, j = np.meshgrid(*(np.arange(n) for n in mapped.shape), indexing="ij")
    distance = np.hypot(i - middle[0], j - middle[1])
    within = distance <= radius
    peak = (strength >= cv2.dilate(strength, np.ones((window, window)))) & within
    peak &= strength > 0.05 * strength[within].max()
    places = np.argwhere(peak)
    places = places[np.argsort(distance[peak])][:CANDIDATES]
    return places[:, None, None, ::-1].astype(np.float32)


def _coherence(linear, xy, window):
    """How well the edges around a point meet in it: 1 − 2 Σ (g·d)² / Σ |g|²|d|², g gradients, d offsets.

    0 where they run at random, below where they run around it; 0 as well for an edge alone.
    """
    column, row = np.round(xy).astype(int)
    size = 2 * window + 1
    low_x, low_y = column - window, row - window
    part = linear[max(low_y - 1, 0) : low_y + size + 1, max(low_x - 1, 0) : low_x + size + 1]
    if part.shape != (size + 2, size + 2):
        return 0.0
    gx = (part[1:-1, 2:] - part[1:-1, :-2]).ravel()
    gy = (part[2:, 1:-1] - part[:-2, 1:-1]).ravel()
    dy, dx = (d.ravel() for d in np.mgrid[low_y : low_y + size, low_x : low_x + size])
    dx, dy = dx - xy[0], dy - xy[1]
    small, large = np.linalg.eigvalsh([[gx @ gx, gx @ gy], [gx @ gy, gy @ gy]])
    if small < LEAST_SPREAD * large:
        return 0.0
    return float(1 - 2 * np.sum((gx * dx + gy * dy) ** 2) / np.sum((gx**2 + gy**2) * (dx**2 + dy**2)))
