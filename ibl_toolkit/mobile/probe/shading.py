"""The shading of a matt ball as the sum of few lights: L(n) = a + b·n + Σ max(0, n·gₖ).

gₖ points to light k and is as long as albedo/π times its irradiance. a + b·n is what comes from all around: b
is 0 where it comes from everywhere alike, and as long as a where it comes from one half of the room. With the
lit side of each light known, all is linear, so Gauss–Newton steps between sides and vectors find it, with
Tukey's weights against what is not shading: dust, glints, a cast shadow. Lights are added one at a time, each
at the best of several hundred directions, with and without b; the model with the fewest lights that is no
worse than the best one by more than chance is taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .ball import across

LEAST_STRENGTH = 0.05
"""Of the strongest light: weaker ones are none."""
LEAST_REACH = 0.04
"""Of the cells: a light beside others that reaches fewer is the rim's blur."""
SIGNIFICANT, CORRELATED = 20.0, 9.0
"""A model with more must lower the squares by more than chance would: so many of their mean, for cells of
which about nine share a blur."""
UNEXPLAINED = 0.005
"""Root mean square, of the mean luminance, that no model needs to explain: lamps some degrees wide leave so
much, and would be split."""
_STEPS = 40
_TUKEY = 4.685
_STARTS = 3
_SPLIT = np.radians(35.0)
_APART = np.cos(np.radians(25.0))
_MAD = 1.4826
_TRIM, _TRIM_LEAST = 6.0, 0.1  # scales, and means of the luminance: a larger residual counts as one at them
_CANDIDATES = 600
_FEW = 500  # cells to choose among starts by
_DAMPING, _EVEN = 1e-6, 1e-4  # per cell; the second keeps ambient light even where a slope would be a light's


@dataclass(frozen=True, eq=False)
class Shading:
    """vectors (k, 3) to the lights, their lengths the luminance that each brings to a facing surface.

    ambient: (4,) a and b, luminance from all around. rms: of the residual. uncertainty_deg: (k,) [°] standard
    errors.
    """

    vectors: np.ndarray
    ambient: np.ndarray
    rms: float
    uncertainty_deg: np.ndarray


def fit_shading(normals, luminance, count, clipped=None) -> Shading:
    """At most `count` lights and an ambient term that explain luminances (n,) at unit normals (n, 3).

    Luminances are taken to have a mean of about 1. clipped: (n,) bool; such a luminance is a lower bound.

    >>> normals = _spread(400)[:200]
    >>> fit_shading(normals, 0.1 + np.maximum(normals[:, 1], 0), 1).vectors.round(2) + 0.0
    array([[0., 1., 0.]])
    """
    clipped = np.zeros(len(luminance), bool) if clipped is None else clipped
    picture = normals, luminance, clipped
    floor = float(np.median(luminance[~clipped])) if (~clipped).any() else float(luminance.min())
    even = [_evaluated(*picture, np.zeros((0, 3)), np.array([floor, 0.0, 0.0, 0.0]))]
    sloped = [even[0]]
    for number in range(1, count + 1):
        for models, is_sloped in ((even, False), (sloped, True)):
            if len(models) == number:
                models += _with_one_more(*picture, models[-1], is_sloped)
    ordered = [even[0]] + [
        models[k] for k in range(1, count + 1) for models in (even, sloped) if k < len(models)
    ]
    best = min(model.rms for model in ordered)
    limit = best**2 * (1 + CORRELATED * SIGNIFICANT / len(luminance)) + UNEXPLAINED**2
    return next(model for model in ordered if model.rms**2 <= limit)


def _with_one_more(normals, luminance, clipped, before, is_sloped):
    """The best model with one more light, in a list; none where that light is weak, or nothing starts one."""
    step = max(1, len(luminance) // _FEW)
    few = normals[::step], luminance[::step], clipped[::step]
    starts = [np.vstack([before.vectors, start]) for start in _starts(*few, before.vectors)]
    starts += _splits(before.vectors)
    if not starts:
        return []
    tried = [_refined(*few, start, before.ambient, is_sloped) for start in starts]
    start = min(tried, key=lambda shading: shading.rms)
    found = _refined(normals, luminance, clipped, start.vectors, start.ambient, is_sloped)
    lengths = np.linalg.norm(found.vectors, axis=1)
    reach = np.mean(normals @ found.vectors.T > 0, axis=0)
    is_useful = lengths.min() >= LEAST_STRENGTH * lengths.max()
    return [found] if is_useful and (reach.min() >= LEAST_REACH or len(lengths) == 1) else []


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


def _splits(vectors):
    """Vectors (k + 1, 3) with one light as two, each way across: one may stand between two true ones."""
    for number, vector in enumerate(vectors):
        others = np.delete(vectors, number, axis=0)
        for side in across(vector / np.linalg.norm(vector)):
            off = np.linalg.norm(vector) * np.tan(_SPLIT) * side
            yield np.vstack([others, (vector + off) / 2, (vector - off) / 2])


def _refined(normals, luminance, clipped, vectors, ambient, is_sloped):
    """Gauss–Newton steps between which side each light reaches and the vectors."""
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
    return _evaluated(normals, luminance, clipped, vectors, ambient)


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


def _evaluated(normals, luminance, clipped, vectors, ambient):
    """Robust rms, and the vectors' standard errors across."""
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


def _spread(count):
    """(count, 3) unit vectors, evenly over the sphere: Fibonacci's spiral."""
    index = np.arange(count) + 0.5
    z = 1 - 2 * index / count
    turn = index * np.pi * (1 + np.sqrt(5))
    radius = np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)
