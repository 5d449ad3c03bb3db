"""From the visible samples of a picture to its pixels: the filter of points (thesis, 7.3.1.1, Alg. 9)."""

from __future__ import annotations

import numpy as np

from .subsampling import Samples


def filtered(samples: Samples, radius: float, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Colours (height, width, 3) float32, 0 where no sample is near; 1/distance (height, width), NaN there.

    A sample counts in the pixels whose centres lie within `radius` [px], at most 1, of it in x and in y, by
    the bilinear weight (1 - |x|/radius)(1 - |y|/radius). 1/distance is the mean over the pixel's own samples
    where it has any: surfaces are not mixed in it.
    """
    count = width * height
    corner = np.floor(samples.xy - np.float32(0.5)).astype(np.int32)
    across, along = ([_tent(samples.xy[k] - (corner[k] + step), radius) for step in (0, 1)] for k in (0, 1))
    sums = np.zeros((5, count))
    for down in (0, 1):
        for right in (0, 1):
            i, j = corner[0] + right, corner[1] + down
            weight = across[right] * along[down]
            there = np.flatnonzero((weight > 0) & (i >= 0) & (i < width) & (j >= 0) & (j < height))
            weight, pixel = weight[there], (j * width + i)[there]
            for k, values in enumerate((*samples.colours, samples.near)):
                sums[k] += np.bincount(pixel, weight * values[there], count)
            sums[4] += np.bincount(pixel, weight, count)
    own = np.floor(samples.xy).astype(np.int32)
    there = np.flatnonzero(((own >= 0) & (own < [[width], [height]])).all(axis=0))
    pixel = own[1, there] * width + own[0, there]
    owned = np.bincount(pixel, minlength=count)
    near = np.where(owned > 0, np.bincount(pixel, samples.near[there], count), sums[3])
    with np.errstate(invalid="ignore", divide="ignore"):
        near /= np.where(owned > 0, owned, sums[4])
        colours = np.where(sums[4] > 0, sums[:3] / sums[4], 0)
    return colours.T.reshape(height, width, 3).astype(np.float32), near.reshape(height, width)


def _tent(offset, radius):
    return np.maximum(1 - abs(offset - np.float32(0.5)) / np.float32(radius), 0)
