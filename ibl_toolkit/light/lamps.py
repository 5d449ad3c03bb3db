"""The lamps of an RGB-D map as flat outlines at their depth, and the quiet map without them.

A path tracer finds a lamp of 10 cm on a textured emissive mesh by luck only, since it picks the mesh's
triangles by area. Each bright region therefore becomes a polygon of its own, with the region's position,
orientation, size and shape, which the renderer aims at. A region that is bent over an edge, or reaches from
one surface to another, is cut into flat parts.

Source: thesis, section 3.2 (a bright part A, a residual B) and 5.7 (light comes from positions z·ω).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from .flat_parts import Part, flat_parts, surface_normals
from .light_map import check_light_map, luminance
from .outline import outlines_of_part, solid_angle_of_outline
from .quiet import noise, quiet_map
from .regions import connected_regions

BRIGHT = 2.0
"""A pixel is bright above this multiple of the map's mean luminance over the sphere."""
LEAST_SHARE = 0.0005
"""A flat part with less of the map's light stays in the quiet map, which spreads it."""
MOST = 64
"""No more lamps than this, the strongest."""


@dataclass(frozen=True)
class Lamp:
    """A flat lamp of constant radiance, in the panorama frame."""

    outlines: tuple[np.ndarray, ...]
    """Polygons (k, 3) [m] in one plane, counter-clockwise as seen from the origin."""
    radiance: np.ndarray
    """(3,) RGB: what its pixels send to the origin, over the outlines' solid angle."""
    pixels: np.ndarray
    """(n,) flat indices of the pixels whose light it carries."""


@dataclass(frozen=True)
class LampSplit:
    """The lamps of a map, and what remains."""

    lamps: tuple[Lamp, ...]
    quiet: np.ndarray
    """(h, w, 3) the residual, of low resolution."""
    share: float
    """The lamps' share of the map's light, in [0, 1]."""
    noise: float
    """Of the quiet map (`quiet.noise`)."""


def split_into_lamps(image: np.ndarray, depth: np.ndarray, most: int | None = None) -> LampSplit:
    """Split an equirectangular RGB-D map into lamps at their depth and a quiet map.

    Parameters: ``image`` (H, W, 3) radiance; ``depth`` (H, W) ray distance [m], +inf where there is none:
    what lies at infinity stays in the map; ``most`` lamps are taken, the strongest, at most and by default
    MOST.

    A lamp sends to the origin what its pixels do, per channel within rounding: radiance · Ω = Σ M·Ω.

    Raises ValueError where the shapes differ, and for what `check_light_map` refuses.

    >>> flat = np.ones((16, 32, 3), np.float32)
    >>> split_into_lamps(flat, np.full((16, 32), 2.0)).lamps
    ()
    """
    image = check_light_map(image)
    if depth.shape != image.shape[:2]:
        raise ValueError(f"depth has shape {depth.shape}; expected the light map's {image.shape[:2]}")
    height, width = depth.shape
    solid_angles = np.repeat(equirectangular.row_solid_angles(width, height), width)
    power = luminance(image).ravel() * solid_angles
    bright = luminance(image) > BRIGHT * power.sum() / (4 * np.pi)
    parts = _strongest_parts(bright & np.isfinite(depth), depth, power, solid_angles)
    parts = parts[: MOST if most is None else min(most, MOST)]
    lamps = [_lamp(part, image, solid_angles) for part in parts]
    taken = np.zeros(depth.size, bool)
    for lamp in lamps:
        taken[lamp.pixels] = True
    quiet = quiet_map(image, taken.reshape(depth.shape), behind_lamps=True)
    return LampSplit(tuple(lamps), quiet, float(power[taken].sum() / power.sum()), noise(quiet, image))


def _strongest_parts(bright, depth, power, solid_angles):
    """Flat parts of the bright regions that are worth a lamp, the strongest first."""
    if not bright.any():
        return []
    height, width = depth.shape
    directions = equirectangular.pixel_directions(width, height)
    points = directions * np.where(np.isfinite(depth), depth, 0)[..., None]
    normals = surface_normals(points).reshape(-1, 3)
    points = points.reshape(-1, 3)
    parts = []
    for region in connected_regions(bright):
        if power[region].sum() >= LEAST_SHARE * power.sum():
            parts += flat_parts(Part(region, points[region], normals[region], solid_angles[region]))
    parts = [part for part in parts if power[part.pixels].sum() >= LEAST_SHARE * power.sum()]
    return sorted(parts, key=lambda part: -power[part.pixels].sum())


def _lamp(part, image, solid_angles):
    """The lamp of one flat part."""
    outlines = outlines_of_part(part, image.shape[1], image.shape[0])
    light = solid_angles[part.pixels] @ image.reshape(-1, 3)[part.pixels].astype(float)
    return Lamp(outlines, light / sum(map(solid_angle_of_outline, outlines)), part.pixels)
