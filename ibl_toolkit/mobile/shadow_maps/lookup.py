"""Texels around a place of the map. Beyond its border the texels at the border count (CLAMP_TO_EDGE)."""

import numpy as np

_BLOCK = 1 << 16  # places at once


def in_blocks(function, *arrays):
    """What ``function`` gives for arrays (n, …), block by block: (n,)."""
    parts = [
        function(*(a[start : start + _BLOCK] for a in arrays)) for start in range(0, len(arrays[0]), _BLOCK)
    ]
    return np.concatenate(parts) if parts else np.empty(0)


def nearest(texels: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The texels (n, …) of a map (N, N, …) in which places (n, 2), s and t, lie."""
    size = len(texels)
    column, row = np.clip(np.floor(places * size).astype(np.int64), 0, size - 1).T
    return texels[row, column]


def box(size: int, places: np.ndarray, window: int):
    """Yield (row, column, weight), each (n,), of the texels under a box ``window`` texels wide.

    The box lies over a place of the map, not over a texel: the outermost count with the share that it covers.
    That is what bilinear comparisons give, taken a texel apart. The weights sum to 1.
    """
    corner = places * size - window / 2
    first = np.floor(corner)
    share = corner - first
    column, row = first.astype(np.int64).T
    for down in range(window + 1):
        for across in range(window + 1):
            weight = _part(share[:, 0], across, window) * _part(share[:, 1], down, window)
            rows, columns = (np.clip(v, 0, size - 1) for v in (row + down, column + across))
            yield rows, columns, weight / window**2


def _part(share, texel, window):
    if texel == 0:
        return 1 - share
    return share if texel == window else np.ones_like(share)


def bilinear(texels: np.ndarray, places: np.ndarray, decode) -> np.ndarray:
    """What the four texels next to places (n, 2) hold, decoded, then mixed: (n, C)."""
    return sum(
        weight[:, None] * decode(texels[row, column]) for row, column, weight in box(len(texels), places, 1)
    )
