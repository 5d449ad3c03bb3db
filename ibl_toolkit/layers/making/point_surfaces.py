"""Points seen from a place, splatted: for each pixel the surface in front, and the last one behind it.

Source: thesis, section 6.3.3, which has points become pairs of direction and distance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .grid import PixelGrid

_CELL_PX = 16  # cells in which points are counted
_SPARSE = 25  # percentile of cells whose spacing decides
_OVERLAP = 0.75  # of the spacing: half a splat's width
_CORNER = 0.5  # the side of a cube map's narrow pixels, in mean ones
_MOST_STRETCHED = 5
_BLOCK = 1 << 18


@dataclass(frozen=True)
class Surfaces:
    """1/depth (size,) [1/m] and colour (size, 3) of the first surface of each pixel, and of the last one
    behind it; NaN where there is none."""

    near: np.ndarray
    colours: np.ndarray
    behind: np.ndarray
    behind_colours: np.ndarray


def splat_width(grid: PixelGrid, directions: np.ndarray) -> float:
    """Width [px] of splats so that those of points (n, 3) touch, from how many there are in cells of 16 px.

    1.5 times the spacing that a quarter of the cells with points in them exceed; at least 1.
    """
    cell = _CELL_PX * grid.pixel
    z, angle = directions[:, 2], np.arctan2(directions[:, 1], directions[:, 0])
    bands, columns = int(np.ceil(2 / cell)), int(np.ceil(2 * np.pi / cell))
    numbers = np.minimum((z + 1) / 2 * bands, bands - 1).astype(np.int64) * columns
    numbers += np.minimum((angle / (2 * np.pi) + 0.5) * columns, columns - 1).astype(np.int64)
    counts = np.bincount(numbers)
    spacing = np.sqrt(4 * np.pi / (bands * columns) / counts[counts > 0]) / grid.pixel
    return float(max(1.0, 2 * _OVERLAP * np.percentile(spacing, 100 - _SPARSE)))


def surfaces_of_points(grid: PixelGrid, offsets, colours, width_px: float, radius: float) -> Surfaces:
    """Splat points at offsets (n, 3) [m] from the origin, panorama frame, with colours (n, 3).

    Of the points that cover a pixel those belong to the first surface whose 1/depth is within (1 + width) px
    of parallax at `radius` [m] of the nearest's, as are those of a floor one radius below that fall into one
    splat; those to the last that are so near to the farthest's. It is there if twice as far from the first.
    A surface's colour and 1/depth are means, weighted by how near the points are to the pixel's centre.
    """
    distance = np.linalg.norm(offsets, axis=1)
    rays = offsets / distance[:, None]
    parts = [
        _covered(grid, rays[start : start + _BLOCK], width_px, start) for start in range(0, len(rays), _BLOCK)
    ]
    pixel, point, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    near = (1 / distance)[point]
    apart = (1 + width_px) * grid.pixel / max(radius, 1e-12)
    nearest, farthest = np.full(grid.size, -np.inf), np.full(grid.size, np.inf)
    np.maximum.at(nearest, pixel, near)
    np.minimum.at(farthest, pixel, near)
    is_first = near >= nearest[pixel] - apart
    is_last = (near <= farthest[pixel] + apart) & (farthest < nearest - 2 * apart)[pixel]
    means = []
    for chosen in (is_first, is_last):
        means += _means(grid, pixel[chosen], weight[chosen], near[chosen], colours[point[chosen]])
    return Surfaces(*means)


def _means(grid, pixel, weight, near, colours):
    """Weighted means by pixel: 1/depth (size,) and colours (size, 3), NaN where there is no point."""
    columns = [np.bincount(pixel, weight * values, grid.size) for values in (near, *colours.T)]
    total = np.bincount(pixel, weight, grid.size)
    empty = np.full((4, grid.size), np.nan)
    means = np.divide(columns, total, out=empty, where=total > 0).astype(np.float32)
    return means[0], np.ascontiguousarray(means[1:].T)


def _covered(grid, directions, width_px, first):
    """Pixels that splats of points (n, 3) cover, the points' numbers from `first` on, and weights."""
    across, up = _east_and_up(directions)
    level = np.hypot(directions[:, 0], directions[:, 1])
    stretched = np.zeros(len(directions), dtype=np.int64)
    if not grid.is_cube:  # towards the poles pixels are narrow
        stretched = np.clip(np.floor(-np.log2(np.maximum(level, 1e-9))), 0, _MOST_STRETCHED).astype(np.int64)
    half, parts = width_px / 2 * grid.pixel, []
    for times in np.unique(stretched):
        points = np.flatnonzero(stretched == times)
        fine = _CORNER if grid.is_cube else 1.0
        s, t = np.meshgrid(_places(width_px, fine * 0.5**times), _places(width_px, fine))
        for a, b in zip(s.reshape(-1), t.reshape(-1), strict=True):
            pixel = grid.at(directions[points] + half * (a * across[points] + b * up[points]))
            chord = np.linalg.norm(grid.directions[pixel] - directions[points], axis=1)
            parts.append((pixel, points + first, np.exp(-((chord / half) ** 2)) + 1e-9))
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


def _places(width_px, spacing):
    return np.linspace(-1, 1, int(np.ceil(width_px / spacing)) + 1)


def _east_and_up(directions):
    across = np.stack([-directions[:, 1], directions[:, 0], np.zeros(len(directions))], axis=1)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(length > 1e-9, across / np.maximum(length, 1e-9), (0.0, 1.0, 0.0))
    return across, np.cross(directions, across)
