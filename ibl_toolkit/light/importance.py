"""Importance sampling of a light map: directions drawn by the map's own luminance.

The density on the sphere is L(ω) / ∫ L, constant within a pixel. It is inverted exactly: first the rows,
whose power has the area deformation in it, then the columns of the row that was drawn, then the place inside
the pixel, even in solid angle. The numbers that drive it are stratified in two dimensions: one drawn in each
of n steps for the rows, the radical inverse turned by a random angle for the columns.

Source: thesis section 3.1.2 (Pharr and Humphreys) and appendix A.2.1, eq. A.10; Hammersley points with a
Cranley-Patterson rotation; the regions as for any sampler without its own, section 3.1.3.2.
"""

import numpy as np

from .light_map import check_count, check_light_map, check_mask, luminous_power
from .samples import samples_from_sites


def importance_sampling(image, count, mask=None, seed=0):
    """Samples of a light map (H, W, 3) at up to `count` drawn directions, with Voronoi regions.

    ``mask`` (H, W) restricts it to a part of the map. Of the samples drawn in one pixel the first stays, and
    those whose region has no light or no pixel are dropped, so a map with a few bright pixels gives fewer.

    Raises: ValueError for a bad map, mask or count, and for a mask without light.

    >>> len(importance_sampling(np.ones((16, 32, 3), np.float32), 10))
    10
    """
    image, count = check_light_map(image), check_count(count)
    mask = check_mask(mask, image)
    rows, columns, directions = draw(luminous_power(image, mask), count, np.random.default_rng(seed))
    _, first = np.unique(rows * image.shape[1] + columns, return_index=True)
    return samples_from_sites(image, directions[np.sort(first)], mask)


def draw(power, count, rng):
    """Row, column (n,) and direction (n, 3) of `count` samples drawn by ``power`` (H, W) per pixel.

    >>> rows, columns, _ = draw(np.eye(2, 4), 3, np.random.default_rng(0))
    >>> bool((rows == columns).all())
    True
    """
    height, width = power.shape
    u, v = _stratified(count, rng)
    row_power = power.sum(axis=1, dtype=np.float64)
    rows, down = _inverted(np.cumsum(row_power), u)
    columns, along = np.empty(count, int), np.empty(count)
    for row in np.unique(rows):
        chosen = rows == row
        columns[chosen], along[chosen] = _inverted(np.cumsum(power[row], dtype=np.float64), v[chosen])
    azimuths = (0.5 - (columns + along) / width) * (2 * np.pi)
    upper, lower = (np.sin((0.5 - (rows + edge) / height) * np.pi) for edge in (0, 1))
    z = upper + (lower - upper) * down
    horizontal = np.sqrt(np.maximum(1 - z * z, 0))
    return rows, columns, np.stack([horizontal * np.cos(azimuths), horizontal * np.sin(azimuths), z], axis=1)


def _stratified(count, rng):
    """Numbers u, v (n,) in [0, 1): one u in each of n steps, v well spread for any run of steps."""
    u = (np.arange(count) + rng.random(count)) / count
    v = np.zeros(count)
    index, step = np.arange(count), 0.5
    while index.any():
        v += step * (index & 1)
        index >>= 1
        step /= 2
    return np.minimum(u, np.nextafter(1, 0)), (v + rng.random()) % 1


def _inverted(cumulated, u):
    """Index of the step of a cumulated distribution that u (n,) falls on, and where on it, in [0, 1]."""
    target = np.minimum(u * cumulated[-1], np.nextafter(cumulated[-1], 0))
    index = np.searchsorted(cumulated, target, side="right")
    start = np.where(index > 0, cumulated[index - 1], 0.0)
    return index, (target - start) / (cumulated[index] - start)
