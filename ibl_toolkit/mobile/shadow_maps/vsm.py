"""Variance shadow maps: mean and mean square of the depths under a Gaussian, and Chebyshev's bound.

Sources: "Realistic Shadows for Mobile AR", section IV.B and eq. 2; W. Donnelly and A. Lauritzen, "Variance
shadow maps", I3D 2006; A. Lauritzen, "Summed-area variance shadow maps", GPU Gems 3, 2007, for the reduction.
Deviation from eq. 2, which has σ² and σ for the variance: it is M₂ − M₁².
"""

import numpy as np

from .gaussian import blurred
from .lookup import bilinear
from .storage import STEPS, packed, unpacked

_FLOAT_STEP = 2.0**-23


def texels(depth, camera, settings):
    """The filtered map as the device holds it: z and z², z linear from near to far."""
    z = camera.linear_depth(depth)
    decode, encode = (lambda t: unpacked(t, settings.storage)), (lambda m: packed(m, settings.storage))
    return blurred(encode(np.stack([z, z * z], axis=-1)), settings.window, encode, decode)


def visibility(shadow_map, texture):
    """Of places (n, 3), s, t, r."""
    settings = shadow_map.settings
    moments = bilinear(shadow_map.texels, texture[:, :2], lambda t: unpacked(t, settings.storage))
    least = least_variance(settings.storage)
    lit = chebyshev(moments, shadow_map.camera.linear_depth(texture[:, 2]), least)
    return without_bleeding(lit, settings.bleeding_reduction)


def least_variance(storage: str) -> float:
    """What rounding alone makes of M₂ − M₁²: half a step of M₂, and of M₁ twice M₁ ≤ 1."""
    return 1.5 * (STEPS[storage] or _FLOAT_STEP)


def chebyshev(moments: np.ndarray, depth: np.ndarray, least) -> np.ndarray:
    """Upper bound (n,) of the part of a distribution, of moments (n, 2), that is at ``depth`` or beyond.

    least: what the variance is clamped to from below.

    >>> half = np.array([[0.5, 0.5]])  # one half at 0, the other at 1
    >>> chebyshev(half, np.array([1.0]), 0.0), chebyshev(half, np.array([0.4]), 0.0)
    (array([0.5]), array([1.]))
    """
    mean = moments[:, 0]
    variance = np.maximum(moments[:, 1] - mean**2, least)
    beyond = np.maximum(depth - mean, 0.0)
    return np.where(beyond > 0, variance / np.maximum(variance + beyond**2, 1e-300), 1.0)


def without_bleeding(lit: np.ndarray, amount: float) -> np.ndarray:
    """A linear step: what is lit less than ``amount`` is dark, and the rest is spread over 0 to 1."""
    return np.clip((lit - amount) / (1 - amount), 0.0, 1.0)
