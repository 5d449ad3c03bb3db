"""Bright parts of what a ball shows: 4-connected, ordered by size; and the lights that a mirror ball shows.

The paper takes all 4-connected parts at the highest luminance. In a photograph with a higher range than its
lights, that is one pixel of one light. So the same flood fill goes down through the levels ℓmax·0.7^k: a part
that is separate from every brighter light, and rises at least one level above where it is found, is a light.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

STEP = 0.7
"""From one level to the next: around a light, luminance falls to this part before a brighter one."""
CONTRAST = 3.0
"""A light is this many times as bright as the median of the ball."""
HALF = 0.5
"""Of its peak: what belongs to a light for its size."""
_SAME_CLIPPED = 0.9  # clipped parts that are joined at this part of the highest luminance are one light
_SKIRT = 2  # cells round the half-maximum that still hold a light's blur
_RING = 3  # cells beyond, that tell what is behind it


@dataclass(frozen=True, eq=False)
class BrightPart:
    """Cells of one light: mask (h, w) at half of its peak; skirt (h, w), with its blur; peak luminance.

    is_clipped: whether the photograph holds less than its light. is_cut: whether it ends where the mask of
    the samples does. behind: (3,) radiance around it.
    """

    mask: np.ndarray
    skirt: np.ndarray
    peak: float
    is_clipped: bool
    is_cut: bool
    behind: np.ndarray


def maximum_components(samples, tolerance=0.0) -> list[np.ndarray]:
    """Masks (h, w) of the 4-connected parts at the highest luminance ℓmax of the ball, the largest first.

    tolerance: cells from (1 − tolerance)·ℓmax on count; 0 for the paper's own set. Clipped cells always
    count, where there are some: their channels ended at one value, their luminances needn't.

    Source: Realistic Shadows for Mobile Augmented Reality, section III.A, "Processamento da imagem
    capturada".
    """
    if samples.clipped.any() and not tolerance:
        return _parts(samples.clipped)
    highest = samples.luminance[samples.mask].max()
    return _parts(samples.mask & (samples.luminance >= (1 - tolerance) * highest))


def bright_parts(samples) -> list[BrightPart]:
    """The lights that a mirror ball's samples show; none where nothing stands out by CONTRAST."""
    luminance = np.where(samples.mask, samples.luminance, 0.0)
    floor = max(CONTRAST * float(np.median(samples.luminance[samples.mask])), 1e-12)
    level = float(luminance.max())
    seeds = np.zeros(
        samples.mask.shape, np.int32
    )  # the brightest cells of the lights found so far, by number
    peaks = []
    if samples.clipped.any():
        floor = min(floor, 0.99 * level)  # what is clipped is bright, however much of the ball it covers
        joined = samples.clipped | (luminance >= _SAME_CLIPPED * level)
        _add_seeds(joined, np.where(samples.clipped, np.inf, 0.0), 1.0, seeds, peaks)
    while level >= floor:
        _add_seeds(luminance >= level, luminance, level / STEP, seeds, peaks)
        level *= STEP
    _add_seeds(luminance >= max(level, floor * STEP), luminance, floor, seeds, peaks)
    return _with_cells(samples, luminance, seeds, len(peaks))


def _add_seeds(above, height, least, seeds, peaks):
    """Number the parts of `above` without seed that rise to `least`; their cells from there on are seeds."""
    count, labels = cv2.connectedComponents(above.astype(np.uint8), connectivity=4)
    if count == 1:
        return
    highest = np.zeros(count)
    np.maximum.at(highest, labels.ravel(), height.ravel())
    is_taken = np.zeros(count, bool)
    is_taken[labels[seeds > 0]] = True
    for label in np.flatnonzero((highest >= least) & ~is_taken):
        if label:
            peaks.append(highest[label])
            seeds[(labels == label) & (height >= min(least, highest[label]))] = len(peaks)


def _with_cells(samples, luminance, seeds, count):
    halves = [_half_of(luminance, seeds, number) for number in range(1, count + 1)]
    taken = np.zeros(seeds.shape, bool)
    for half in halves:
        taken |= half
    parts = []
    for number, half in enumerate(halves, 1):
        others = taken & ~half
        skirt = _grown(half, _SKIRT) & samples.mask & ~others
        ring = _grown(half, _SKIRT + _RING) & samples.mask & ~_grown(taken, _SKIRT)
        behind = np.median(samples.radiance[ring], axis=0) if ring.any() else np.zeros(3)
        is_clipped = bool((samples.clipped & half).any())
        is_cut = bool((_grown(half, 1) & ~samples.mask).any()) or _at_border(half)
        peak = float(luminance[seeds == number].max())
        parts.append(BrightPart(half, skirt, peak, is_clipped, is_cut, behind))
    return parts


def _half_of(luminance, seeds, number):
    """The 4-connected cells at half of a light's peak, or as far up as it takes to leave the others out."""
    own = seeds == number
    peak = luminance[own].max()
    for share in (HALF, STEP, _SAME_CLIPPED):
        _, labels = cv2.connectedComponents((luminance >= share * peak).astype(np.uint8), connectivity=4)
        half = np.isin(labels, np.unique(labels[own & (labels > 0)])) & (labels > 0)
        if not (half & (seeds > 0) & ~own).any():
            return half
    return own


def _at_border(mask):
    return bool(mask[0].any() or mask[-1].any() or mask[:, 0].any() or mask[:, -1].any())


def _grown(mask, cells):
    return cv2.dilate(mask.astype(np.uint8), np.ones((2 * cells + 1,) * 2, np.uint8)).astype(bool)


def _parts(mask):
    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    order = np.argsort(-statistics[1:, cv2.CC_STAT_AREA], kind="stable") + 1
    return [labels == label for label in order if label < count]
