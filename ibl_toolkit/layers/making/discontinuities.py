"""Where depth jumps, and where a surface has a hollow crease: between a pixel and its neighbour.

What is looked at is the reciprocal of the depth, on a cube's face that of the distance along its axis: along
a line of pixels it is linear on a plane, however flat the view on it. (In an equirectangular map to second
order.) So a floor near the horizon, whose depth grows by metres from row to row, is not cut.

Source: thesis, section 6.3.1, which names the curves and leaves open how they are found.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ... import cube_map
from .grid import DOWN, LEFT, RIGHT, UP, PixelGrid

TOLERANCE_PX = 1.0
"""Smallest parallax [px] that makes a jump, for a view from the rim of the radius."""
CREASE_DEG = 15.0
"""Smallest angle of a hollow crease."""
_STEEPER = 4.0  # a jump is so many times what the surfaces beside it do from pixel to pixel
_AT_RIM = 0.1
_SMOOTHINGS = 4
_PAD = 3
_ROWS = 64  # looked at together
_UPRIGHT = ((UP, (2, 1, 0)), (DOWN, (-3, -2, -1)))


def nearness(depth: np.ndarray) -> np.ndarray:
    """1/depth [1/m], float32: 0 at infinity, NaN where the depth is.

    >>> nearness(np.array([0.5, np.inf, np.nan])).tolist()
    [2.0, 0.0, nan]
    """
    with np.errstate(divide="ignore"):
        return (1 / np.asarray(depth)).astype(np.float32)


def cuts(grid: PixelGrid, near: np.ndarray, radius: float, tolerance_px: float = TOLERANCE_PX) -> np.ndarray:
    """Whether depth jumps between a pixel and its neighbour, (4, size) by slots.

    near: (size,) [1/m] as of `nearness`, NaN outside of the domain: no jump to or from there. From one pixel
    to the next it should change by something between what it changes by just before and just after; what it
    changes by beyond that is a gap. A jump is a gap that a view from `radius` [m] beside the origin sees
    opened by more than `tolerance_px`,

        gap · radius > tolerance · pixel        [rad]

    itself a step as large, and over 4 times as large as those beside it: where a ball turns away it is
    steep, and whole. Two steps in one direction, neither below a quarter of the other, are compared
    together, too, with those around both: a pixel of a mean depth on an edge hides no jump. Where the step
    on one side is not known, as at the rim of a domain, a jump must be a tenth of 1/depth, too.
    """
    scale = radius / (tolerance_px * grid.pixel)

    def rule(values, _places):
        with np.errstate(invalid="ignore"):
            chosen = np.abs(values[3] - values[2]) * scale > 1
        jumps = np.zeros(chosen.shape, dtype=bool)
        jumps[chosen] = _are_jumps([value[chosen] for value in values], scale)
        return jumps

    return _by_slots(grid, near, rule)


def creases(grid: PixelGrid, near: np.ndarray, least_deg: float = CREASE_DEG) -> np.ndarray:
    """Whether a surface has a hollow crease between a pixel and its neighbour, (4, size) by slots.

    In the plane of the two rays the surface before and that after are lines. The angle between them is
    counted where it opens towards the origin, as where a box stands on the floor; the box's own edges stand
    out, and are no creases here.
    """
    least = np.radians(least_deg)

    def hollow(values, places):
        known = ~np.isnan(sum(values[1:5]))
        a, b, c, d = (value[known] for value in values[1:5])
        before, after, step = (place[known] for place in places)
        slope_before, slope_after = (b - a) / step, (d - c) / step
        foot_before, foot_after = b - slope_before * before, c - slope_after * after
        turn = foot_before * slope_after - slope_before * foot_after  # the sine of the angle
        along = foot_before * foot_after + slope_before * slope_after  # its cosine, as much too long
        known[known] = turn * np.cos(least) > along * np.sin(least)
        return known

    return _by_slots(grid, near, hollow)


def smoothed(grid: PixelGrid, near: np.ndarray, jumps: np.ndarray) -> np.ndarray:
    """1/depth (size,) with less noise: means of neighbours between which it doesn't jump, four times over.

    jumps: (4, size), of `cuts`. It is as a bell of 1.3 px.
    """
    joined = ~jumps
    weight = 1 + joined.sum(axis=0)
    for _ in range(_SMOOTHINGS):
        near = (near + np.where(joined, near[grid.neighbours], 0).sum(axis=0)) / weight
    return near.astype(np.float32)


def _by_slots(grid, near, rule):
    """What `rule` says of pairs along rows and along columns, by slots."""
    result = np.zeros((4, *grid.sheet_shape), dtype=bool)
    sheets = near.reshape(grid.sheet_shape)
    if grid.is_cube:
        sheets = sheets / _axial(grid)
    for axis, (before, after) in ((2, (LEFT, RIGHT)), (1, (UP, DOWN))):
        found = _between(grid, near, sheets, axis, rule)
        result[before] = np.delete(found, -1, axis=axis)
        result[after] = np.delete(found, 0, axis=axis)
    result = result.reshape(4, grid.size)
    if grid.is_cube:  # a pair over an edge was seen from both faces, not quite alike
        for slot in range(4):
            pixel, back = grid.rim_pixels(slot), grid.slots_back(slot)
            other = grid.neighbours[slot, pixel]
            result[slot, pixel] |= result[back, other]
            result[back, other] |= result[slot, pixel]
    return result


def _between(grid, near, sheets, axis, rule):
    """What `rule` says of the n + 1 pairs along an axis, (sheets, rows, columns + 1) or (…, rows + 1, …).

    It is given six values, of which the pair's are in the middle, and the pairs' places; in blocks of rows,
    which takes half the time of all at once.
    """
    padded = _padded(grid, near, sheets, axis)
    count = sheets.shape[axis]

    def shifted(k):
        return padded[(slice(None),) * axis + (slice(_PAD - 1 + k, _PAD + count + k),)]

    values = [shifted(k) for k in (-2, -1, 0, 1, 2, 3)]
    places = [np.broadcast_to(place, values[0].shape) for place in _places(grid, axis)]
    found = np.empty(values[0].shape, dtype=bool)
    for start in range(0, found.shape[1], _ROWS):
        rows = np.s_[:, start : start + _ROWS]
        found[rows] = rule([value[rows] for value in values], [place[rows] for place in places])
    return found


def _are_jumps(values, scale):
    """Whether 1/depth jumps between the middle two of six values, each (n,)."""
    two_before, before, step, after, two_after = (b - a for a, b in pairwise(values))
    least = _AT_RIM * np.maximum(*values[2:4])
    jumps = _stands_out(step, before, after, scale, least)
    for other, own, outer in ((before, after, two_before), (after, before, two_after)):
        with np.errstate(invalid="ignore"):
            alike = (step * other > 0) & (np.abs(step) > np.abs(other) / _STEEPER)
        alike &= _stands_out((step + other) / 2, own, outer, scale, least)
        jumps |= alike & _stands_out(step, own, own, scale, least)
    return jumps


def _stands_out(step, before, after, scale, least):
    """Whether a step is outside of those beside it by a visible gap, and much longer. NaN: not known."""
    low, high = np.fmin(before, after), np.fmax(before, after)
    low, high = np.nan_to_num(low), np.nan_to_num(high)
    along = np.maximum(np.where(step > 0, high, -low), 0)
    with np.errstate(invalid="ignore"):
        gap = np.maximum(step - high, low - step)
        known = ~np.isnan(before + after) | (np.abs(step) > least)
        return (gap * scale > 1) & (np.abs(step) > _STEEPER * along) & known


def _padded(grid, near, sheets, axis):
    """Sheets with three more pixels at both ends of an axis: what is beyond their rims."""
    pad = [(0, 0)] * 3
    pad[axis] = (_PAD, _PAD)
    if not grid.is_cube:
        if axis == 2:
            return np.pad(sheets, pad, mode="wrap")
        padded = np.pad(sheets, pad, mode="symmetric")
        for rows in (slice(None, _PAD), slice(-_PAD, None)):
            padded[:, rows] = np.roll(padded[:, rows], grid.width // 2, axis=2)
        return padded
    padded = np.moveaxis(np.pad(sheets, pad), axis, 1)  # (faces, along the axis, along the edge)
    for slot, places in ((LEFT, (2, 1, 0)), (RIGHT, (-3, -2, -1))) if axis == 2 else _UPRIGHT:
        for place, values in zip(places, _beyond_cube_edge(grid, near, slot), strict=True):
            padded[:, place] = values
    return np.moveaxis(padded, 1, axis)


def _beyond_cube_edge(grid, near, slot):
    """1/(distance along a face's axis) (faces, n) of the three rows of pixels beyond its edge in `slot`.

    Seen from this face the neighbouring face's pixels are a little farther apart, so of each the nearest
    counts, continued along the edge by the smaller of its two slopes: nothing is mixed where depth jumps.
    """
    n = grid.sheet_shape[1]
    centres = (2 * np.arange(n) + 1) / n - 1
    axes = cube_map.point_on_face(np.arange(6), np.zeros(6), np.zeros(6))
    pixel = grid.neighbours[slot, grid.rim_pixels(slot)]
    away = grid.slots_back(slot) ^ 1  # slots come in pairs of opposite ones
    for row in range(_PAD):
        along = np.einsum("fnk,fk->fn", grid.directions[pixel].reshape(6, n, 3), axes)
        value = near[pixel].reshape(6, n)  # unknown where a face is so small that a row is behind
        value = np.divide(value, along, out=np.full_like(value, np.nan), where=along > 1e-3)
        spread = 1 / (1 - min(2 * row + 1, n - 0.5) / n)
        nearest = np.clip(np.rint((centres / spread + 1) * n / 2 - 0.5).astype(np.int64), 0, n - 1)
        step = np.diff(value, axis=1, prepend=value[:, :1], append=value[:, -1:])
        slope = np.where(np.abs(step[:, 1:]) < np.abs(step[:, :-1]), step[:, 1:], step[:, :-1])
        off = (centres / spread - centres[nearest]) * n / 2
        yield value[:, nearest] + slope[:, nearest] * off
        pixel = grid.neighbours[away, pixel]


def _places(grid, axis):
    """Where pairs stand on their lines (before, after), and the step from one to the next.

    On a cube's face in half its width from its middle; elsewhere 0, and the angle.
    """
    count = grid.sheet_shape[axis]
    if grid.is_cube:
        ends = (2 * np.arange(count + 2) - 1) / count - 1
        shape = [1, 1, 1]
        shape[axis] = count + 1
        return ends[:-1].reshape(shape), ends[1:].reshape(shape), 2 / count
    if axis == 1:
        return 0, 0, grid.pixel
    elevation = (0.5 - (np.arange(grid.height) + 0.5) / grid.height) * np.pi
    return 0, 0, (grid.pixel * np.cos(elevation))[None, :, None]


def _axial(grid):
    """Cosine between rays and their face's axis, (rows, columns): 1/depth over it is linear on a plane."""
    n = grid.sheet_shape[1]
    s = (2 * np.arange(n) + 1) / n - 1
    return (1 / np.sqrt(1 + s * s + s[:, None] ** 2)).astype(np.float32)
