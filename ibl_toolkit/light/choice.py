"""Whether lights are worth it for a map, and how many: the default that chooses by itself, and says why."""

import numpy as np

from .clustering import clusterings
from .discs import QUIET
from .quiet import noise, quiet_map

LEAST_SHARE = 0.05
"""A bright part at depth with less of the map's light stays in the map."""
LEAST_CONCENTRATION = 8.0
"""The bright part is this many times as bright as the mean of the sphere, or it does not stand out."""
MOST_LIGHTS = 32
"""The default takes no more: each costs the renderer a choice."""
SPREAD = np.radians(2.0)
"""Root mean square angle that light may lie off its lamp, beyond what a disc of the region's size has [rad]:
shadows are wrong by as much."""
WIDEST = np.radians(15)
"""Radius up to which a disc is one light without error [rad]."""


def is_worth_it(image, bright, at_depth):
    """Whether the bright part of a map (H, W, 3), a `Split`, is to become lights.

    A lamp at depth is worth a light of its own: a renderer samples an emissive mesh by area, not by what it
    shows. A map at infinity it samples by what it shows already, and gains only where the lights leave a map
    so quiet that it need not be sampled at all.
    """
    if at_depth:
        return bright.share >= LEAST_SHARE and _stands_out(bright)
    residual = quiet_map(image, bright.mask, behind_lamps=False)
    return _stands_out(bright) and noise(residual, image) <= QUIET


def _stands_out(bright):
    return bright.share >= LEAST_CONCENTRATION * bright.area


def fewest_lights(samples):
    """The fewest clusters of LightSamples, up to MOST_LIGHTS, whose regions are about as compact as discs.

    A region's spread is the mean square angle of its light from its middle, that inside its samples taken for
    a disc's, Ω/2π. What a disc of the whole region would have is not counted, up to WIDEST: a sun light is
    one. The mean of the rest, weighted by power, must be at most SPREAD².

    -> directions (n, 3).

    >>> from .samples import samples_from_sites
    >>> image = np.zeros((64, 128, 3), np.float32)
    >>> image[20:22, 30:32] = image[20:22, 90:92] = 100
    >>> len(fewest_lights(samples_from_sites(image, [[1, 0, 1], [0, 1, 1], [0, -1, 1]], image[..., 0] > 0)))
    2
    """
    chosen = None
    for groups, directions in clusterings(samples, MOST_LIGHTS):
        if chosen is None or _spread(samples, groups, directions) <= SPREAD**2:
            chosen = directions
    return chosen


def _spread(samples, groups, directions):
    """Mean over the light of a clustering's mean square angles beyond those of discs [rad²]."""
    power = samples.luminance
    cosines = np.einsum("nk,nk->n", samples.directions, directions[groups])
    angles = np.arccos(np.clip(cosines, -1, 1))
    count = len(directions)
    moments = np.bincount(groups, power * (angles**2 + samples.solid_angles / (2 * np.pi)), count)
    powers = np.bincount(groups, power, count)
    discs = np.minimum(np.bincount(groups, samples.solid_angles, count) / (2 * np.pi), WIDEST**2 / 2)
    return float(np.maximum(moments - powers * discs, 0).sum() / powers.sum())


def reason(bright, count, asked=None):
    """One sentence on what was chosen for a `Split` and why.

    >>> from .split import Split
    >>> reason(Split(np.zeros((2, 4), bool), 0.61, 1.0, 0.15), 9)
    'the brightest 1.2 % of the sphere hold 61 % of the light: 9 lights'
    """
    if not bright.share:
        return "every part of this map is as bright as the others: left alone"
    found = f"the brightest {percent(bright.area)} of the sphere hold {percent(bright.share)} of the light"
    if asked == 0:
        return f"{found}: no lights, as asked"
    if not count and _stands_out(bright):
        return f"{found}, and the rest is not quiet: left alone"
    if not count:
        return f"no part of this map stands out ({found}): left alone"
    lights = f"{count} light{'s' if count > 1 else ''}"
    if asked is None:
        return f"{found}: {lights}"
    return f"{found}: {lights}, {'as asked' if count == asked else f'for it has no room for {asked}'}"


def percent(part):
    """A part of 1 in per cent, two digits or the whole number.

    >>> percent(0.00021), percent(0.0539), percent(0.944)
    ('0.021 %', '5.4 %', '94 %')
    """
    return f"{100 * part:.0f} %" if part >= 0.1 else f"{100 * part:.2g} %"
