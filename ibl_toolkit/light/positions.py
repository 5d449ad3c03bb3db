"""Where the lights of a map with depth are: the middle of what each region shows."""

import numpy as np

from .. import equirectangular
from .light_map import luminance, strips

LEAST_WITH_DEPTH = 0.5
"""A region with depth for less of its light has no place: most of it is at infinity."""


def moments(image, partition, count, depth=None):
    """Per region: power Σ P and Σ P ω, or Σ P z ω where there is depth; (count, 4), P = luminance · Ω.

    With `depth` (H, W) [m], only pixels of finite depth count. Sums run over the runs of one number in a row.
    """
    height, width = partition.shape
    around, upwards = _around(width), _upwards(height)
    solid_angles = equirectangular.row_solid_angles(width, height)
    total = np.zeros((count + 1, 4))  # the first for pixels outside, -1
    for rows in strips(height):
        numbers = partition[rows]
        if numbers.max() < 0:
            continue
        power = luminance(image[rows]) * solid_angles[rows, None]
        weighted = power
        if depth is not None:
            power = np.where(np.isfinite(depth[rows]), power, 0)
            weighted = power * np.where(np.isfinite(depth[rows]), depth[rows], 0)
        is_start = np.ones(numbers.shape, bool)
        np.not_equal(numbers[:, 1:], numbers[:, :-1], out=is_start[:, 1:])
        starts = np.flatnonzero(is_start)
        row = starts // width
        x, y, one, own = (
            np.add.reduceat(values.ravel(), starts)
            for values in (weighted * around[:, 0], weighted * around[:, 1], weighted, power)
        )
        horizontal, up = upwards[rows][row].T
        sums = np.stack([own, horizontal * x, horizontal * y, up * one], axis=1)
        for k in range(4):
            total[:, k] += np.bincount(numbers.ravel()[starts] + 1, sums[:, k], count + 1)
    return total[1:]


def _around(width):
    """cos φ and sin φ of every column, (W, 2)."""
    u = (np.arange(width) + 0.5) / width
    return equirectangular.direction_from_uv(np.stack([u, np.full(width, 0.5)], axis=1))[:, :2]


def _upwards(height):
    """cos θ and sin θ of every row, (H, 2)."""
    v = (np.arange(height) + 0.5) / height
    return equirectangular.direction_from_uv(np.stack([np.full(height, 0.5), v], axis=1))[:, ::2]


def mean_directions(image, samples):
    """Directions (n, 3) to the middle of each region's light; the sample's own where that is the centre."""
    sums = moments(image, samples.partition, len(samples))[:, 1:]
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    has_middle = lengths > 1e-6 * samples.luminance[:, None]
    return np.where(has_middle, sums / np.where(has_middle, lengths, 1), samples.directions)


def check_depth(depth, image):
    """The depth (H, W) as an array; ValueError for another shape, or NaN or not above 0.

    >>> check_depth([[2.0, np.inf]], np.ones((1, 2, 3)))
    array([[ 2., inf]])
    """
    if np.shape(depth) != image.shape[:2]:
        raise ValueError(f"depth has shape {np.shape(depth)}; expected the light map's {image.shape[:2]}")
    depth = np.asarray(depth)
    wrong = np.count_nonzero(~(depth > 0))
    if wrong:
        raise ValueError(f"depth has {wrong} values that are NaN or not above 0; expected +inf for none")
    return depth


def positions_at_depth(image, samples, depth):
    """Positions (n, 3) [m], panorama frame: the mean of ω·z over each region, weighted by its light.

    depth: (H, W) along the ray [m], +inf where there is none. NaN for a region whose light is mostly there.

    Source: thesis section 5.7.1: light comes from positions z·ω.

    Raises: ValueError for a depth of another shape, or NaN or not above 0.

    >>> from .samples import samples_from_sites
    >>> image = np.ones((8, 16, 3), np.float32)
    >>> samples = samples_from_sites(image, [[0, 0, 1], [0, 0, -1]])
    >>> positions_at_depth(image, samples, np.full((8, 16), 2.0)).round(1) + 0.0
    array([[ 0.,  0.,  1.],
           [ 0.,  0., -1.]])
    """
    depth = check_depth(depth, image)
    sums = moments(image, samples.partition, len(samples), depth)
    has_place = sums[:, :1] > LEAST_WITH_DEPTH * samples.luminance[:, None]
    return np.where(has_place, sums[:, 1:] / np.where(has_place, sums[:, :1], 1), np.nan)
