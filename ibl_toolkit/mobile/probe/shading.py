"""The shading of a matt ball as the sum of few lights: L(n) = a + Σ max(0, n·gₖ).

gₖ points to light k and is as long as albedo/π times its irradiance; a is what comes from everywhere alike.
With the lit side of each light known, that is linear, so Gauss–Newton steps between sides and vectors find
it, with Tukey's weights against what is not shading: dust, glints, a cast shadow. Lights are added one at a
time, each at the best of several hundred directions, while they explain the picture clearly better.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BETTER = 0.9
"""A further light must bring the residual to this part of what it was …"""
LEAST_STRENGTH = 0.05
"""… and have this part of the strongest one's."""
_STEPS = 40
_TUKEY = 4.685
_STARTS = 3
_APART = np.cos(np.radians(25.0))
_MAD = 1.4826
_TRIM, _TRIM_LEAST = (
    6.0,
    0.1,
)  # scales, and means of the luminance, beyond which a residual counts as one at them
_CANDIDATES = 600


@dataclass(frozen=True, eq=False)
class Shading:
    """vectors (k, 3) to the lights, their lengths the luminance that each brings to a facing surface.

    ambient: luminance from everywhere. rms: of the residual. uncertainty_deg: (k,) [°] standard errors.
    """

    vectors: np.ndarray
    ambient: float
    rms: float
    uncertainty_deg: np.ndarray


def fit_shading(normals, luminance, count, clipped=None) -> Shading:
    """At most `count` lights and an ambient term that explain luminances (n,) at unit normals (n, 3).

    Luminances are taken to have a mean of about 1. clipped: (n,) bool; such a luminance is a lower bound.

    >>> turn = np.linspace(0, 3, 50)
    >>> normals = np.stack([np.cos(turn), np.sin(turn) * 0.6, np.sin(turn) * 0.8], axis=1)
    >>> fit_shading(normals, 0.1 + np.maximum(normals[:, 1], 0), 1).ambient.__round__(3)
    0.1
    """
    clipped = np.zeros(len(luminance), bool) if clipped is None else clipped
    floor = float(np.median(luminance[~clipped])) if (~clipped).any() else float(luminance.min())
    best = _evaluated(normals, luminance, clipped, np.zeros((0, 3)), floor)
    for _ in range(count):
        tried = [
            _refined(normals, luminance, clipped, np.vstack([best.vectors, start]), best.ambient)
            for start in _starts(normals, luminance, clipped, best.vectors)
        ]
        if not tried:
            break
        found = min(tried, key=lambda shading: shading.rms)
        lengths = np.linalg.norm(found.vectors, axis=1)
        if found.rms > BETTER * best.rms or lengths.min() < LEAST_STRENGTH * lengths.max():
            break
        best = found
    return best


def _starts(normals, luminance, clipped, vectors):
    """Vectors (3,) of one more light, at the directions that explain most of what is left."""
    candidates = _spread(_CANDIDATES)
    shapes = np.maximum(normals @ candidates.T, 0)
    known = np.column_stack([np.maximum(normals @ vectors.T, 0), np.ones(len(normals))])
    basis, _ = np.linalg.qr(known[~clipped])
    rest = luminance[~clipped] - basis @ (basis.T @ luminance[~clipped])
    free = shapes[~clipped] - basis @ (basis.T @ shapes[~clipped])
    power = np.sum(free**2, axis=0)
    share = free.T @ rest
    gain = np.where((share > 0) & (power > 1e-6 * len(rest)), share**2 / np.maximum(power, 1e-30), 0)
    starts = []
    for index in np.argsort(-gain):
        if gain[index] <= 0 or len(starts) == _STARTS:
            break
        if all(candidates[index] @ other < _APART for other, _ in starts):
            starts.append((candidates[index], share[index] / power[index]))
    return [direction * length for direction, length in starts]


def _refined(normals, luminance, clipped, vectors, ambient):
    """Gauss–Newton steps between which side each light reaches and the vectors."""
    vectors, damping = vectors.copy(), 1e-6
    weights = np.ones(len(luminance))
    for step in range(_STEPS):
        residual, jacobian = _residual(normals, luminance, clipped, vectors, ambient)
        if step >= 4:
            weights = _tukey(residual)
        active = weights * ~(clipped & (residual > 0))
        weighted = jacobian * active[:, None]
        normal = weighted.T @ jacobian + damping * len(luminance) * np.eye(jacobian.shape[1])
        change = np.linalg.solve(normal, -weighted.T @ residual)
        vectors += change[:-1].reshape(-1, 3)
        ambient = max(ambient + change[-1], 0.0)
        if np.abs(change).max() < 1e-9:
            break
    return _evaluated(normals, luminance, clipped, vectors, ambient)


def _residual(normals, luminance, clipped, vectors, ambient):
    cosines = normals @ vectors.T
    lit = cosines > 0
    residual = ambient + np.sum(cosines * lit, axis=1) - luminance
    jacobian = np.concatenate(
        [(lit[:, :, None] * normals[:, None]).reshape(len(normals), -1), np.ones((len(normals), 1))], axis=1
    )
    return residual, jacobian


def _tukey(residual):
    scale = max(_MAD * np.median(np.abs(residual)), 1e-6)
    return np.square(np.maximum(1 - np.square(residual / (_TUKEY * scale)), 0))


def _evaluated(normals, luminance, clipped, vectors, ambient):
    """Robust rms, and the vectors' standard errors across."""
    residual, jacobian = _residual(normals, luminance, clipped, vectors, ambient)
    counts = ~(clipped & (residual > 0))
    # Not Tukey's scale, which is blind to a second light that few cells show.
    sizes = np.abs(residual[counts])
    trim = max(_TRIM * _MAD * np.median(sizes), _TRIM_LEAST)
    rms = float(np.sqrt(np.square(np.minimum(sizes, trim)).mean()))
    errors = np.zeros(len(vectors))
    if len(vectors):
        covariance = np.linalg.pinv(jacobian[counts].T @ jacobian[counts]) * rms**2
        for k, vector in enumerate(vectors):
            block = covariance[3 * k : 3 * k + 3, 3 * k : 3 * k + 3]
            length = max(np.linalg.norm(vector), 1e-12)
            along = vector @ block @ vector / length**2
            errors[k] = np.degrees(np.sqrt(max(np.trace(block) - along, 0)) / length)
    return Shading(vectors, float(ambient), rms, errors)


def _spread(count):
    """(count, 3) unit vectors, evenly over the sphere: Fibonacci's spiral."""
    index = np.arange(count) + 0.5
    z = 1 - 2 * index / count
    turn = index * np.pi * (1 + np.sqrt(5))
    across = np.sqrt(1 - z * z)
    return np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=1)
