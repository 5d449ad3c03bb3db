"""The floor near the horizon, where the panorama is painted over the depth of Blender's grid.

In solid and material preview modes the grid's lines write depth, in Blender 5.2 at least, so the panorama is
not painted under them. Near the horizon they are denser than pixels and would hide it.
"""

from __future__ import annotations

import numpy as np

BEGINS = 6.0
"""Distance in eye heights, 9.5° below the horizon: from there on the grid is dense."""
ABOVE = 1.5
"""Height above the floor [px of the view]: a line's pixels lie up to half a pixel beside it."""
SEGMENTS = 64


def corners(eye, pixel: float) -> np.ndarray:
    """Triangles (6 SEGMENTS, 3) [m], in the world, of a shallow funnel around the eye (3,).

    It rises from just above the floor to the horizon, so that what stands on the floor lies before it but for
    the lowest pixels. pixel: tangent of the angle that a pixel of the view spans.

    >>> corners((1, 2, 2), 0.001)[0].round(6).tolist()
    [13.0, 2.0, 0.018]
    """
    turns = np.linspace(0, 2 * np.pi, SEGMENTS + 1)
    circle = np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    x, y, height = eye
    rise = ABOVE * pixel
    rings = []
    for distance in (BEGINS * height, height / rise):
        ring = np.full((SEGMENTS + 1, 3), rise * distance)
        ring[:, :2] = (x, y) + distance * circle
        rings.append(ring)
    inner, outer = rings
    quads = [inner[:-1], outer[:-1], outer[1:], inner[:-1], outer[1:], inner[1:]]
    return np.stack(quads, axis=1).reshape(-1, 3)


def is_hidden_by_grid(space, region_data) -> bool:
    """Whether a 3D view shows a floor grid, in perspective and from above."""
    overlay = space.overlay
    has_grid = overlay.show_overlays and overlay.show_floor
    return has_grid and region_data.is_perspective and region_data.view_matrix.inverted().translation.z > 0
