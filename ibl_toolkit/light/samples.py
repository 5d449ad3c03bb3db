"""The samples of a light map: where they are, what light they stand for, and which pixels are theirs.

Source: thesis section 3.1.1 (eq. 3.5: a sample carries the radiance of its cell, integrated over solid angle)
and 3.1.3 (positions, partition image and energies are what a pre-sampling map keeps).
"""

from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from .light_map import LUMINANCE, STRIP, strips
from .voronoi import unit_directions, voronoi_partition


@dataclass(frozen=True)
class LightSamples:
    """Samples of a light map and its partition into their regions; n ≥ 1, each with pixels and with light."""

    uv: np.ndarray
    """(n, 2) positions in the image, in [0, 1)."""
    directions: np.ndarray
    """(n, 3) unit vectors in the panorama frame."""
    irradiance: np.ndarray
    """(n, 3) RGB radiance of each region, integrated over its solid angle."""
    solid_angles: np.ndarray
    """(n,) of the regions [sr]."""
    partition: np.ndarray
    """(H, W) int32 number of the region that a pixel belongs to; -1 outside the mask."""

    def __len__(self):
        return len(self.directions)

    @property
    def luminance(self):
        """(n,) luminance of each region's irradiance."""
        return self.irradiance @ LUMINANCE


def samples_from_partition(image, uv, partition):
    """Samples at ``uv`` (n, 2) with the light of their regions: ``partition`` (H, W) of ``image`` (H, W, 3).

    Sums run in float64 over the runs of equal numbers in a row. A sample without pixels gets irradiance 0:
    that none such is returned to a user is the caller's task.

    Raises: ValueError where shapes differ or a region has no sample.

    >>> image = np.ones((2, 4, 3), np.float32)
    >>> halves = np.array([[0, 0, 1, 1], [0, 0, 1, 1]], np.int32)
    >>> (samples_from_partition(image, [[0.25, 0.5], [0.75, 0.5]], halves).solid_angles / np.pi).round(12)
    array([2., 2.])
    """
    uv = np.asarray(uv, dtype=np.float64).reshape(-1, 2)
    return _with_light(image, uv, equirectangular.direction_from_uv(uv), partition)


def samples_from_sites(image, directions, mask=None):
    """Samples whose regions are the spherical Voronoi cells of ``directions`` (n, 3), restricted to ``mask``.

    Sites whose cell has no pixel (closer together than pixels are, or repeated) and those whose cell is black
    are dropped; the others share their cells out anew. So fewer than n may come back.

    Raises: ValueError if no light is in the mask.

    >>> len(samples_from_sites(np.ones((4, 8, 3), np.float32), [[1, 0, 0], [0, 1, 0], [1, 0, 0]]))
    2
    """
    height, width = image.shape[:2]
    directions = unit_directions(directions)
    while len(directions):
        partition = voronoi_partition(directions, width, height, mask)
        uv = equirectangular.uv_from_direction(directions)
        samples = _with_light(image, uv, directions, partition)
        dark = (samples.luminance <= 0) & (samples.solid_angles > 0)
        if not dark.any():
            return combined(samples, *_numbered(samples.solid_angles > 0, directions))
        directions = directions[~dark]
    raise ValueError("no light is in the cells of the samples: their luminance is 0; expected some")


def combined(samples, groups, directions):
    """Samples merged by ``groups`` (n,), the new number of each (-1: dropped, its pixels too): m samples.

    ``directions`` (m, 3), of any length but zero, are the new positions.

    Raises: ValueError unless groups are whole numbers from -1 to m - 1.

    >>> one = samples_from_sites(np.ones((4, 8, 3), np.float32), [[1, 0, 0], [-1, 0, 0]])
    >>> (combined(one, [0, 0], [[1, 0, 0]]).solid_angles / np.pi).round(12)
    array([4.])
    """
    directions = unit_directions(directions)
    groups = np.asarray(groups, dtype=np.int32)
    if groups.shape != (len(samples),) or groups.min() < -1 or groups.max() >= len(directions):
        raise ValueError(
            f"groups of shape {groups.shape} reach from {groups.min()} to {groups.max()}; expected a number "
            f"from -1 to {len(directions) - 1} for each of {len(samples)} samples"
        )
    irradiance = np.zeros((len(directions), 3))
    solid_angles = np.zeros(len(directions))
    kept = groups >= 0
    np.add.at(irradiance, groups[kept], samples.irradiance[kept])
    np.add.at(solid_angles, groups[kept], samples.solid_angles[kept])
    partition = samples.partition
    if not np.array_equal(groups, np.arange(len(directions))):
        renumbered = np.append(groups, np.int32(-1))  # pixels outside the mask, -1, find the last
        partition = np.empty_like(partition)
        for rows in strips(len(partition)):
            np.take(renumbered, samples.partition[rows], out=partition[rows], mode="wrap")
    uv = equirectangular.uv_from_direction(directions)
    return LightSamples(uv, directions, irradiance, solid_angles, partition)


def _numbered(kept, directions):
    """Groups that number the kept ones anew, and their directions."""
    return np.where(kept, np.cumsum(kept) - 1, -1), directions[kept]


def _with_light(image, uv, directions, partition):
    if partition.shape != image.shape[:2]:
        raise ValueError(f"the partition has shape {partition.shape}; expected the image's {image.shape[:2]}")
    count = len(uv)
    solid_angles = equirectangular.row_solid_angles(partition.shape[1], partition.shape[0])
    sums = np.zeros((4, count + 1))  # the first for pixels outside
    for rows in strips(len(partition), STRIP):
        strip = _strip_sums(image[rows], partition[rows], solid_angles[rows], count + 1)
        if strip.shape != sums.shape:
            raise ValueError(f"the partition has region {strip.shape[1] - 2}; expected numbers below {count}")
        sums += strip
    return LightSamples(uv, directions, sums[:3, 1:].T.copy(), sums[3, 1:].copy(), partition)


def _strip_sums(image, partition, solid_angles, count):
    """Irradiance R, G, B and solid angle, (4, count), of the regions -1 … count - 2 in some rows."""
    width = partition.shape[1]
    is_start = np.ones(partition.shape, bool)
    np.not_equal(partition[:, 1:], partition[:, :-1], out=is_start[:, 1:])
    starts = np.flatnonzero(is_start)
    regions = partition.ravel()[starts] + 1
    weights = solid_angles[starts // width]
    runs = [np.add.reduceat(image[..., k].ravel(), starts, dtype=np.float64) for k in range(3)]
    runs.append(np.diff(starts, append=partition.size))
    return np.stack([np.bincount(regions, run * weights, minlength=count) for run in runs])
