"""What is wrong with a shadow, as numbers: against the truth on a square grid of places on the floor."""

import cv2
import numpy as np


def rms(found, truth):
    """Root of the mean square of the difference, over all places."""
    return float(np.sqrt(np.mean((found - truth) ** 2)))


def acne(found, truth, apart):
    """Mean darkness of what is lit, ``apart`` places or more from any shadow."""
    lit = inside(truth >= 1, apart)
    return float(np.mean(1 - found[lit]))


def bleeding(found, truth, apart):
    """Light on the worst hundredth of what is dark, ``apart`` places or more from any light."""
    dark = np.sort(found[inside(truth <= 0, apart)])
    return float(np.mean(dark[-max(len(dark) // 100, 1) :]))


def inside(places, apart):
    """The True (n²,) that are ``apart`` or more from any False and from the grid's border."""
    side = round(np.sqrt(len(places)))
    grid = np.pad(places.reshape(side, side).astype(np.uint8), 1)
    return (cv2.distanceTransform(grid, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1] > apart).ravel()
