"""Depth as colours that an eye can rank, on a logarithmic scale."""

from __future__ import annotations

import cv2
import numpy as np

NO_DEPTH_COLOUR = (48, 48, 48)


def depth_colours(depth, nearest, farthest):
    """sRGB picture (H, W, 3) uint8 of depths (H, W) [m]: bright is near; grey where there is none.

    Raises ValueError unless 0 < nearest < farthest.

    >>> depth_colours(np.array([[1.0, 4.0, np.inf]]), 1.0, 4.0)[0].tolist()
    [[252, 253, 191], [0, 0, 4], [48, 48, 48]]
    """
    if not 0 < nearest < farthest:
        raise ValueError(f"depths from {nearest} m to {farthest} m; expected 0 < nearest < farthest")
    known = np.isfinite(depth)
    position = np.log(np.where(known, depth, farthest) / nearest) / np.log(farthest / nearest)
    grey = np.round(255 * (1 - np.clip(position, 0, 1))).astype(np.uint8)
    colours = cv2.cvtColor(cv2.applyColorMap(grey, cv2.COLORMAP_MAGMA), cv2.COLOR_BGR2RGB)
    colours[~known] = NO_DEPTH_COLOUR
    return colours


def ticks(nearest, farthest):
    """Round depths [m] between two, for a legend.

    >>> ticks(0.8, 5.5)
    [1, 1.5, 2, 3, 5]
    """
    decades = range(int(np.floor(np.log10(nearest))), int(np.ceil(np.log10(farthest))) + 1)
    steps = [round(step * 10.0**decade, 9) for decade in decades for step in (1, 1.5, 2, 3, 5, 7)]
    return [int(step) if step == int(step) else step for step in steps if nearest <= step <= farthest]
