"""Bright regions of a light map: connected pixels above a luminance, round the seam and over the poles."""

from __future__ import annotations

import cv2
import numpy as np


def connected_regions(mask: np.ndarray) -> list[np.ndarray]:
    """Return the flat pixel indices of each connected region of a mask (H, W), on the sphere.

    All eight neighbours connect; the first and last column too, and the pixels that face each other across a
    pole.

    >>> mask = np.zeros((4, 8), bool)
    >>> mask[1, 0] = mask[2, 7] = mask[3, 3] = True
    >>> [region.tolist() for region in connected_regions(mask)]
    [[8, 23], [27]]
    """
    count, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    labels = _joined(count, _pairs_across_borders(labels))[labels].ravel()
    order = np.argsort(labels, kind="stable")
    starts = np.flatnonzero(np.diff(labels[order], prepend=-1))
    return [region for region in np.split(order, starts[1:]) if labels[region[0]]]


def _pairs_across_borders(labels):
    """Labels (n, 2) of bright pixels that touch across the seam or a pole."""
    left, right = labels[:, 0], np.pad(labels[:, -1], 1)
    seam = [(left, right[shift : shift + len(left)]) for shift in range(3)]
    poles = [(row, np.roll(row, len(row) // 2)) for row in (labels[0], labels[-1])]
    pairs = np.concatenate([np.stack(pair, axis=1) for pair in seam + poles])
    return np.unique(pairs[(pairs > 0).all(axis=1)], axis=0)


def _joined(count, pairs):
    """The new label (count,) of every label, the same for those that a chain of pairs connects."""
    new = np.arange(count)
    for one, other in pairs:
        new[new == new[other]] = new[one]
    return new
