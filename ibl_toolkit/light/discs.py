"""The lamps of a map at infinity as discs: few sun lights that light as the lamps do, and a quiet map.

A sun light is a disc of constant radiance. Each bright region becomes one, with the region's vector
irradiance and second moment. Where that leaves a map so quiet that the renderer need not aim at it any more,
all its aiming goes to the suns; elsewhere its own sampling of the map is as good or better, and the map is
best left alone.

Source: thesis, section 3.2 (hybrid scheme); the criterion was found by measurement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from .light_map import check_light_map, luminance
from .quiet import noise, quiet_map
from .regions import connected_regions

BRIGHT = 4.0
"""A pixel is bright above this multiple of the map's mean luminance over the sphere."""
LEAST_SHARE = 0.004
"""A lamp with less of the map's light stays in the quiet map."""
ROUND = 0.3
"""A region whose spread across is less than this share of that along is halved."""
WIDEST = 0.35
"""Radius of the widest disc [rad]: a wider lamp is halved."""
QUIET = 0.35
"""Noise of the residual up to which the renderer gains by the lights (`quiet.noise`)."""
MOST = 32
"""No map needs more; further lamps stay in the quiet map."""
_PIXEL_SPREAD = 0.29
"""Standard deviation of a pixel's own extent [px], 1/√12."""


@dataclass(frozen=True)
class Disc:
    """A disc of constant radiance at infinity, in the panorama frame."""

    direction: np.ndarray
    """(3,) unit vector to its middle."""
    radius: float
    """[rad]"""
    irradiance: np.ndarray
    """(3,) RGB on a plane that faces it: ∫ M ω·direction dω over its lamp's pixels."""
    pixels: np.ndarray
    """(n,) flat indices of the pixels whose light it carries."""


@dataclass(frozen=True)
class DiscSplit:
    """The discs of a map, and what remains."""

    discs: tuple[Disc, ...]
    residual: np.ndarray
    """(H, W, 3) the map, black where the discs' pixels are."""
    quiet: np.ndarray
    """(h, w, 3) the residual, of low resolution."""
    share: float
    """The discs' share of the map's light, in [0, 1]."""
    noise: float
    """Of the quiet map."""

    @property
    def helps(self) -> bool:
        """Whether a renderer is faster with the discs than with its own sampling of the map."""
        return bool(self.discs) and self.noise <= QUIET


def split_into_discs(image: np.ndarray, most: int = MOST) -> DiscSplit:
    """Split a light map (H, W, 3) into at most ``most`` discs, the strongest, and a quiet map.

    The discs' irradiance and the quiet map's together light a diffuse plane as the map does, wherever all of
    a disc is above the plane's horizon. Raises ValueError for what `check_light_map` refuses.

    >>> image = np.full((64, 128, 3), 0.01, np.float32)
    >>> image[20:24, 40:48] = 100
    >>> found = split_into_discs(image)
    >>> len(found.discs), found.helps
    (1, True)
    """
    sphere = _Sphere(check_light_map(image))
    bright = sphere.luminance > BRIGHT * sphere.power.sum() / (4 * np.pi)
    regions = connected_regions(bright.reshape(image.shape[:2]))
    waiting = [region for region in regions if sphere.share(region) >= LEAST_SHARE]
    discs = []
    while waiting:
        waiting.sort(key=sphere.share)
        region = waiting.pop()
        parts = _halves(sphere, region)
        if parts is None:
            discs.append(_disc(sphere, region))
        else:
            waiting += [part for part in parts if sphere.share(part) >= LEAST_SHARE]
    discs = sorted(discs, key=lambda disc: -sphere.share(disc.pixels))[:most]
    taken = np.zeros(sphere.power.shape, bool)
    for disc in discs:
        taken[disc.pixels] = True
    lamps = taken.reshape(image.shape[:2])
    residual = np.where(lamps[..., None], 0, image)
    quiet = quiet_map(image, lamps, behind_lamps=False)
    share = float(sphere.power[taken].sum() / sphere.power.sum())
    return DiscSplit(tuple(discs), residual, quiet, share, noise(quiet, image))


def disc_of_region(image: np.ndarray, pixels: np.ndarray) -> Disc:
    """Return the disc with the light of some pixels (n,), flat indices, of a light map (H, W, 3)."""
    return _disc(_Sphere(check_light_map(image)), pixels)


class _Sphere:
    """A map's pixels (n,) on the sphere: radiance, directions, solid angles, luminous power."""

    def __init__(self, image):
        self.height, width = image.shape[:2]
        self.radiance = image.reshape(-1, 3)
        self.directions = equirectangular.pixel_directions(width, self.height).reshape(-1, 3)
        self.solid_angles = np.repeat(equirectangular.row_solid_angles(width, self.height), width)
        self.luminance = luminance(image).ravel()
        self.power = self.luminance * self.solid_angles
        self._total = self.power.sum()

    def share(self, pixels):
        """Of the map's light that pixels hold."""
        return self.power[pixels].sum() / self._total

    def middle(self, pixels):
        """Unit vector to the middle of the pixels' light."""
        direction = self.power[pixels] @ self.directions[pixels]
        return direction / np.linalg.norm(direction)

    def pixel_variance(self):
        """Mean square extent of one pixel along one axis [rad²]."""
        return (_PIXEL_SPREAD * np.pi / self.height) ** 2


def _halves(sphere, region):
    """A long or wide region cut across its longer axis, half of the light each; None for a round one."""
    middle, weights = sphere.middle(region), sphere.power[region]
    directions = sphere.directions[region].astype(float)
    offsets = directions - np.outer(directions @ middle, middle)
    variances, axes = np.linalg.eigh((offsets * weights[:, None]).T @ offsets / weights.sum())
    across, along = np.sqrt(variances[1:] + sphere.pixel_variance())
    if across >= ROUND * along and np.hypot(across, along) * np.sqrt(2) < WIDEST:
        return None
    positions = offsets @ axes[:, 2]
    order = np.argsort(positions)
    light = np.cumsum(weights[order])
    first = positions <= positions[order[np.searchsorted(light, light[-1] / 2)]]
    return None if first.all() else (region[first], region[~first])


def _disc(sphere, region):
    """The disc with a region's middle, vector irradiance and second moment."""
    middle, weights = sphere.middle(region), sphere.power[region]
    directions = sphere.directions[region].astype(float)
    moment = weights @ _squared_angles(directions, middle) / weights.sum()
    radius = np.sqrt(2 * moment + 4 * sphere.pixel_variance())
    weights = sphere.solid_angles[region] * (directions @ middle)
    return Disc(middle, float(radius), weights @ sphere.radiance[region].astype(float), region)


def _squared_angles(directions, middle):
    """Squared distances (n,) of unit vectors from one, which for small angles are their squared angles."""
    return 2 * (1 - np.clip(directions @ middle, -1, 1))
