"""Outlines of a flat part of a panorama: polygons in its plane that cover its pixels.

They are found in the part's own perspective picture (gnomonic, so that straight edges are straight), where
neither the seam nor the poles are special, and carried along the rays to the plane.
"""

from __future__ import annotations

import cv2
import numpy as np

from .. import equirectangular

FINENESS, MOST_CELLS = 3.0, 512
"""Cells of the perspective picture per pixel of the panorama, and along its longer side at most."""
TOLERANCES = (4.0, 2.8, 2.0, 1.4, 1.0, 0.7)
"""An outline leaves the pixels' edge by at most this much [px of the panorama]: the largest of these that is
at most ROUGHNESS of its size and changes its area by less than AREA_ERROR, so that it has few corners."""
ROUGHNESS, AREA_ERROR = 0.12, 0.03
LEAST_PART = 0.02
"""Of several outlines of one part, those with less than this of its solid angle are left out."""
LIFT = 0.002
"""Outlines stand this share of their distance in front of the surface, so that they do not lie in it."""
LEAST_COSINE = 0.05
"""Rays more grazing than this to the plane meet it no farther away: outlines stay finite."""


def outlines_of_part(part, width: int, height: int) -> tuple[np.ndarray, ...]:
    """Return the outlines, (k, 3) each [m], of a `flat_parts.Part` of a map of width × height pixels.

    At least one; holes are filled. Counter-clockwise as seen from the origin.
    """
    view = _View(part, np.pi / height)
    is_part = np.zeros(width * height, bool)
    is_part[part.pixels] = True
    uv = equirectangular.uv_from_direction(view.rays)
    pixels = np.rint(equirectangular.pixel_from_uv(uv, width, height))
    columns, rows = pixels[..., 0].astype(int) % width, pixels[..., 1].astype(int).clip(0, height - 1)
    picture = is_part[rows * width + columns].astype(np.uint8).repeat(2, axis=0).repeat(2, axis=1)
    picture = cv2.dilate(np.pad(picture, 2), np.ones((3, 3), np.uint8))  # contours join the cells' middles
    found, _ = cv2.findContours(picture, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    corners = [(_simplified(contour, 2 * view.cells_per_pixel) - 2.5) / 2 for contour in found]
    outlines = [_on_plane(view.directions(each), part) for each in corners or [view.square(part)]]
    sizes = np.array([solid_angle_of_outline(outline) for outline in outlines])
    kept = sizes >= LEAST_PART * sizes.sum()
    return tuple(outline for outline, keep in zip(outlines, kept, strict=True) if keep)


def solid_angle_of_outline(outline: np.ndarray) -> float:
    """Return the solid angle [sr] of a polygon (k, 3) seen from the origin (Van Oosterom and Strackee).

    >>> octant = np.eye(3)
    >>> round(solid_angle_of_outline(octant) / (4 * np.pi), 6)
    0.125
    """
    d = outline / np.linalg.norm(outline, axis=1, keepdims=True)
    first, second, third = d[0], d[1:-1], d[2:]
    volume = np.cross(second, third) @ first
    cosines = 1 + second @ first + np.sum(second * third, axis=1) + third @ first
    return float(abs(2 * np.arctan2(volume, cosines).sum()))


def _simplified(contour, cells_per_pixel):
    """The contour (k, 1, 2) with few corners (m, 2)."""
    area = cv2.contourArea(contour)
    for tolerance in TOLERANCES:
        cells = tolerance * cells_per_pixel
        corners = cv2.approxPolyDP(contour, cells, True)
        changed = abs(cv2.contourArea(corners) - area)
        if cells <= ROUGHNESS * np.sqrt(area) and changed <= AREA_ERROR * area:
            break
    return (corners if len(corners) >= 3 else contour)[:, 0]


class _View:
    """A perspective picture of a part: unit distance from the origin, square cells."""

    def __init__(self, part, pixel):
        middle, _ = part.plane()
        axis = middle / np.linalg.norm(middle)
        side = np.cross([0, 0, 1] if abs(axis[2]) < 0.9 else [1, 0, 0], axis)
        side /= np.linalg.norm(side)
        self.axes = np.array([side, np.cross(side, axis), axis])  # right-handed for who looks from outside
        seen = part.points @ self.axes.T
        positions = seen[:, :2] / seen[:, 2:]
        low, high = positions.min(axis=0) - pixel, positions.max(axis=0) + pixel
        self.cell = max(pixel / FINENESS, (high - low).max() / MOST_CELLS)
        self.cells_per_pixel = pixel / self.cell
        self.low = low
        columns, rows = np.ceil((high - low) / self.cell).astype(int)
        self.rays = self.directions(np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1))

    def square(self, part):
        """Corners (4, 2), in cells, of a square of a part's size, for a part between the cells."""
        half = np.sqrt(part.solid_angles.sum()) / 2
        return (np.array([[-half, -half], [half, -half], [half, half], [-half, half]]) - self.low) / self.cell

    def directions(self, cells):
        """Directions (..., 3) of cells (..., 2), whose centres lie at the integers."""
        positions = self.low + (np.asarray(cells) + 0.5) * self.cell
        return np.concatenate([positions, np.ones((*positions.shape[:-1], 1))], axis=-1) @ self.axes


def _on_plane(rays, part):
    """Where rays (k, 3) meet the plane of a part, lifted off it, counter-clockwise from the origin."""
    middle, normal = part.plane()
    lengths = np.linalg.norm(rays, axis=1)
    cosines = np.minimum(rays @ normal, -LEAST_COSINE * lengths)
    outline = rays * ((middle @ normal) / cosines)[:, None] * (1 - LIFT)
    area = sum(np.cross(a, b) for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True))
    return outline if area @ normal > 0 else outline[::-1]
