"""Importance sampling of a light map with blue noise, by the hierarchical tiling of Ostromoukhov et al.

The tiling lies over the image, which is 2 wide and 1 high in its plane, and turned so that no edge follows
a row of pixels.  It is subdivided breadth first and only where the importance asks for it.  A tile's point
becomes a sample where the importance, times a magnification, exceeds the point's code value.  A table of
correction vectors, relaxed beforehand, then moves the samples apart.

Deviations from the paper: importance is a real number, so that any dynamic range is followed; its maximum
over a triangle comes from a pyramid of maxima, not from the corners and the centre, so that no hot pixel
is missed; points are ranked by the magnification at which they appear, so that the count comes out; and
no pixel has two samples, a pixel being the smallest thing that a map knows.

The plane ends at the seam: the tiling on the left does not continue that on the right, so samples on either
side keep no distance.  So `penrose_sampling` puts the seam on the darkest meridian.  Corrections cross it.
Near the poles samples are spread in the plane, not on the sphere: their number is right, but some are close.

Source: Ostromoukhov, Donohue & Jodoin, Fast Hierarchical Importance Sampling with Blue Noise Properties,
SIGGRAPH 2004; thesis sections 3.1.1.2 and 3.2.3, and A.2.1 (area deformation, fig. A-1).
"""

import pathlib
from functools import lru_cache

import numpy as np

from .. import equirectangular
from . import penrose_tiles
from .light_map import check_count, check_light_map, check_mask, luminous_power
from .maximum_pyramid import MaximumPyramid
from .samples import samples_from_sites

_CORRECTIONS = pathlib.Path(__file__).with_name("penrose_corrections.npy")
_SCALE = 0.3  # root units per height of the image, which then lies inside the root at any rotation
_FROM_IMAGE = _SCALE * np.exp(0.13j)  # 0.13 rad: far from the edges' directions, all of 18 degrees
_MIDDLE = complex(penrose_tiles.PHI**2 / 2, 0.425)  # of the circle that touches the root's sides
_POINTS_PER_PIXEL = 8  # of the densest tiling in use: enough that every pixel has a point
_ROUND_OFF = 1e-9  # heights of the image: corners of tiles may lie that far off


def penrose_sampling(image, count, mask=None):
    """`LightSamples` of a light map (H, W, 3), `count` of them where the map allows it, in order of rank.

    Positions are those of `penrose_points` for luminance times solid angle; regions are spherical Voronoi
    cells, restricted to `mask` (H, W).  A sample that would lose its own pixel to a neighbour is moved to
    that pixel's centre, so none is left without a region.  There are fewer than `count` samples only if
    fewer pixels of the mask have light.

    Raises: ValueError for a map or mask without light, or of the wrong shape, and for a count below 1.

    Source: thesis section 3.1.1.2; eq. 3.5 for the energies.

    >>> samples = penrose_sampling(np.ones((32, 64, 3)), 10)
    >>> len(samples), float((samples.irradiance.sum() / 3 / np.pi).round(6))
    (10, 4.0)
    """
    image = check_light_map(image)
    mask = check_mask(mask, image)
    power = luminous_power(image, mask)
    darkest = int(np.argmin(power.sum(axis=0, dtype=np.float64)))
    uv = penrose_points(np.roll(power, -darkest, axis=1), count)
    uv[:, 0] = (uv[:, 0] + darkest / image.shape[1]) % 1.0
    return samples_from_sites(image, _settled(uv, image.shape[1], image.shape[0]), mask)


def penrose_points(importance, count):
    """Positions uv (n, 2) of `count` points whose density in the image follows `importance` (H, W).

    Each lies in a pixel of positive importance that has no other point; n is `count`, or the number of
    such pixels if that is smaller.  Importance counts as float32.

    The order is progressive: apart from their correction vectors, which follow the local density, the
    first n points are those of a count of n.

    Raises: ValueError for importance that is negative, not finite or zero everywhere, or count below 1.

    >>> penrose_points([[0, 0, 1, 1], [0, 0, 1, 1]], 9)[:, 0].min() >= 0.5
    True
    >>> len(penrose_points([[0, 0, 1, 1], [0, 0, 1, 1]], 9))
    4
    """
    count = check_count(count)
    importance = _check_importance(importance)
    tiles, magnified = _ranked(MaximumPyramid(importance), count)
    own, uv = _uv_from_plane(tiles.point), _uv_from_plane(tiles.point + _correction(tiles, magnified))
    uv[:, 0] %= 1.0
    astray = _is_astray(uv, own, importance)
    uv[astray] = own[astray]
    return uv


def _check_importance(importance):
    with np.errstate(over="ignore"):
        importance = np.asarray(importance, dtype=np.float32)
    if importance.ndim != 2 or not importance.size:
        raise ValueError(f"importance has shape {importance.shape}; expected (H, W)")
    least, largest = float(importance.min()), float(importance.max())
    if not (least >= 0 and 0 < largest < np.inf):
        raise ValueError(
            f"importance is {least} to {largest}; expected finite values, none negative and some above 0"
        )
    return importance


def _ranked(pyramid, count):
    """The first `count` sampling tiles by the magnification that they need, and their magnified importance.

    Twice the magnification brings at most about twice the points, so the search does not run away.  It
    ends, as a tiling of `limit` has a point in every pixel.
    """
    importance = pyramid.image
    height, width = importance.shape
    value_per_density = 2 * penrose_tiles.ROOT_AREA / _SCALE**2  # points per image height squared
    limit = _POINTS_PER_PIXEL * value_per_density * max(width / 2, height) ** 2
    wanted = count + 3 * np.sqrt(count) + 8  # the number is not exact, and pixels may be shared
    magnification = wanted / 2 * value_per_density / importance.mean(dtype=np.float64)
    tiles, local, needed = _candidates(pyramid, magnification, limit)
    if len(tiles) < count:
        count = min(count, np.count_nonzero(importance))
    while len(tiles) < count:
        full = np.count_nonzero(magnification * local >= limit)  # pixels that no magnification helps
        growing = len(tiles) - full
        magnification *= max(4.0 if growing else 100.0, 1.1 * (count - full) / (growing + 1))
        tiles, local, needed = _candidates(pyramid, magnification, limit)
    return tiles[:count], np.minimum(local[:count] * needed[:count].max(), limit)


def _candidates(pyramid, magnification, limit):
    """Sampling tiles, one per pixel, their importance and the magnification that each needs, in this order.

    A tile belongs where magnification times importance, or `limit` if that is less, reaches its code value
    + 1/2: the value itself is an integer, and 0 is not to be had for nothing.
    """
    height, width = pyramid.image.shape

    def is_needed(triangles):
        least = penrose_tiles.FIBONACCI[2 * triangles.level + 2] + 0.5  # of what would appear below
        return np.minimum(magnification * _bound(pyramid, triangles), limit) >= least

    tiles = penrose_tiles.sampling_tiles_below(limit, is_needed)
    uv = _uv_from_plane(tiles.point)
    inside = ((uv >= 0) & (uv < 1)).all(axis=1)
    tiles, pixels = tiles[inside], _pixels(uv[inside], width, height)
    local = pyramid.image.ravel()[pixels].astype(np.float64)
    reached = np.minimum(magnification * local, limit) >= tiles.value + 0.5
    tiles, pixels, local = tiles[reached], pixels[reached], local[reached]
    needed = (tiles.value + 0.5) / local
    order = np.lexsort((tiles.value, needed))
    order = order[np.sort(np.unique(pixels[order], return_index=True)[1])]  # the first of each pixel
    return tiles[order], local[order], needed[order]


def _bound(pyramid, triangles):
    """Upper bound (n,) of the importance inside each of `triangles`; 0 outside the image."""
    height, width = pyramid.image.shape
    corners = (triangles.corners() - _MIDDLE) / _FROM_IMAGE + (1 + 0.5j)
    columns, rows = corners.real * (width / 2), corners.imag * height
    sides = (columns.min(axis=1) - _ROUND_OFF * width, columns.max(axis=1) + _ROUND_OFF * width,
             rows.min(axis=1) - _ROUND_OFF * height, rows.max(axis=1) + _ROUND_OFF * height)
    return pyramid.bound(*(np.floor(side).astype(np.int64) for side in sides))


def _correction(tiles, magnified):
    """Correction vectors (n,), complex, in the plane of the tiling, for the `magnified` importance (n,)."""
    level = penrose_tiles.level_of(magnified)
    structure = penrose_tiles.structural_index(tiles.value, level)
    return _corrections()[penrose_tiles.importance_index(magnified), structure] * tiles.frame_at(level)


@lru_cache(maxsize=1)
def _corrections():
    table = np.load(_CORRECTIONS, allow_pickle=False).astype(np.float64)
    return table[..., 0] + 1j * table[..., 1]


def _is_astray(uv, own, importance):
    """Which corrected points uv (n, 2) came to where they do not belong, compared with their `own` place.

    That is outside the image, into another point's pixel, or across an edge: to where the importance
    differs by more than a level's factor, phi**2, so that another density begins.
    """
    height, width = importance.shape
    before, after = _pixels(own, width, height), _pixels(uv, width, height)
    _, group, size = np.unique(after, return_inverse=True, return_counts=True)
    is_taken = (after != before) & np.isin(after, before) | (size[group] > 1)
    is_outside = (uv[:, 1] < 0) | (uv[:, 1] >= 1)
    with np.errstate(divide="ignore"):
        levels = np.log(importance.ravel()[[after, before]].astype(np.float64)) / np.log(penrose_tiles.PHI**2)
    return is_outside | is_taken | (np.abs(levels[0] - levels[1]) > 1)


def _settled(uv, width, height):
    """Directions (n, 3) of points uv (n, 2), one a pixel, moved so that each is the nearest to its pixel.

    Those that are not go to their pixel's centre; that may leave others behind, so it is repeated.
    """
    pixels = _pixels(uv, width, height)
    columns_rows = np.stack([pixels % width, pixels // width], axis=-1)
    centres = equirectangular.uv_from_pixel(columns_rows, width, height)
    centres = equirectangular.direction_from_uv(centres)
    directions = equirectangular.direction_from_uv(uv)
    while (lost := _is_lost(directions, centres)).any():
        directions[lost] = centres[lost]
    return directions


def _is_lost(directions, centres):
    """Which of `centres` (n, 3) are nearer to another direction than to their own, (n,)."""
    own = np.linalg.norm(directions - centres, axis=1)
    order = np.argsort(directions[:, 2])
    height = directions[order, 2]
    first = np.searchsorted(height, centres[:, 2] - own)
    count = np.searchsorted(height, centres[:, 2] + own, side="right") - first
    which = np.repeat(np.arange(len(centres)), count)
    other = order[np.arange(len(which)) + np.repeat(first - (np.cumsum(count) - count), count)]
    nearer = np.linalg.norm(directions[other] - centres[which], axis=1) < own[which]
    return np.bincount(which[nearer & (other != which)], minlength=len(centres)) > 0


def _uv_from_plane(points):
    """Image points uv (n, 2) of complex points of the tiling's plane."""
    image = (points - _MIDDLE) / _FROM_IMAGE + (1 + 0.5j)
    return np.stack([image.real / 2, image.imag], axis=-1)


def _pixels(uv, width, height):
    """Row-major numbers (n,) of the pixels that points uv (n, 2) lie in; the nearest, outside the image."""
    columns, rows = np.floor(uv * (width, height)).astype(np.int64).T
    return np.clip(rows, 0, height - 1) * width + np.clip(columns, 0, width - 1)
