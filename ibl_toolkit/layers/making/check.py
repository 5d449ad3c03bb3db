"""What makers of layers have to hold: each is continuous in depth, and together they cover the sphere.

Source: thesis, section 6.2, eq. 6.9 (the domains cover the sphere) and 6.10 (depth is continuous in each).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import LayeredPanorama
from .discontinuities import TOLERANCE_PX, cuts, nearness
from .grid import PixelGrid, grid_of

_BLOCK = 1 << 18


@dataclass(frozen=True)
class LayersReport:
    """What `check_layers` found.

    jumps: by layer name, the pairs of neighbouring pixels of its domain between which depth jumps.
    uncovered: share of the sphere that no layer's domain covers, 0 to 1. first_uncovered: a unit direction
    (3,) there, panorama frame, or None. within: share of the sphere on which something is nearer than the
    panorama's radius.
    """

    jumps: dict[str, int]
    uncovered: float
    first_uncovered: np.ndarray | None
    within: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether no depth jumps, and all is covered."""
        return self.uncovered == 0 and not any(self.jumps.values())

    @property
    def warnings(self) -> tuple[str, ...]:
        """A line for each thing that is not as it should be."""
        lines = [
            f"layer '{name}': depth jumps between {count} pairs of neighbouring pixels, must between none: "
            "views by grid and quadtree will join what is apart"
            for name, count in self.jumps.items()
            if count
        ]
        if self.uncovered:
            where = ", ".join(f"{x:.3f}" for x in self.first_uncovered)
            lines.append(
                f"{100 * self.uncovered:.3g} % of the sphere are in no layer's domain, must be none: the "
                f"first at direction ({where})"
            )
        if self.within:
            lines.append(
                f"{100 * self.within:.3g} % of the sphere show what is nearer than the radius: views from "
                "beside it or behind will have holes"
            )
        return tuple(lines)


def check_layers(panorama: LayeredPanorama, tolerance_px: float = TOLERANCE_PX) -> LayersReport:
    """Count where depth jumps within layers, as `discontinuities.cuts` has it, and what no layer covers.

    Whether depth jumps depends on the panorama's radius: with a radius of 0 there is no parallax, and no
    jump. Coverage is looked up at the pixel centres of the layer with the most pixels.

    >>> from ..panorama import Layer
    >>> depth = np.where(np.arange(8) < 3, np.nan, 2.0) * np.ones((4, 1))
    >>> layer = Layer("part", "equirectangular", {"depth": depth})
    >>> report = check_layers(LayeredPanorama((layer,), np.eye(3), np.zeros(3), 0.5))
    >>> report.jumps, round(report.uncovered, 6)
    ({'part': 0}, 0.375)
    """
    jumps = {layer.name: _jumps(layer, panorama.radius, tolerance_px) for layer in panorama.layers}
    grid = max((grid_of(layer) for layer in panorama.layers), key=lambda grid: grid.size)
    left = ~_looked_up(grid, panorama.layers, lambda layer: layer.mask)
    within = _looked_up(grid, panorama.layers, lambda layer: layer.mask & (layer.depth < panorama.radius))
    first = grid.directions[np.argmax(left)] if left.any() else None
    return LayersReport(jumps, _share(grid, left), first, _share(grid, within))


def _jumps(layer, radius, tolerance_px):
    grid = grid_of(layer)
    near = grid.flat(np.where(layer.mask, nearness(layer.depth), np.float32(np.nan)))
    pixel, other = grid.pairs(cuts(grid, near, radius, tolerance_px))
    return int(np.count_nonzero(pixel < other))


def _looked_up(grid, layers, pixels_of):
    """Whether each pixel (size,) of a grid is, in any of the layers, one of `pixels_of(layer)` (H, W)."""
    found = np.zeros(grid.size, dtype=bool)
    for layer in layers:
        own = grid_of(layer)
        mask = own.flat(pixels_of(layer))
        if (own.mapping, own.size) == (grid.mapping, grid.size):
            found |= mask
            continue
        pixels = np.flatnonzero(~found) if mask.any() else ()
        for start in range(0, len(pixels), _BLOCK):
            block = pixels[start : start + _BLOCK]
            found[block] = mask[own.at(grid.directions[block])]
    return found


def _share(grid, pixels):
    """What share of the sphere pixels (size,) cover."""
    if not pixels.any():
        return 0.0
    angles = _solid_angles(grid)
    return float(angles[pixels].sum() / angles.sum())


def _solid_angles(grid: PixelGrid):
    if grid.is_cube:
        return grid.flat(cube_map.solid_angles(grid.sheet_shape[1]))
    return np.repeat(equirectangular.row_solid_angles(grid.width, grid.height), grid.width)
