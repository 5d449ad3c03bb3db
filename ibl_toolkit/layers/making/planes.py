"""Planes of surfaces: on a plane 1/depth is linear in the direction, so a vector tells all of it.

    n·(d ω) = c   ⇔   1/d = g·ω,   g = n/c  [1/m]

Source: eq. 6.11 put into the equation of a plane.
"""

from __future__ import annotations

import numpy as np

from .grid import PixelGrid

_FLAT_PX = 0.25  # rms parallax [px] by which a region may be off its plane
_SIDE = 9  # samples along a side of the window at a start
_LEAST_PX, _LARGEST = 4.0, 0.1  # half the window's side: at least [px], at most [rad]
_RIDGE = 0.05  # in px: what is no steadier than this across the window counts as a constant distance
_BLOCK = 1 << 14


def region_planes(grid: PixelGrid, near, count: int, labels, radius: float):
    """Plane vectors (count, 3) [1/m] of regions, by least squares of 1/depth, and whether they are flat.

    near, labels: (size,). Flat is a region whose 1/depth is off by no more than a quarter of a pixel of
    parallax at `radius`, as root of the mean square. A region at infinity is flat, with the plane 0.
    """
    w = grid.directions
    squares = np.empty((count, 3, 3))
    rights = np.empty((count, 3))
    for i in range(3):
        rights[:, i] = np.bincount(labels, w[:, i] * near, count)
        for j in range(i + 1):
            squares[:, i, j] = squares[:, j, i] = np.bincount(labels, w[:, i] * w[:, j], count)
    pixels = np.bincount(labels, minlength=count)
    ridge = 1e-9 * np.maximum(pixels, 1)[:, None, None] * np.eye(3)
    planes = np.linalg.solve(squares + ridge, rights[..., None])[..., 0]
    off = np.zeros(grid.size)
    for i in range(3):
        off += planes[:, i][labels] * w[:, i]
    off = (off - near) ** 2
    spread = np.sqrt(np.bincount(labels, off, count) / np.maximum(pixels, 1))
    return planes, spread * radius < _FLAT_PX * grid.pixel


def local_planes(grid: PixelGrid, near, labels, starts, reach):
    """Plane vectors (n, 3) [1/m] at pixels (n,), from what is of the same region round them.

    reach: (n,) [rad] how far the plane will be continued: half the side of the window. Along directions
    that the window tells nothing of, the plane is that of a constant distance.
    """
    planes = np.empty((len(starts), 3))
    for first in range(0, len(starts), _BLOCK):
        block = slice(first, first + _BLOCK)
        planes[block] = _block_planes(grid, near, labels, starts[block], reach[block])
    return planes


def _block_planes(grid, near, labels, starts, reach):
    half = np.clip(reach, _LEAST_PX * grid.pixel, _LARGEST)
    middle = grid.directions[starts].astype(np.float64)
    across, up = _tangents(middle)
    grid_places = np.linspace(-1, 1, _SIDE)
    s, t = (a.reshape(-1) for a in np.meshgrid(grid_places, grid_places))
    offset = s[None, :, None] * across[:, None] + t[None, :, None] * up[:, None]
    pixels = grid.at(middle[:, None] + half[:, None, None] * offset)
    weight = (labels[pixels] == labels[starts][:, None]).astype(np.float64)
    here = near[starts].astype(np.float64)
    w = grid.directions[pixels].astype(np.float64)
    along = np.stack([np.einsum("nkc,nc->nk", w, axis) for axis in (middle, across, up)], axis=2)
    change = np.where(weight > 0, near[pixels] - here[:, None] * along[..., 0], 0)
    # The plane goes through the start itself: two slopes are left.
    slopes = along[..., 1:]
    squares = np.einsum("nk,nki,nkj->nij", weight, slopes, slopes)
    rights = np.einsum("nk,nki,nk->ni", weight, slopes, change)
    ridge = (_RIDGE * grid.pixel) ** 2 * _SIDE**2
    found = np.linalg.solve(squares + ridge * np.eye(2), rights[..., None])[..., 0]
    return here[:, None] * middle + found[:, :1] * across + found[:, 1:] * up


def _tangents(directions):
    """Two unit vectors, each (n, 3), at right angles to directions (n, 3) and to each other."""
    other = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
    across = np.cross(directions, other)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return across, np.cross(directions, across)
