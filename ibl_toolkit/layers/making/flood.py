"""How far things reach: from pixels on, over neighbours, as far as an angle allows."""

from __future__ import annotations

import numpy as np

from .grid import PixelGrid

_GAIN = 1e-6  # [rad] by which a nearer start must be better to be taken


def flood(grid: PixelGrid, pixels, starts, reach, allowed, joined=None):
    """Which starts reach which pixels -> what is left of the reach (size,) [rad], the start's number (size,).

    pixels: (n,) where it begins. starts: (n,) the pixels from which the angle is measured. reach: (n,) [rad].
    allowed: (size,) pixels that may be entered. joined: (4, size), whether one may go from a pixel to that in
    its slot. Each pixel gets the start that leaves the most, found by passing starts on from neighbour to
    neighbour; -1, and -inf, where none reaches. Distances are straight angles, not paths.
    """
    left = np.full(grid.size, -np.inf, dtype=np.float32)
    number = np.full(grid.size, -1, dtype=np.int32)
    origin = grid.directions_of(starts)
    inside = allowed[pixels]
    front = _offer(grid, origin, reach, left, number, pixels[inside], np.flatnonzero(inside))
    while len(front):
        slots = grid.beside(front)
        may = allowed[slots]
        if joined is not None:
            may &= joined[:, front]
        numbers = np.broadcast_to(number[front], slots.shape)
        front = _offer(grid, origin, reach, left, number, slots[may], numbers[may])
    return left, number


def _offer(grid, origin, reach, left, number, pixels, numbers):
    """Give starts to pixels that they leave more than those had; the pixels that took one."""
    chord = np.linalg.norm(grid.directions_of(pixels) - origin[numbers], axis=1)
    rest = reach[numbers] - 2 * np.arcsin(np.minimum(chord / 2, 1))
    better = (rest >= 0) & (rest > left[pixels] + _GAIN)
    pixels, numbers, rest = pixels[better], numbers[better], rest[better]
    order = np.argsort(rest, kind="stable")  # of several offers to one pixel the last, the best, stays
    left[pixels[order]] = rest[order]
    number[pixels[order]] = numbers[order]
    return np.unique(pixels)
