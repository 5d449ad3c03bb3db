"""Colours of what is hidden, continued from what is seen beside it.

Source: thesis, section 6.3.1, which asks for inpainting; this is the smoothest filling, a membrane of log
radiance, region by region. The logarithm keeps a lamp beside a dark wall from spreading over it.
"""

from __future__ import annotations

import numpy as np

from .flood import flood
from .grid import PixelGrid

_FLOOR = 1e-4  # of the mean radiance: what is added before the logarithm, so that black has one
_STEPS = 60  # of conjugate gradients, from a start that is right along the edges
_ENOUGH = 1e-3  # largest residual, in log radiance


def filled_radiance(grid: PixelGrid, radiance, source, pixels, labels) -> np.ndarray:
    """Radiance (n, 3) of pixels (n,), float32, from that of the pixels of `source` (size,) bool.

    radiance: (size, 3). labels: (size,) regions, of source and of pixels: colours go from pixel to pixel of
    one region. Where a pixel's region has no source beside it, they come from any.
    Raises: ValueError when no pixel is a source.

    >>> grid = PixelGrid("equirectangular", 4, 2)
    >>> radiance = np.array([[2.0, 2, 2]] * 8)
    >>> filled_radiance(grid, radiance, np.arange(8) > 0, np.array([0]), np.zeros(8)).round(3).tolist()
    [[2.0, 2.0, 2.0]]
    """
    if not source.any():
        raise ValueError("no pixel is left to take colours from")
    floor = max(_FLOOR * float(radiance[source].mean()), 1e-30)
    known = np.flatnonzero(source)
    logs = np.empty((grid.size, 3), dtype=np.float32)
    logs[known] = np.log(np.maximum(radiance[known], 0) + floor)
    target = np.zeros(grid.size, dtype=bool)
    target[pixels] = True
    together = labels == labels[grid.neighbours]
    start = _nearest(grid, source, target, together)
    found = logs[start[pixels]]
    found = _membrane(grid, logs, source, target, pixels, together, found)
    return np.maximum(np.exp(found) - floor, 0).astype(np.float32)


def _nearest(grid, source, target, together):
    """For each target (size,) the nearest source that reaches it, in its own region if any does."""
    start = np.full(grid.size, -1, dtype=np.int64)
    for joined in (together, np.ones_like(together)):
        left = target & (start < 0)
        pixel, other = grid.pairs((source | (target & ~left)) & left[grid.neighbours] & joined)
        first = np.where(source[pixel], pixel, start[pixel])
        _, number = flood(grid, other, first, np.full(len(other), np.pi + 1), left, joined)
        reached = number >= 0
        start[reached] = first[number[reached]]
    return np.where(target & (start < 0), np.argmax(source), start)


def _membrane(grid, logs, source, target, pixels, together, found):
    """Solve that each of (n, 3) is the mean of its neighbours of one region, by conjugate gradients."""
    place = np.full(grid.size, len(pixels), dtype=np.int64)
    place[pixels] = np.arange(len(pixels))
    slots = grid.neighbours[:, pixels]
    joined = together[:, pixels]
    inner = np.where(joined & target[slots], place[slots], len(pixels))
    outer = joined & source[slots] & ~target[slots]
    degree = (outer.sum(axis=0) + (inner < len(pixels)).sum(axis=0))[:, None].astype(np.float32)
    right = sum(np.where(outer[k][:, None], logs[slots[k]], 0) for k in range(4))

    def product(values):
        padded = np.vstack([values, np.zeros((1, 3), values.dtype)])
        return degree * values - sum(padded[inner[k]] for k in range(4))

    residual = right - product(found)
    direction, square = residual, (residual**2).sum(axis=0)
    for _ in range(_STEPS):
        if not np.abs(residual).max(initial=0) > _ENOUGH:
            break
        image = product(direction)
        curvature = (direction * image).sum(axis=0)
        step = np.divide(square, curvature, out=np.zeros_like(square), where=curvature > 0)
        found = found + step * direction
        residual = residual - step * image
        before, square = square, (residual**2).sum(axis=0)
        turn = np.divide(square, before, out=np.zeros_like(square), where=before > 0)
        direction = residual + turn * direction
    return found
