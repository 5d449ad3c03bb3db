"""Directions <-> pixels of an equirectangular panorama.

The only place that knows this mapping.  Directions are in the panorama frame: +x is the middle of the
image, +y its left quarter, +z its top row.  With u from the left edge and v from the top edge,

    phi = (1/2 - u) 2 pi,  theta = (1/2 - v) pi,
    omega = (cos theta cos phi, cos theta sin phi, sin theta),

which is what Cycles' Environment Texture does.

Source: thesis, appendix A.2, eq. A.3-A.7, with another origin and sense of phi, theta as elevation, and
pixel centres at ((i + 1/2)/W, (j + 1/2)/H) where eq. A.6 has the pixels' corners.
"""

from functools import lru_cache

import numpy as np

_BLOCK = 1 << 17  # directions per step of `sample`: its temporaries then stay in the cache
_CACHED_PIXELS = 4096 * 2048  # beyond, a kept direction map would cost more memory than its time is worth


def direction_from_uv(uv):
    """Unit directions (..., 3), float64, of image points (..., 2).

    >>> direction_from_uv([0.25, 0.5]).round(12) + 0.0
    array([0., 1., 0.])
    """
    uv = np.asarray(uv, dtype=np.float64)
    phi = (0.5 - uv[..., 0]) * (2 * np.pi)
    theta = (0.5 - uv[..., 1]) * np.pi
    horizontal = np.cos(theta)
    return np.stack([horizontal * np.cos(phi), horizontal * np.sin(phi), np.sin(theta)], axis=-1)


def uv_from_direction(direction):
    """Image points (..., 2) of directions (..., 3) of any length but zero: u in [0, 1), v in [0, 1].

    Exactly at a pole every u is right; u is then what `atan2` makes of the zeros.

    Raises: ValueError for a direction of length zero or one that is not finite.

    >>> uv_from_direction([0, 2, 0])
    array([0.25, 0.5 ])
    """
    x, y, z = direction_components(direction)
    u = 0.5 - np.arctan2(y, x) / (2 * np.pi)
    v = 0.5 - np.arctan2(z, np.hypot(x, y)) / np.pi
    return np.stack([np.where(u >= 1.0, 0.0, u), v], axis=-1)


def uv_from_pixel(ij, width, height):
    """Image points (..., 2) of pixel coordinates (column i, row j), whose centres lie at the integers.

    >>> uv_from_pixel([0, 1], 4, 2)
    array([0.125, 0.75 ])
    """
    return (np.asarray(ij, dtype=np.float64) + 0.5) / (width, height)


def pixel_from_uv(uv, width, height):
    """Continuous pixel coordinates (column i, row j) of image points (..., 2); centres at the integers.

    >>> pixel_from_uv([0.125, 0.75], 4, 2)
    array([0., 1.])
    """
    return np.asarray(uv, dtype=np.float64) * (width, height) - 0.5


def pixel_directions(width, height):
    """Directions (H, W, 3), float32, of all pixel centres; read-only, and kept for the next call.

    Maps of more than 8 million pixels are computed anew each time, so as not to fill the memory.

    >>> pixel_directions(4, 2).shape
    (2, 4, 3)
    """
    if width * height <= _CACHED_PIXELS:
        return _cached_pixel_directions(width, height)
    return _pixel_directions(width, height)


def row_solid_angles(width, height):
    """Exact solid angle [sr] of a pixel of each row, (H,).  All rows times W make 4 pi.

    Source: thesis, appendix A.2.1, integrated over the pixel (eq. A.9 takes it at one point).

    >>> float(row_solid_angles(8, 4).sum() * 8 / np.pi)
    4.0
    """
    theta = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    # sin(top) - sin(bottom) as a product: no cancellation in the thin rows at the poles.
    return (2 * np.pi / width) * 2 * np.sin(np.pi / (2 * height)) * np.cos(theta)


def sample(image, directions):
    """Bilinear look-up of `image` (H, W, C) or (H, W) at `directions` (..., 3); -> (..., C) or (...).

    Wraps at the seam.  A step over a pole comes down on the other side: the row above the top one is
    the top row turned by half a width.  (Cycles takes the bottom row there, so the two differ within
    half a pixel of the poles.)  Texels of weight zero do not count, so that an infinite depth spreads
    to its bilinear neighbourhood only and makes no NaN.

    Raises: ValueError for an odd width, which has no pixel column opposite to a column.

    >>> sample(np.array([[0., 1., 2., 3.], [4., 5., 6., 7.]]), [1, 0, 0])
    3.5
    """
    image = np.asarray(image)
    directions = np.asarray(directions)
    height, width = image.shape[:2]
    if width % 2:
        raise ValueError(f"image of width {width} px cannot be sampled over the poles: it must be even")
    texels = image.reshape(height * width, -1)
    flat = directions.reshape(-1, 3)
    result = np.empty((len(flat), texels.shape[1]), dtype=np.result_type(image.dtype, np.float32))
    for start in range(0, len(flat), _BLOCK):
        block = slice(start, start + _BLOCK)
        ij = pixel_from_uv(uv_from_direction(flat[block]), width, height)
        result[block] = _bilinear(texels, ij, width, height)
    return result.reshape(directions.shape[:-1] + image.shape[2:])[()]


def weighted_texels(texels, indices, weights):
    """Sum of `texels` (n, C) at `indices` (4 arrays (m,)) times `weights` (4 arrays (m,)); -> (m, C).

    A texel of weight zero does not count, even where it is infinite.
    """
    weights = [w.astype(np.result_type(texels.dtype, np.float32))[:, None] for w in weights]
    pairs = list(zip(indices, weights, strict=True))
    with np.errstate(invalid="ignore"):
        total = sum(texels.take(i, axis=0) * w for i, w in pairs)
    bad = np.flatnonzero(np.isnan(total).any(axis=1))
    if bad.size:
        total[bad] = sum(np.where(w[bad] > 0, texels[i[bad]], 0) * w[bad] for i, w in pairs)
    return total


def bilinear_weights(fraction_i, fraction_j):
    """Weights of the texels (left, top), (right, top), (left, bottom), (right, bottom)."""
    left, top = 1.0 - fraction_i, 1.0 - fraction_j
    return left * top, fraction_i * top, left * fraction_j, fraction_i * fraction_j


def _bilinear(texels, ij, width, height):
    corner = np.floor(ij)
    fraction = ij - corner
    i, j = corner.astype(np.int64).T
    indices = [texel_index(i + a, j + b, width, height) for b in (0, 1) for a in (0, 1)]
    return weighted_texels(texels, indices, bilinear_weights(*fraction.T))


def texel_index(i, j, width, height):
    """Row-major index of pixel (i, j), taken round the seam and over the poles."""
    over_a_pole = (j < 0) | (j >= height)
    i = (i + np.where(over_a_pole, width // 2, 0)) % width
    return np.clip(j, 0, height - 1) * width + i


def direction_components(direction):
    """x, y and z, each (...) float64, of directions (..., 3); ValueError if one is zero or not finite."""
    direction = np.asarray(direction, dtype=np.float64)
    x, y, z = np.moveaxis(direction, -1, 0)
    largest = np.max(np.abs(direction), axis=-1)
    usable = (largest > 0) & np.isfinite(largest)
    if not np.all(usable):
        bad = direction.reshape(-1, 3)[np.flatnonzero(~usable)[0]]
        raise ValueError(
            f"direction {tuple(bad.tolist())} points nowhere: its length must be finite and above 0"
        )
    return x, y, z


def _pixel_directions(width, height):
    u = uv_from_pixel(np.arange(width)[:, None], width, height)[:, 0]
    v = uv_from_pixel(np.arange(height)[:, None], width, height)[:, 1]
    phi, theta = (0.5 - u) * (2 * np.pi), (0.5 - v) * np.pi
    directions = np.empty((height, width, 3), dtype=np.float32)
    directions[..., 0] = np.cos(theta)[:, None] * np.cos(phi)
    directions[..., 1] = np.cos(theta)[:, None] * np.sin(phi)
    directions[..., 2] = np.sin(theta)[:, None]
    directions.flags.writeable = False
    return directions


_cached_pixel_directions = lru_cache(maxsize=4)(_pixel_directions)
