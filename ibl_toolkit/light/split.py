"""The split of a light map into a small bright part A and a wide dim part B.

A holds the brightest pixels, as many as carry the share p of the map's light; p is given, or found where two
trapezoids under the curve of falling luminance are smallest: the curve's knee.

Source: thesis, sections 3.2.1-3.2.2, eq. 3.6-3.12, with the exact solid angle of a pixel for its sine.
"""

from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from ..images.checking import row_blocks
from .light_map import check_light_map, luminance

_BINS = 1 << 18
"""Bins of the histogram of luminance, equal in the bits of its floats. One or a few of them are sorted, so
that the result is exact and 33 million pixels take less than a second."""


@dataclass(frozen=True)
class Split:
    """Bright part A of a light map; what is outside it is B."""

    mask: np.ndarray
    """(H, W) bool: A."""
    share: float
    """p: what A holds of the map's light (luminance over solid angle), in [0, 1]."""
    level: float
    """Luminance of A's dimmest pixel; pixels as bright that come later, row by row, are in B."""
    solid_angle: float
    """Of A [sr]."""

    @property
    def area(self) -> float:
        """Part of the whole sphere that A covers, in [0, 1]."""
        return self.solid_angle / (4 * np.pi)


def split(image: np.ndarray, share: float | None = None) -> Split:
    """Split a light map (H, W, 3) of radiance.

    share: p in (0, 1): A ends with the pixel, from the brightest down, at which its light first reaches p of
    the map's (eq. 3.6, and 3.9 for its area); None: by the two-trapezoid rule (eq. 3.10-3.12), taking the
    smallest of equally good areas. Equally bright pixels count row by row, from the top left.

    On a map of one luminance every area is equally good: nothing stands out, and the rule leaves A empty
    (share 0), where eq. 3.11 would take the first pixel. A given share is taken there too, from the top.

    Raises: ValueError for what `check_light_map` refuses, or a share outside (0, 1).

    Source: thesis, sections 3.2.1.1 and 3.2.2.1.

    >>> image = np.ones((8, 16, 3), np.float32)
    >>> image[3, 4:6] = 1000
    >>> bright = split(image, 0.9)
    >>> bright.mask[3, 4:6].all(), int(bright.mask.sum()), round(bright.share, 3)
    (True, 2, 0.961)
    >>> split(np.ones((8, 16, 3), np.float32)).share
    0.0
    """
    image = check_light_map(image)
    if share is not None and not 0 < share < 1:
        raise ValueError(f"share is {share}: must be above 0 and below 1, or None for the two-trapezoid rule")
    brightness = luminance(image)
    solid_angles = equirectangular.row_solid_angles(*brightness.shape[::-1])
    ranked = _Ranked(brightness, solid_angles)
    if share is not None:
        last = _reaching(ranked, share)
    elif ranked.brightest == ranked.dimmest:
        return Split(np.zeros(brightness.shape, bool), 0.0, ranked.brightest, 0.0)
    else:
        last = _knee(ranked)
    return _from_last_pixel(ranked, last)


def two_trapezoid_curves(image: np.ndarray):
    """x [sr], f(x), g(x), ζ(x) at every x_i of a small map: four arrays (H·W,), as drawn in Fig. 3-3.

    x_i is the solid angle of the i + 1 brightest pixels, f their falling luminance, g its integral, and
    ζ(x) = (f(0) + f(x))/2 · x + (f(x) + f(Ψ))/2 · (Ψ − x), with Ψ = 4π, the area of two trapezoids above x.

    Sorts all pixels: `split` does the same without.

    Source: thesis, section 3.2.2.1, eq. 3.10.

    >>> image = np.linspace(1, 2, 32, dtype=np.float32).reshape(4, 8, 1) ** 8 * np.ones(3, np.float32)
    >>> x, f, g, zeta = two_trapezoid_curves(image)
    >>> bool(np.isclose(split(image).solid_angle, x[zeta.argmin()]))
    True
    """
    image = check_light_map(image)
    brightness = luminance(image)
    solid_angles = equirectangular.row_solid_angles(*brightness.shape[::-1])
    order = np.argsort(-brightness.ravel(), kind="stable")
    areas = np.repeat(solid_angles, brightness.shape[1])[order]
    f = brightness.ravel()[order].astype(np.float64)
    x = np.cumsum(areas)
    zeta = (f[0] + f) / 2 * x + (f + f[-1]) / 2 * (x[-1] - x)
    return x, f, np.cumsum(f * areas), zeta


class _Ranked:
    """Pixels in bins of luminance, the brightest first. solid_angles (H,) of a pixel of each row [sr]."""

    def __init__(self, brightness, solid_angles):
        self.brightness, self.solid_angles = brightness, solid_angles
        brightness += 0  # −0 becomes 0: floats of one sign are in the order of their bits
        self._bits = brightness.view(np.int32)
        self._top = int(self._bits.max())
        spread = self._top - int(self._bits.min())
        self._shift = max(spread.bit_length() - (_BINS.bit_length() - 1), 0)
        self.count = (spread >> self._shift) + 1
        self.brightest, self.dimmest = (float(extreme(brightness)) for extreme in (np.max, np.min))

    def keys(self, rows):
        """The bin of every pixel of some rows: (h, W) int32, 0 is the brightest."""
        return (self._top - self._bits[rows]) >> self._shift

    def sums(self, with_luminance):
        """Per bin: Σ Ω [sr], or Σ luminance·Ω; (count,)."""
        total = np.zeros(self.count)
        for rows in row_blocks(len(self.brightness)):
            block = self.brightness[rows]
            weights = np.broadcast_to(self.solid_angles[rows, None], block.shape)
            if with_luminance:
                weights = weights * block
            total += np.bincount(self.keys(rows).ravel(), weights.ravel(), self.count)
        return total

    def luminance_limits(self):
        """Least and greatest luminance that a pixel of each bin may have: two arrays (count,)."""
        first = np.arange(self.count, dtype=np.int64) << self._shift
        high = np.maximum(self._top - first, 0)
        low = np.maximum(self._top - first - (1 << self._shift) + 1, 0)
        return tuple(bits.astype(np.int32).view(np.float32).astype(np.float64) for bits in (low, high))

    def pixels(self, chosen):
        """Flat indices of the pixels whose bin is chosen, (count,) bool: the brightest first, then by row."""
        width = self.brightness.shape[1]
        found = [
            np.flatnonzero(chosen[self.keys(rows)]) + rows.start * width
            for rows in row_blocks(len(self.brightness))
        ]
        indices = np.concatenate(found)
        return indices[np.argsort(-self.brightness.ravel()[indices], kind="stable")]

    def bins_of(self, indices):
        """The bins of pixels (n,) by flat index."""
        return (self._top - self._bits.ravel()[indices]) >> self._shift

    def areas_of(self, indices):
        """Solid angles [sr] of pixels (n,) by flat index."""
        return self.solid_angles[indices // self.brightness.shape[1]]


def _reaching(ranked, share):
    """Flat index of the pixel at which the light of the brighter ones and itself first reaches `share`."""
    power = np.cumsum(ranked.sums(with_luminance=True))
    target = share * power[-1]
    within = int(np.searchsorted(power, target))
    before = power[within - 1] if within else 0.0
    indices = ranked.pixels(np.arange(ranked.count) == within)
    rising = before + np.cumsum(ranked.areas_of(indices) * ranked.brightness.ravel()[indices])
    return indices[min(int(np.searchsorted(rising, target)), len(indices) - 1)]


def _knee(ranked):
    """Flat index of the last pixel of the smallest A for which ζ is least.

    2 ζ(x) / Ψ = f(x) + f(Ψ) + (f(0) − f(Ψ)) x / Ψ, so f(x) + slope · x is made least. Bins whose smallest
    possible value is above another's largest are out.
    """
    areas = ranked.sums(with_luminance=False)
    end = np.cumsum(areas)
    start = end - areas
    slope = (ranked.brightest - ranked.dimmest) / end[-1]
    low, high = ranked.luminance_limits()
    reachable = float(np.min((high + slope * end)[areas > 0]))
    indices = ranked.pixels((areas > 0) & (low + slope * start <= reachable))
    bins, within = ranked.bins_of(indices), np.cumsum(ranked.areas_of(indices))
    _, first, counts = np.unique(bins, return_index=True, return_counts=True)
    before = np.concatenate([[0.0], within])[first]
    x = within + np.repeat(start[bins[first]] - before, counts)
    return indices[np.argmin(ranked.brightness.ravel()[indices] + slope * x)]


def _from_last_pixel(ranked, last):
    brightness, solid_angles = ranked.brightness, ranked.solid_angles
    level = brightness.ravel()[last]
    mask = brightness >= level
    as_bright = np.flatnonzero(brightness == level)
    mask.ravel()[as_bright[as_bright > last]] = False
    power = bright = 0.0
    for rows in row_blocks(len(mask)):
        power += brightness[rows].sum(axis=1, dtype=np.float64) @ solid_angles[rows]
        bright += (brightness[rows] * mask[rows]).sum(axis=1, dtype=np.float64) @ solid_angles[rows]
    area = np.count_nonzero(mask, axis=1) @ solid_angles
    return Split(mask, float(bright / power), float(level), float(area))
