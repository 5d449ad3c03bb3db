"""Percentage-closer filtering: the mean of many comparisons (eq. 1), the kernel k being a box.

Source: W. Reeves, D. Salesin and R. Cook, "Rendering antialiased shadows with depth maps", SIGGRAPH 1987.
With a window of 1 it is what GL_LINEAR does to a depth texture with comparison.
"""

from .hard import texels
from .lookup import box
from .storage import unpacked

__all__ = ["texels", "visibility"]


def visibility(shadow_map, texture):
    """Of places (n, 3), s, t, r: the part of the window in which r ≤ the depth that is stored."""
    settings = shadow_map.settings
    return sum(
        weight * (texture[:, 2] <= unpacked(shadow_map.texels[row, column], settings.storage)[:, 0])
        for row, column, weight in box(settings.resolution, texture[:, :2], settings.window)
    )
