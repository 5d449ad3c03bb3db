"""Rectangles into one rectangle of little area.

Each goes where its top comes lowest on the skyline of those placed before, the tallest first; several widths
are tried and the least area wins.

Source: J. Jylänki, "A Thousand Ways to Pack the Bin", 2010: SKYLINE-BL, sorted by height.
"""

from __future__ import annotations

import numpy as np

# Widths tried lie between these multiples of the side of a square with the rectangles' area.
_WIDTHS = np.geomspace(0.6, 2.5, 12)


def pack_rectangles(sizes: np.ndarray) -> tuple[np.ndarray, tuple[int, int]]:
    """Places (n, 2) of the top left corners of rectangles (n, 2) width, height [px], and the whole's size.

    Rectangles do not overlap and are not turned.

    >>> places, size = pack_rectangles(np.array([[2, 2], [2, 2], [4, 1]]))
    >>> places.tolist(), size
    ([[0, 0], [2, 0], [0, 2]], (4, 3))
    """
    order = np.lexsort((-sizes[:, 0], -sizes[:, 1]))
    side = np.sqrt(sizes.prod(axis=1, dtype=np.int64).sum())
    widths = np.unique(np.maximum(np.ceil(side * _WIDTHS).astype(int), sizes[:, 0].max()))
    best = None
    for width in widths:
        found = _on_skyline(sizes[order].tolist(), int(width))
        whole = (found + sizes[order]).max(axis=0)
        if best is None or whole.prod(dtype=np.int64) < best[1].prod(dtype=np.int64):
            best = found, whole
    places = np.empty_like(best[0])
    places[order] = best[0]
    return places, (int(best[1][0]), int(best[1][1]))


def _on_skyline(sizes, width):
    """Places (n, 2) in the order of `sizes`; the skyline is a list of [left, end, height]."""
    skyline, places = [[0, width, 0]], []
    for w, h in sizes:
        y, left = min(
            (_height_over(skyline, k, w), segment[0])
            for k, segment in enumerate(skyline)
            if segment[0] + w <= width
        )
        places.append((left, y))
        skyline = _raised(skyline, left, left + w, y + h)
    return np.array(places)


def _height_over(skyline, first, w):
    """The skyline's highest part under a rectangle of width w that begins with segment `first`."""
    end = skyline[first][0] + w
    height = 0
    for left, _, top in skyline[first:]:
        if left >= end:
            break
        height = max(height, top)
    return height


def _raised(skyline, left, end, height):
    raised = [[left, end, height]]
    for a, b, top in skyline:
        if a < left:
            raised.append([a, min(b, left), top])
        if b > end:
            raised.append([max(a, end), b, top])
    raised.sort()
    merged = raised[:1]
    for a, b, top in raised[1:]:
        if merged[-1][2] == top:
            merged[-1][1] = b
        else:
            merged.append([a, b, top])
    return merged
