"""The separable low-pass over a map's moments."""

import numpy as np


def kernel(window: int) -> np.ndarray:
    """Weights (window,) of a Gaussian with σ = window/4: as wide as the penumbra of a disc that wide.

    >>> kernel(3).round(3)
    array([0.226, 0.549, 0.226])
    """
    place = np.arange(window) - window // 2
    weights = np.exp(-0.5 * (place / (window / 4)) ** 2)
    return weights / weights.sum()


def along(moments: np.ndarray, axis: int, window: int) -> np.ndarray:
    """Moments (N, N, C) filtered along an axis of the map; border texels count beyond the border."""
    reach = window // 2
    pad = [(reach, reach) if k == axis else (0, 0) for k in range(3)]
    padded = np.pad(moments, pad, mode="edge")
    size = moments.shape[axis]
    parts = (np.take(padded, range(k, k + size), axis=axis) * w for k, w in enumerate(kernel(window)))
    return sum(parts)


def blurred(texels: np.ndarray, window: int, encode, decode) -> np.ndarray:
    """Texels filtered in two passes; each unpacks what it reads and packs what it writes, as devices do."""
    if window == 1:
        return texels
    for axis in (1, 0):
        texels = encode(along(decode(texels), axis, window))
    return texels
