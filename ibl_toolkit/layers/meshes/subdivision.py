"""Where the quadtree of a layer is split: at the rim of its domain, at creases, and where it bends.

Source: thesis, section 7.4.2.6, Alg. 16.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from .normals import normal_variation, normals_from_depth
from .quadtree import balanced, build_quadtree, without_strips
from .summed_area import rectangle_sums, summed_area_table


@dataclass(frozen=True)
class Subdivision:
    """When a cell is split.

    feature_deg: the angle [degrees] between the normals of neighbouring pixels from which on there is a
    crease (theta of eq. 7.18); cells with a crease in them are split down to pixels.
    turn_deg: the angle [degrees] by which the normals of a cell may turn in all. Alg. 16 compares the *mean*
    of V_R with a threshold. Of an evenly curved surface that mean is the same for a cell of any size: it is
    split into pixels or not at all, and differently at each resolution. V_R grows with the square of the
    angle between pixels, so its *sum* over a cell of n x n pixels is about 1 - cos(n times that angle): that
    is what is compared with 1 - cos(turn_deg).

    Cells are also split to a sixteenth of an equirectangular map's width, or a quarter of a cube's face (22.5
    degrees): triangles that are too large distort textures, see 7.4.3.
    """

    feature_deg: float = 10.0
    turn_deg: float = 10.0

    def __post_init__(self):
        for name in ("feature_deg", "turn_deg"):
            if not 0 < getattr(self, name) <= 180:
                raise ValueError(f"{name} is {getattr(self, name)}, must be above 0 and at most 180 degrees")


def layer_quadtree(corners, depth, inside, subdivision):
    """The balanced quadtree of a layer: each leaf lies in its domain or outside of it, none across its rim.

    depth, inside: sheets of the map of ``corners``. Leaves one pixel wide or high are single pixels.
    """
    variation = normal_variation(corners, normals_from_depth(corners, depth, inside), inside)
    features, residual = features_and_residual(variation, subdivision.feature_deg)
    domain_table = summed_area_table(inside)
    whole = summed_area_table(features | border(corners, inside))
    residual_table = summed_area_table(residual)
    largest = max(1, inside.shape[2] // (16 if corners.wraps else 4))

    def must_split(cells):
        rectangles = (cells.x0, cells.y0, cells.x1, cells.y1, cells.sheet)
        bends = rectangle_sums(residual_table, *rectangles) >= 1 - np.cos(np.radians(subdivision.turn_deg))
        large = np.maximum(cells.x1 - cells.x0, cells.y1 - cells.y0) > largest
        split = (rectangle_sums(whole, *rectangles) > 0) | bends | large
        return split & (rectangle_sums(domain_table, *rectangles) > 0)

    tree = build_quadtree(*_sizes(inside), must_split)
    return without_strips(balanced(tree, inside, corners.wraps))


def border(corners, inside):
    """B: pixels of the domain that have one of their eight neighbours outside of it (eq. 7.8).

    Beyond the rim of a sheet it is the one neighbour across it that counts.
    """
    found = np.stack([sheet & (_eroded(sheet) == 0) for sheet in inside])
    for rim, beyond in corners.rims:
        found[rim] |= inside[rim] & ~inside[beyond]
    return found


def features_and_residual(variation, feature_deg):
    """F, boolean, and V_R (eq. 7.16-7.18): where V_N reaches 1 - cos(feature_deg), and V_N elsewhere."""
    features = variation >= 1 - np.cos(np.radians(feature_deg))
    return features, np.where(features, variation.dtype.type(0), variation)


def _eroded(sheet):
    # The default border value of cv2.erode does not erode: what lies beyond the sheet is not outside.
    return cv2.erode(sheet.astype(np.uint8), np.ones((3, 3), np.uint8))


def _sizes(inside):
    sheets, rows, columns = inside.shape
    return sheets, columns, rows
