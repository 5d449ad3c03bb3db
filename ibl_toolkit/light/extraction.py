"""Few lights for the bright part of a map and a quiet map for the rest; or lights for all of it.

Source: thesis, section 3.2: the hybrid scheme, M = M_A + M_B.
"""

from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from . import choice
from .clustering import clusterings
from .extraction_warnings import warnings_of
from .importance import importance_sampling
from .light_map import LUMINANCE, check_count, check_light_map, irradiance
from .median_cut import median_cut, variance_cut
from .penrose import penrose_sampling
from .positions import check_depth, mean_directions, positions_at_depth
from .samples import LightSamples, combined, samples_from_partition, samples_from_sites
from .split import split

WHOLE_MAP = {
    "median-cut": median_cut,
    "variance": variance_cut,
    "penrose": penrose_sampling,
    "importance": importance_sampling,
}
"""Samplers of the whole map."""
METHODS = ("hybrid", *WHOLE_MAP)
WHOLE_MAP_LIGHTS = 64
"""Lights of the whole map where no number is given: those of Fig. 3-9c."""
BRIGHT_SAMPLES = 1024
"""The bright part is sampled so finely before its samples are clustered; a smaller one by its pixels."""
LEAST_LIGHT = 0.005
"""Where the map chooses the number, a light with less of the bright part's light is left to the residual."""


@dataclass(frozen=True)
class Extraction:
    """Lights and residual of a map: Σ irradiance + ∫ residual = ∫ map, per channel within 1e-6."""

    samples: LightSamples
    """The lights, the strongest first; may be none. Their partition is the bright part."""
    residual: np.ndarray
    """(H, W, 3) float32: the map, black where the lights' regions are."""
    method: str
    threshold: float | None
    """Share p at which the map was split; None where the whole map became lights."""
    share: float
    """What the lights carry of the map's light, in [0, 1]."""
    reason: str
    """One sentence for the artist: what was chosen, and why."""
    warnings: tuple[str, ...] = ()
    positions: np.ndarray | None = None
    """(n, 3) [m] in the panorama frame, NaN for a light without depth; None for a map without."""


def extract_lights(image, method="hybrid", count=None, threshold=None, depth=None) -> Extraction:
    """Make lights of a map (H, W, 3) of radiance.

    method: "hybrid" makes lights of the bright part alone (section 3.2): split, sampled by Penrose tiles,
    clustered with F2 to `count`, each light the Voronoi cell of its cluster within the bright part. All
    others sample the whole map and leave nothing. Every light lies in the middle of its region's light.

    count: None lets the map choose, which may be none at all; a smaller bright part gives fewer. threshold:
    share p of the light for the bright part, None for the two-trapezoid rule. depth: (H, W) along the ray
    [m], +inf for none; the lights get positions.

    Raises: ValueError for another method, a threshold outside (0, 1) or with another method than hybrid, a
    count below 0 (1 for the others), a depth of another shape, and what `check_light_map` refuses.

    >>> image = np.full((32, 64, 3), 0.01, np.float32)
    >>> image[5, 10:12] = image[8, 40:42] = 500
    >>> extract_lights(image).reason
    'the brightest 0.2 % of the sphere hold 99 % of the light: 2 lights'
    """
    image = check_light_map(image)
    if method not in METHODS:
        raise ValueError(f"method is {method!r}: must be one of {', '.join(METHODS)}")
    if method != "hybrid" and threshold is not None:
        raise ValueError(f"threshold is {threshold}: only the method hybrid splits the map, not {method}")
    if count is not None and not (count == 0 and method == "hybrid"):
        count = check_count(count)
    if depth is not None:
        depth = check_depth(depth, image)
    if method == "hybrid":
        samples, threshold, reason = _bright_lights(image, count, threshold, depth)
    else:
        samples = WHOLE_MAP[method](image, count or WHOLE_MAP_LIGHTS)
        reason = f"the whole map as {len(samples)} light{'s' if len(samples) > 1 else ''}, by {method}"
    samples = _centred(image, samples)
    residual = image.copy()
    residual[samples.partition >= 0] = 0
    share = float(samples.luminance.sum() / _light(image))
    positions = None if depth is None else positions_at_depth(image, samples, depth)
    warnings = warnings_of(image, samples, positions)
    return Extraction(samples, residual, method, threshold, share, reason, warnings, positions)


def _bright_lights(image, count, threshold, depth):
    """Lights of the bright part, its share p, and the reason."""
    bright = split(image, threshold)
    is_known = np.isfinite(depth[bright.mask]) if depth is not None else np.zeros(1, bool)
    at_depth = 2 * np.count_nonzero(is_known) > is_known.size
    by_hand = count is not None or threshold is not None
    if count == 0 or not bright.share or not (by_hand or choice.is_worth_it(image, bright, at_depth)):
        return _none(bright.mask.shape), bright.share, choice.reason(bright, 0, count)
    many = _bright_samples(image, bright.mask)
    directions = next(clusterings(many, count))[1] if count else choice.fewest_lights(many)
    samples = samples_from_sites(image, directions, bright.mask)
    if count is None:
        kept = samples.luminance >= LEAST_LIGHT * samples.luminance.sum()
        samples = combined(samples, np.where(kept, np.cumsum(kept) - 1, -1), samples.directions[kept])
    return samples, bright.share, choice.reason(bright, len(samples), count)


def _bright_samples(image, mask):
    """Samples of the bright part: each of its pixels if these are few, or Penrose points."""
    if np.count_nonzero(mask) > BRIGHT_SAMPLES:
        return penrose_sampling(image, BRIGHT_SAMPLES, mask)
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    partition = np.full(mask.shape, -1, np.int32)
    partition[rows, columns] = np.arange(len(rows))
    uv = equirectangular.uv_from_pixel(np.stack([columns, rows], axis=1), width, height)
    return samples_from_partition(image, uv, partition)


def _centred(image, samples):
    """The samples, the strongest first, each in the middle of its region's light."""
    if not len(samples):
        return samples
    order = np.argsort(-samples.luminance, kind="stable")
    return combined(samples, np.argsort(order), mean_directions(image, samples)[order])


def _none(shape):
    """No samples at all."""
    partition = np.full(shape, -1, np.int32)
    return LightSamples(np.empty((0, 2)), np.empty((0, 3)), np.empty((0, 3)), np.empty(0), partition)


def _light(image):
    return LUMINANCE @ irradiance(image)
