"""Median cut and variance cut: a light map as rectangles of equal power, or of little spread.

Both begin with the whole map and cut one rectangle in two until there are enough.

- Median cut: next the strongest rectangle, across its longer side, so that half of its power lies on either
  side of the cut.
- Variance cut: next the cut that takes away most variance, wherever it lies. On the sphere the variance of a
  region's power about its own mean direction is Σ P |ω − m|² = Σ P − |Σ P ω|² / Σ P.

Taking the strongest next allows any count; for a power of two it gives what halving all of them does as long
as halves are equal. A side is as long as the part of it that holds light, in radians on the sphere: a row's
length is shortened by its cosine of elevation.

Rectangles end at a seam, none reaches around. This seam is not the image's edge: it lies on the meridian with
the least power, so that a lamp there stays whole and turning a panorama by whole columns turns the samples
with it. At a pole a rectangle is a sector with its tip there; all is taken on the sphere (solid angle,
variance, mean direction), so such a sector needs no exception.

Source: Debevec, "A Median Cut Algorithm for Light Probe Sampling", SIGGRAPH 2005 posters; Viriyothai and
Debevec, "Variance Minimization Light Probe Sampling", SIGGRAPH 2009 posters; thesis section 3.1.1.1.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .. import equirectangular
from .light_map import check_count, check_light_map, check_mask
from .power_tables import PowerTables
from .samples import samples_from_partition

_LEAST_MEAN = 1e-6
"""Below this length of the mean of its directions, a region has no mean direction."""
_NO_POWER = np.finfo(np.float64).tiny


def median_cut(image, count, mask=None):
    """`count` samples of a light map (H, W, 3), in rectangles of about equal luminous power.

    ``mask`` (H, W) restricts it to a part of the map. Every rectangle holds light, so fewer come back once
    no rectangle has two pixels with light. A sample lies at the mean direction of its region's power.

    Raises: ValueError for a bad map, mask or count, and for a mask without light.

    >>> median_cut(np.ones((4, 8, 3), np.float32), 2).irradiance.round(4)  # 2π each
    array([[6.2832, 6.2832, 6.2832],
           [6.2832, 6.2832, 6.2832]])
    """
    return _cut_samples(image, count, mask, _plan_median)


def variance_cut(image, count, mask=None):
    """As `median_cut`, with cuts that leave the least variance of directions within the regions.

    >>> len(variance_cut(np.ones((4, 8, 3), np.float32), 5))
    5
    """
    return _cut_samples(image, count, mask, _plan_least_variance)


@dataclass(order=True)
class _Region:
    """A rectangle, the part of it that holds its light, its power and moment (4,), and its next cut."""

    rank: tuple
    """Least first: what the cut is worth, negative, then a serial number."""
    rectangle: tuple = field(compare=False)
    lit: tuple = field(compare=False)
    sums: np.ndarray = field(compare=False)
    find_cut: Callable = field(compare=False)
    """() -> `_Cut`, or None if no cut would leave light on both sides."""


@dataclass
class _Cut:
    """A cut of the light in the rectangle ``lit`` in front of ``line``, across the axis (0: of rows)."""

    axis: int
    line: int
    lit: tuple
    profile: np.ndarray
    """(n, 4) power and moment of every line of ``lit``."""


def _cut_samples(image, count, mask, plan):
    image, count = check_light_map(image), check_count(count)
    tables = PowerTables(image, check_mask(mask, image))
    regions = _regions(tables, count, plan)
    directions = np.array([_mean_direction(tables, region) for region in regions])
    partition = tables.partition([region.rectangle for region in regions])
    return samples_from_partition(image, equirectangular.uv_from_direction(directions), partition)


def _regions(tables, count, plan):
    """At most `count` regions, by cutting the one whose cut is worth most."""
    whole = (0, tables.height, 0, tables.width)
    waiting, uncuttable, serial = [], [], 0

    def add(rectangle, lit, sums):
        worth, find_cut = plan(tables, lit, sums)
        heapq.heappush(waiting, _Region((-worth, serial), rectangle, lit, sums, find_cut))

    profile, lit = _tight(tables, _tight(tables, whole, 0)[1], 1)
    add(whole, lit, profile.sum(axis=0))
    while waiting and len(waiting) + len(uncuttable) < count:
        region = heapq.heappop(waiting)
        cut = region.find_cut()
        if cut is None:
            uncuttable.append(region)
            continue
        for part in _parts(region.rectangle, cut):
            serial += 1
            add(*part)
    return uncuttable + waiting


def _parts(rectangle, cut):
    """Rectangle, lit part and sums of the two parts that a cut leaves."""
    index = cut.line - cut.lit[2 * cut.axis]
    for first in (True, False):
        profile = cut.profile[:index] if first else cut.profile[index:]
        part = _between(rectangle, cut.axis, None if first else cut.line, cut.line if first else None)
        lit = np.flatnonzero(profile[:, 0]) + (cut.lit[2 * cut.axis] if first else cut.line)
        yield part, _between(cut.lit, cut.axis, lit[0], lit[-1] + 1), profile.sum(axis=0)


def _between(rectangle, axis, start, stop):
    """The rectangle with another start or stop along an axis."""
    changed = list(rectangle)
    changed[2 * axis] = changed[2 * axis] if start is None else int(start)
    changed[2 * axis + 1] = changed[2 * axis + 1] if stop is None else int(stop)
    return tuple(changed)


def _tight(tables, lit, axis):
    """The profile along an axis, and the rectangle, without dark lines at the ends."""
    profile = tables.by_column(lit) if axis else tables.by_row(lit)
    lines = np.flatnonzero(profile[:, 0])
    if not lines.size:  # what little light there was is lost in the rounding of a brighter line's
        return profile[:1], lit
    first, last = lines[0], lines[-1] + 1
    return profile[first:last], _between(lit, axis, lit[2 * axis] + first, lit[2 * axis] + last)


def _plan_median(tables, lit, sums):
    """Worth the power; the cut is found when its turn comes."""
    return float(sums[0]), lambda: _median_line(tables, lit)


def _median_line(tables, lit):
    """The cut across the longer side of the lit part that comes nearest to halving the power."""
    axis = _longer_axis(tables, lit)
    profile, lit = _tight(tables, lit, axis)
    if len(profile) < 2 or _longer_axis(tables, lit) != axis:
        other, lit = _tight(tables, lit, 1 - axis)
        if len(other) > 1:
            axis, profile = 1 - axis, other
    if len(profile) < 2:
        return None
    below = np.cumsum(profile[:, 0])
    imbalance = np.abs(below - 0.5 * below[-1])[:-1]
    return _Cut(axis, lit[2 * axis] + _middle_of_ties(imbalance, imbalance.min()) + 1, lit, profile)


def _longer_axis(tables, rectangle):
    """0 if it is at least as high as it is wide: azimuth is multiplied by the mean cosine of elevation."""
    top, bottom, left, right = rectangle
    height = (bottom - top) * np.pi / tables.height
    width = (right - left) * 2 * np.pi / tables.width * tables.upward[top:bottom, 1].mean()
    return 0 if height >= width else 1


def _plan_least_variance(tables, lit, sums):
    """Worth the variance that the best of all cuts takes away."""
    best, cut = -np.inf, None
    for axis in (0, 1):
        profile, lit = _tight(tables, lit, axis)
        if len(profile) < 2:
            continue
        one = np.cumsum(profile, axis=0)
        concentration = _concentration(one)
        gain = concentration[:-1] + _concentration(one[-1] - one[:-1]) - concentration[-1]
        most = float(gain.max())
        if most > best:
            best = most
            cut = _Cut(axis, lit[2 * axis] + _middle_of_ties(gain, best) + 1, lit, profile)
    return best, lambda: cut


def _concentration(sums):
    """|Σ P ω|² / Σ P of sums (n, 4): what a region's power lacks to its variance."""
    moments = sums[:, 1:]
    return np.einsum("ij,ij->i", moments, moments) / np.maximum(sums[:, 0], _NO_POWER)


def _middle_of_ties(values, value):
    """Middle index of those at ``value``: a cut between two lamps does not keep to one of them."""
    ties = np.flatnonzero(values == value)
    return int(ties[(len(ties) - 1) // 2])


def _mean_direction(tables, region):
    power, *moment = region.sums
    length = np.linalg.norm(moment)
    return np.array(moment) / length if length > _LEAST_MEAN * power else tables.brightest(region.rectangle)
