"""A region of a depth map cut into parts that lie in one plane each and are not wide for their distance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FLATNESS = 0.97
"""A part is cut by its normals while their mean cosine to their mean is below this."""
THICKNESS = 0.03
"""A part is cut by its distance from its plane while that reaches this share of its distance."""
PLANAR = 0.02
"""Points tell their plane where their variance across it is less than this share of the least along it."""
LEAST_NORMAL = 1e-3
"""Where the normals cancel out, a part faces the origin."""
WIDTH = 1.2
"""A part is halved while it is longer than this multiple of its distance."""
MOST_CUTS = 6
"""A region is cut at most this many times in a row."""


@dataclass(frozen=True)
class Part:
    """Pixels (n,) by flat index: where they lie (n, 3) [m], normals there (n, 3), solid angles (n,) [sr]."""

    pixels: np.ndarray
    points: np.ndarray
    normals: np.ndarray
    solid_angles: np.ndarray

    def __getitem__(self, chosen) -> Part:
        return Part(*(values[chosen] for values in vars(self).values()))

    def plane(self):
        """Middle (3,) and unit normal (3,), towards the origin, of the plane in which the pixels lie.

        Fitted to the points where these tell it, else the mean of their normals.
        """
        weights = self.solid_angles / self.solid_angles.sum()
        middle = weights @ self.points
        offsets = self.points - middle
        variances, axes = np.linalg.eigh((offsets * weights[:, None]).T @ offsets)
        normal = weights @ self.normals
        if variances[0] < PLANAR * variances[1]:
            normal = axes[:, 0] * (1 if axes[:, 0] @ middle < 0 else -1)
        elif np.linalg.norm(normal) < LEAST_NORMAL:
            normal = -middle
        return middle, normal / np.linalg.norm(normal)


def surface_normals(points: np.ndarray) -> np.ndarray:
    """Unit normals (H, W, 3) of a map of points, towards the origin, from each side's nearer neighbour."""
    distances = np.linalg.norm(points, axis=2)

    def step(axis):
        forward = np.roll(points, -1, axis) - points
        backward = points - np.roll(points, 1, axis)
        nearer = np.abs(np.roll(distances, -1, axis) - distances) < np.abs(
            distances - np.roll(distances, 1, axis)
        )
        return np.where(nearer[..., None], forward, backward)

    normals = np.cross(step(1), step(0))
    normals *= -np.sign(np.sum(normals * points, axis=2, keepdims=True))
    return normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-30)


def flat_parts(part: Part, cuts_left: int = MOST_CUTS) -> list[Part]:
    """Cut a part by its two main normals, by its distances from its plane, or across, until all are flat."""
    first = _first_piece(part) if cuts_left else None
    if first is None or first.all() or not first.any():
        return [part]
    return flat_parts(part[first], cuts_left - 1) + flat_parts(part[~first], cuts_left - 1)


def _first_piece(part):
    """Which pixels (n,) to cut off; None where the whole is flat and narrow."""
    middle, normal = part.plane()
    weights = part.solid_angles / part.solid_angles.sum()
    if weights @ (part.normals @ normal) < FLATNESS:
        return _nearer_first_normal(part, normal)
    offsets = part.points - middle
    heights = offsets @ normal
    distance = np.linalg.norm(middle)
    if np.ptp(heights) > THICKNESS * distance:
        return heights < _widest_gap(heights)
    variances, axes = np.linalg.eigh((offsets * weights[:, None]).T @ offsets)
    if np.sqrt(12 * max(variances[-1], 0)) > WIDTH * distance:
        return offsets @ axes[:, -1] < 0
    return None


def _nearer_first_normal(part, mean_normal):
    """Which pixels (n,) belong to the one of the two most different normals."""
    one = part.normals[np.argmin(part.normals @ mean_normal)]
    other = part.normals[np.argmin(part.normals @ one)]
    return part.normals @ one > part.normals @ other


def _widest_gap(values):
    """The middle of the widest gap between values (n,)."""
    ordered = np.sort(values)
    at = np.argmax(np.diff(ordered))
    return (ordered[at] + ordered[at + 1]) / 2
