"""The bright part of an RGB-D light map as a few rectangular emitters, and the residual map without it.

A path tracer finds a lamp of 10 cm on a textured emissive mesh by luck only, since it picks the mesh's
triangles by area. Each connected region of the map above a threshold therefore becomes an emitter of its own
at the depth of the map, which light sampling aims at; the map keeps what surrounds the region. Regions that
are bent, ragged or wide are split, so that a flat rectangle stands for each part.

Source: thesis section 5.7 (light comes from positions z·ω) and section 3.2 (a bright part A, a residual B).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from . import equirectangular
from .light.light_map import LUMINANCE

THRESHOLD = 4.0
"""A pixel is bright above this multiple of the map's mean luminance over the sphere."""
LEAST_SHARE = 0.002
"""Regions with less than this share of the map's power stay in the map."""
LEAST_COSINE = 0.1
"""Seen at a more grazing angle than this, a surface is taken to be no more grazing: its area stays finite."""
FLATNESS = 0.97
FILLING = 0.7
WIDTH = 0.7
"""A part is split while the mean cosine of its normals to their mean is below FLATNESS, while it covers less
than FILLING of its rectangle, or is longer than WIDTH of its distance."""
MOST_ELONGATED = 50.0
"""Longest proportion of an emitter's sides, for regions one pixel wide."""
MOST_SPLITS = 5
"""A region is halved at most this many times in a row."""
LIFT = 0.002
"""Emitters stand this share of their distance in front of the surface, so that they do not lie in it."""


@dataclass(frozen=True)
class Emitter:
    """A flat rectangle that emits constant radiance to its front, in the panorama frame."""

    position: np.ndarray
    """(3,) its middle [m]."""
    axes: np.ndarray
    """(3, 3) columns: the rectangle's first and second side and its normal (unit, right-handed)."""
    size: tuple[float, float]
    """Lengths of the two sides [m]."""
    radiance: np.ndarray
    """(3,) linear Rec. 709 radiance, above the residual map's."""
    solid_angle: float
    """Solid angle of the region it stands for [sr]."""

    @property
    def area(self) -> float:
        """[m²]."""
        return self.size[0] * self.size[1]


@dataclass(frozen=True)
class BrightPart:
    """The split of a map: ``residual`` plus the emitters is the map, region by region."""

    emitters: tuple[Emitter, ...]
    residual: np.ndarray
    """(H, W, 3) the map with every region filled by what surrounds it."""
    share: float
    """The emitters' share of the map's power, in [0, 1]."""
    threshold: float
    """Luminance above which a pixel was taken as bright."""


def split_bright_part(
    image: np.ndarray, depth: np.ndarray, threshold: float = THRESHOLD, most: int | None = None
) -> BrightPart:
    """Split an equirectangular RGB-D map into emitters at their depth and a residual map.

    Parameters: ``image`` (H, W, 3) radiance; ``depth`` (H, W) ray distance [m], +inf where there is none:
    what lies at infinity stays in the map; ``threshold`` multiple of the mean luminance; ``most`` emitters
    are taken, the strongest, or all.

    The power of every emitter's pixels is kept exactly per channel: Σ(M − surrounding)·Ω = radiance · Σ Ω;
    their irradiance at the panorama's centre too, since area = Σ Ω·z²/cos.

    Raises ValueError where the shapes differ or the threshold is not above 1.

    >>> flat = np.ones((16, 32, 3), np.float32)
    >>> split_bright_part(flat, np.full((16, 32), 2.0)).emitters
    ()
    """
    if image.shape != (*depth.shape, 3):
        raise ValueError(
            f"image has shape {image.shape} and depth {depth.shape}; expected (H, W, 3) and (H, W)"
        )
    if not threshold > 1:
        raise ValueError(f"threshold is {threshold}; expected a multiple of the mean luminance above 1")
    height, width = depth.shape
    solid_angles = np.broadcast_to(equirectangular.row_solid_angles(width, height)[:, None], depth.shape)
    luminance = image @ LUMINANCE
    power = float(np.sum(luminance * solid_angles))
    level = threshold * power / (4 * np.pi)
    parts = _bright_parts(
        image, depth, solid_angles, (luminance > level) & np.isfinite(depth), LEAST_SHARE * power
    )
    parts = sorted(parts, key=_Samples.power, reverse=True)[:most]
    residual = image.astype(np.float32, copy=True)
    for part in parts:
        residual.reshape(-1, 3)[part.pixels] -= part.excess
    share = sum(part.power() for part in parts) / power if power else 0.0
    return BrightPart(tuple(_rectangle(part) for part in parts), np.maximum(residual, 0), share, level)


def _bright_parts(image, depth, solid_angles, bright, least_power) -> list[_Samples]:
    """Flat parts of every bright region whose power above its surrounding is worth an emitter."""
    height, width = depth.shape
    points = (
        equirectangular.pixel_directions(width, height) * np.where(np.isfinite(depth), depth, 0)[..., None]
    )
    normals = _normals(points)
    labels, count = _components(bright)
    parts = []
    for label in range(1, count):
        region = labels == label
        excess = np.maximum(image[region] - _surrounding(image, region, bright), 0)
        samples = _Samples(
            np.flatnonzero(region), points[region], normals[region], excess, solid_angles[region]
        )
        if samples.power() >= least_power:
            parts += _flat_parts(samples, MOST_SPLITS)
    return parts


@dataclass(frozen=True)
class _Samples:
    """Pixels (n,) of one region, by flat index: where they lie (n, 3) [m], normals there (n, 3), radiance
    above the surrounding (n, 3), solid angles (n,) [sr]."""

    pixels: np.ndarray
    points: np.ndarray
    normals: np.ndarray
    excess: np.ndarray
    solid_angles: np.ndarray

    def __getitem__(self, chosen) -> _Samples:
        return _Samples(*(values[chosen] for values in vars(self).values()))

    def power(self) -> float:
        """Luminous power above the surrounding, as the map's: Σ L·Ω."""
        return float(self.solid_angles @ (self.excess @ LUMINANCE))

    @property
    def areas(self) -> np.ndarray:
        """Area of surface behind each pixel [m²]: Ω·z²/cos."""
        distances = np.linalg.norm(self.points, axis=1)
        cosines = np.abs(np.sum(self.points * self.normals, axis=1)) / distances
        return self.solid_angles * distances**2 / np.maximum(cosines, LEAST_COSINE)


def _normals(points: np.ndarray) -> np.ndarray:
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


def _components(mask: np.ndarray) -> tuple[np.ndarray, int]:
    """Connected regions (8 neighbours), joined across the seam: labels from 1, and their count + 1."""
    _, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    for row in np.flatnonzero(mask[:, 0]):
        for neighbour in labels[max(row - 1, 0) : row + 2, -1]:
            if neighbour:
                labels[labels == neighbour] = labels[row, 0]
    kept, labels = np.unique(labels, return_inverse=True)
    return labels.reshape(mask.shape), len(kept)


def _surrounding(image, region, bright):
    """Mean radiance (3,) of the ring of darker pixels around a region."""
    ring = _dilated(region, 3) & ~_dilated(bright, 1)
    if not ring.any():
        return np.zeros(3)
    return image[ring].mean(axis=0)


def _dilated(mask, pixels):
    """The mask grown by ``pixels``, round the seam too."""
    wrapped = np.pad(mask.astype(np.uint8), ((0, 0), (pixels, pixels)), mode="wrap")
    grown = cv2.dilate(wrapped, np.ones((2 * pixels + 1, 2 * pixels + 1), np.uint8))
    return grown[:, pixels:-pixels].astype(bool)


def _flat_parts(samples: _Samples, splits_left: int) -> list[_Samples]:
    """Halve a region, by its two main normals or along its longest side, until rectangles fit."""
    centre, axes, lengths = _frame(samples)
    flat = samples.solid_angles @ (samples.normals @ axes[:, 2]) > FLATNESS * samples.solid_angles.sum()
    filled = samples.areas.sum() > FILLING * lengths[0] * lengths[1]
    if splits_left == 0 or (flat and filled and lengths[0] < WIDTH * np.linalg.norm(centre)):
        return [samples]
    first = (samples.points - centre) @ axes[:, 0] < 0 if flat else _nearer_first_normal(samples, axes[:, 2])
    if first.all() or not first.any():
        return [samples]
    return _flat_parts(samples[first], splits_left - 1) + _flat_parts(samples[~first], splits_left - 1)


def _nearer_first_normal(samples: _Samples, mean_normal: np.ndarray) -> np.ndarray:
    """Which samples (n,) belong to the one of the two most different normals."""
    one = samples.normals[np.argmin(samples.normals @ mean_normal)]
    other = samples.normals[np.argmin(samples.normals @ one)]
    return samples.normals @ one > samples.normals @ other


def _frame(samples: _Samples):
    """Middle (3,), axes (3, 3) as columns (long side, other side, normal), lengths (2,) of equal spread."""
    areas = samples.areas
    centre = areas @ samples.points / areas.sum()
    normal = samples.solid_angles @ samples.normals
    normal /= np.linalg.norm(normal)
    side = np.cross([0, 0, 1] if abs(normal[2]) < 0.9 else [1, 0, 0], normal)
    plane = np.column_stack([side, np.cross(normal, side)]) / np.linalg.norm(side)
    offsets = (samples.points - centre) @ plane
    variances, turn = np.linalg.eigh((offsets * areas[:, None]).T @ offsets / areas.sum())
    first = plane @ turn[:, 1]
    return (
        centre,
        np.column_stack([first, np.cross(normal, first), normal]),
        np.sqrt(12 * np.abs(variances[::-1])),
    )


def _rectangle(samples: _Samples) -> Emitter:
    """The rectangle with the middle, orientation, proportions, area and power of a flat region."""
    centre, axes, lengths = _frame(samples)
    area = samples.areas.sum()
    proportion = min(lengths[0] / lengths[1], MOST_ELONGATED) if lengths[1] > 0 else 1.0
    size = (float(np.sqrt(area * proportion)), float(np.sqrt(area / proportion)))
    radiance = samples.solid_angles @ samples.excess / samples.solid_angles.sum()
    position = centre + axes[:, 2] * LIFT * np.linalg.norm(centre)
    return Emitter(position, axes, size, radiance, float(samples.solid_angles.sum()))
