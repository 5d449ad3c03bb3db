"""Gauss–Newton steps to the lights and the ambient light that shade a matt ball, from a guess of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_STEPS = 40
_TUKEY = 4.685
_MAD = 1.4826
_TRIM, _TRIM_LEAST = 6.0, 0.1  # scales, and means of the luminance: a larger residual counts as one at them
_DAMPING, _EVEN = 1e-6, 1e-4  # per cell; the second keeps ambient light even where a slope would be a light's


@dataclass(frozen=True, eq=False)
class Shading:
    """vectors (k, 3) to the lights, their lengths the luminance that each brings to a facing surface.

    ambient: (4,) a and b, luminance from all around. rms: of the residual. uncertainty_deg: (k,) [°] of the
    vectors' directions: the standard error, or how far off another model that is possible has its nearest.
    """

    vectors: np.ndarray
    ambient: np.ndarray
    rms: float
    uncertainty_deg: np.ndarray


def refined(normals, luminance, clipped, vectors, ambient, is_sloped):
    """The Shading that steps between which side each light reaches and the vectors lead to.

    normals (n, 3), luminance (n,), clipped (n,) bool; vectors (k, 3) and ambient (4,) to begin with.
    is_sloped: whether the ambient light may come from one half of the room.
    """
    vectors, ambient = vectors.copy(), ambient.copy()
    weights = np.ones(len(luminance))
    ridge = np.array([_DAMPING] * (vectors.size + 1) + [_EVEN] * 3) * len(luminance)
    for step in range(_STEPS):
        residual, jacobian = _residual(normals, luminance, vectors, ambient)
        if step >= 4:
            weights = _tukey(residual)
        weighted = jacobian * (weights * ~(clipped & (residual > 0)))[:, None]
        gradient = weighted.T @ residual
        gradient[-3:] += ridge[-3:] * ambient[1:]
        normal = weighted.T @ jacobian + np.diag(ridge)
        # At its limit the slope stays where it is in every other step, for the lights to settle beside it.
        moved = len(gradient) - 3 * (not is_sloped or (step % 2 == 1 and _is_at_limit(ambient)))
        change = np.zeros(len(gradient))
        change[:moved] = np.linalg.solve(normal[:moved, :moved], -gradient[:moved])
        vectors += change[:-4].reshape(-1, 3)
        ambient = _possible(ambient + change[-4:])
        if np.abs(change).max() < 1e-6:
            break
    return evaluated(normals, luminance, clipped, vectors, ambient)


def _possible(ambient):
    """Light from everywhere that is nowhere negative: a ≥ 0, |b| ≤ a."""
    mean, slope = max(ambient[0], 0.0), ambient[1:]
    return np.concatenate([[mean], slope * min(1.0, mean / max(np.linalg.norm(slope), 1e-30))])


def _is_at_limit(ambient):
    return np.linalg.norm(ambient[1:]) > 0.999 * ambient[0]


def _residual(normals, luminance, vectors, ambient):
    cosines = normals @ vectors.T
    lit = cosines > 0
    residual = ambient[0] + normals @ ambient[1:] + np.sum(cosines * lit, axis=1) - luminance
    lights = (lit[:, :, None] * normals[:, None]).reshape(len(normals), -1)
    return residual, np.concatenate([lights, np.ones((len(normals), 1)), normals], axis=1)


def _tukey(residual):
    scale = max(_MAD * np.median(np.abs(residual)), 1e-6)
    return np.square(np.maximum(1 - np.square(residual / (_TUKEY * scale)), 0))


def evaluated(normals, luminance, clipped, vectors, ambient):
    """The Shading of given vectors (k, 3) and ambient (4,): its robust rms, and standard errors across."""
    residual, jacobian = _residual(normals, luminance, vectors, ambient)
    counts = ~(clipped & (residual > 0))
    # Not Tukey's scale, which is blind to a second light that few cells show.
    sizes = np.abs(residual[counts])
    trim = max(_TRIM * _MAD * np.median(sizes), _TRIM_LEAST)
    rms = float(np.sqrt(np.square(np.minimum(sizes, trim)).mean()))
    errors = np.zeros(len(vectors))
    if len(vectors):
        prior = np.diag([0.0] * (vectors.size + 1) + [_EVEN] * 3) * len(luminance)
        covariance = np.linalg.pinv(jacobian[counts].T @ jacobian[counts] + prior) * rms**2
        for k, vector in enumerate(vectors):
            block = covariance[3 * k : 3 * k + 3, 3 * k : 3 * k + 3]
            length = max(np.linalg.norm(vector), 1e-12)
            along = vector @ block @ vector / length**2
            errors[k] = np.degrees(np.sqrt(max(np.trace(block) - along, 0)) / length)
    return Shading(vectors, ambient, rms, errors)
