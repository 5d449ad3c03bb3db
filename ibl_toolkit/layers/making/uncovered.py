"""What a step aside can uncover: which points behind a surface are seen from within a radius at all.

A point P at distance b hides behind the surface that is first on its ray. The line of sight from an eye E,
|E| <= r, to P passes direction after direction; the farthest from the origin that it can be at an angle t
from P's own direction is s(t), with

    asin(r / s(t)) = t + asin(r / b).

To see P the line has to come out from behind the surface, which it can only where the surface ends: at a
discontinuity whose nearer side has depth a <= s(t). So P is hidden from everywhere in the radius unless there
is one at an angle t <= asin(r / a) - asin(r / b), and behind all that lies between the line is farther than
the surface. `uncovered_reach` is the largest asin(r / b) for which that holds. Where a < r, an eye may go
round the surface and see all that is behind: there it begins with more than any asin and any way take.

Source: own; the thesis (6.3.2) stores every surface of a ray.
"""

from __future__ import annotations

import numpy as np

from ... import equirectangular
from ..panorama import EQUIRECTANGULAR
from .discontinuities import cuts, nearness
from .grid import DOWN, RIGHT, PixelGrid

MARGIN_PX = 2.0
"""Domains are so much wider than need be, so that their rims overlap what is in front."""
_CHAMFER = 0.92
"""Ways over a grid are up to 8 % longer than arcs: shortened, so that rather too much is kept."""
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))
_MOST_ROUNDS = 12
_ROUND_IT = np.float32(1.5 * np.pi)
"""A reach [rad] that is enough for everything: π/2 for what is within the radius, and π for the way."""
_NEAREST_SHARE = 0.01


def uncovered_reach(depth: np.ndarray, radius: float, behind: np.ndarray | None = None) -> np.ndarray:
    """For each ray the largest asin(radius / b) [rad] of what can be seen behind a surface; -inf for nothing,
    over π/2 for everything.

    depth: (H, W) [m] of an equirectangular map, +inf at infinity, without NaN. radius: [m]. -> (H, W),
    float32.

    behind: (H, W) [m], the next surface on each ray, NaN where there is none to be seen. Lines of sight pass
    between the two: none leads through a pixel whose own next surface is hidden, nor from one pixel to the
    next where what is behind the one is in front at the other, as the floor at the foot of a box.

    >>> depth = np.full((64, 128), 4.0)
    >>> float(uncovered_reach(depth, 0.5).max())
    -inf
    >>> depth[24:40, 40:80] = 2.0  # a box before the wall
    >>> reach = uncovered_reach(depth, 0.5)
    >>> bool(reach[32, 41] > np.arcsin(0.5 / 4.0)), bool(reach[32, 30] > -1)
    (True, False)
    """
    height, width = depth.shape
    if radius == 0:
        return np.full(depth.shape, -np.inf, np.float32)
    near = nearness(depth)
    most = np.where(radius * near < 1, np.arcsin(np.minimum(radius * near, 1)), _ROUND_IT)
    next_near = np.full_like(near, -np.inf) if behind is None else nearness(behind)
    least = np.arcsin(np.clip(radius * next_near, -1, 1)) - MARGIN_PX * np.pi / height
    away = _barriers(near, next_near, radius)
    reach = np.where(_nearer_sides(near, radius) & (most >= least), most, np.float32(-np.inf))
    if not np.isfinite(reach).any():
        return reach
    costs = {step: _angles(height, width, step) for step in _STEPS}
    for _ in range(_MOST_ROUNDS):
        before = reach.copy()
        _along_rows(reach, (least, most), away[0, 1], costs[0, 1])
        _across_rows(reach, (least, most), away, costs)
        with np.errstate(invalid="ignore"):
            if not (reach - before > 0.1 * np.pi / height).any():
                break
    return reach


def can_be_seen(reach: np.ndarray, depth: np.ndarray, radius: float) -> np.ndarray:
    """Whether points at `depth` [m], behind the surface that `reach` (H, W) [rad] is of, may be seen."""
    with np.errstate(divide="ignore"):
        needed = np.arcsin(np.minimum(radius / depth, 1))
    return reach + MARGIN_PX * np.pi / len(reach) >= needed


def share_of_sphere(pixels: np.ndarray) -> float:
    """What share of the sphere pixels (H, W) bool of an equirectangular map cover.

    >>> share_of_sphere(np.ones((4, 8), bool))
    1.0
    """
    height, width = pixels.shape
    covered = pixels.sum(axis=1) @ equirectangular.row_solid_angles(width, height)
    return min(float(covered / (4 * np.pi)), 1.0)


def usual_radius(depth: np.ndarray) -> float:
    """Half of what is nearest [m], but for a hundredth of the sphere: so far a view can go aside unhindered.

    depth: (H, W) [m], +inf at infinity. Raises: ValueError where all is at infinity.

    >>> usual_radius(np.full((4, 8), 3.0))
    1.5
    """
    height, width = depth.shape
    weights = np.repeat(equirectangular.row_solid_angles(width, height), width)
    order = np.argsort(depth, axis=None)
    nearest = order[np.searchsorted(np.cumsum(weights[order]), _NEAREST_SHARE * 4 * np.pi)]
    if not np.isfinite(depth.flat[nearest]):
        raise ValueError("nothing is nearer than infinity: give the radius")
    return float(depth.flat[nearest] / 2)


def _barriers(near, next_near, radius):
    """For each step (there, back), (H, W) bool: whether no line of sight is carried that way.

    It cannot be where the surface in front jumps away, nor where what is behind the one pixel is in front at
    the other; from corner to corner not where both ways round are barred.
    """
    jumps = _jumps(near, radius)
    closed = [_is_bridged(near, next_near, axis, np.pi / len(near) / radius) for axis in (1, 0)]
    both = []
    for there in (True, False):
        right = (jumps[RIGHT] & _is_farther(near, 1, there)) | closed[0]
        left = (jumps[RIGHT] & _is_farther(near, 1, not there)) | closed[0]
        down = (jumps[DOWN] & _is_farther(near, 0, there)) | closed[1]
        corners = _round_corner(right, down, 1), _round_corner(np.roll(left, 1, axis=1), down, -1)
        both.append((right, down, *corners))
    return {step: (both[0][k], both[1][k]) for k, step in enumerate(_STEPS)}


def _jumps(near, radius):
    height, width = near.shape
    found = cuts(PixelGrid(EQUIRECTANGULAR, width, height), near.reshape(-1), radius)
    return found.reshape(4, height, width)


def _is_farther(near, axis, there):
    """Whether the next pixel is the farther one; `there` false: the nearer one."""
    return (np.roll(near, -1, axis=axis) < near) == there


def _is_bridged(near, next_near, axis, tolerance):
    """Whether what is behind a pixel or behind the next goes on as what is in front at the other of them."""

    def goes_on(ahead):
        one, two = (np.roll(near, -ahead * k, axis=axis) for k in (1, 2))
        gaps = np.abs(next_near - one), np.abs(next_near - (2 * one - two))
        return np.minimum(*gaps) <= tolerance

    return goes_on(1) | np.roll(goes_on(-1), -1, axis=axis)


def _round_corner(across, down, sign):
    first = across | np.roll(down, -sign, axis=1)
    second = down | np.concatenate([across[1:], across[-1:]])
    return first & second


def _nearer_sides(near, radius):
    """Pixels (H, W) beside which the depth jumps away."""
    jumps = _jumps(near, radius)
    right, down = (jumps[slot] & _is_farther(near, axis, True) for slot, axis in ((RIGHT, 1), (DOWN, 0)))
    left, up = (jumps[slot] & _is_farther(near, axis, False) for slot, axis in ((RIGHT, 1), (DOWN, 0)))
    return right | down | np.roll(left, 1, axis=1) | np.roll(up, 1, axis=0)


def _angles(height, width, step):
    """(H,) [rad]: the length of a step that begins in a row."""
    down, right = step
    latitude = (0.5 - (np.arange(height) + 0.5 + down / 2) / height) * np.pi
    across = right * 2 * np.pi / width * np.abs(np.cos(latitude))
    return (_CHAMFER * np.hypot(across, down * np.pi / height)).astype(np.float32)


def _along_rows(reach, limits, barred, cost):
    """Carry the reach to the right and to the left, in place."""
    columns = np.ascontiguousarray(reach.T)
    least, most = (np.ascontiguousarray(limit.T) for limit in limits)
    there, back = (np.ascontiguousarray(side.T) for side in barred)
    width = len(columns)
    for i in range(-1, width - 1):
        _carry(columns[i + 1], columns[i] - cost, there[i], (least[i + 1], most[i + 1]))
    for i in range(width - 1, -1, -1):
        _carry(columns[i], columns[(i + 1) % width] - cost, back[i], (least[i], most[i]))
    reach[:] = columns.T


def _across_rows(reach, limits, barred, costs):
    """Carry the reach down and up, straight and from corner to corner, in place."""
    least, most = limits
    for j in range(len(reach) - 1):
        for step in _STEPS[1:]:
            source, shut = (np.roll(row, step[1]) for row in (reach[j], barred[step][0][j]))
            _carry(reach[j + 1], source - costs[step][j], shut, (least[j + 1], most[j + 1]))
    for j in range(len(reach) - 2, -1, -1):
        for step in _STEPS[1:]:
            source = np.roll(reach[j + 1], -step[1])
            _carry(reach[j], source - costs[step][j], barred[step][1][j], (least[j], most[j]))


def _carry(target, carried, barred, limits):
    """The larger of a row and what is carried to it, at most its limit; below the least nothing arrives."""
    least, most = limits
    carried = np.minimum(carried, most)
    np.maximum(target, carried, out=target, where=(carried >= least) & ~barred)
