"""The shading of a matt ball as the sum of few lights: L(n) = a + b·n + Σ max(0, n·gₖ).

gₖ points to light k and is as long as albedo/π times its irradiance. a + b·n is what comes from all around: b
is 0 where it comes from everywhere alike, and as long as a where it comes from one half of the room. With the
lit side of each light known, all is linear, so Gauss–Newton steps between sides and vectors find it, with
Tukey's weights against what is not shading: dust, glints, a cast shadow. Lights are added one at a time, each
at the best of several hundred directions, with and without b; the model with the fewest lights that is no
worse than the best one by more than chance is taken.

max(0, n·g) = (n·g + |n·g|) / 2: the line where a light's shading begins tells g but for its sign, and of the
signs only the sum of all gₖ is seen. So a light turned round, with others that make up for the sum, may
explain the shading as well. Such turns lead out of local optima; of models that are equal, the one with the
least light is taken, and what the others say instead is the uncertainty.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .ball import across
from .shading_steps import Shading, evaluated, refined

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
_STARTS = 3
_SPLIT = np.radians(35.0)
_APART = np.cos(np.radians(25.0))
_CANDIDATES = 600
_TURNED = 3
_BETTER = 0.999  # so much less must be left after a turn for one more
_FEW = 500  # cells to choose among starts by


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
    even = [evaluated(*picture, np.zeros((0, 3)), np.array([floor, 0.0, 0.0, 0.0]))]
    sloped = [even[0]]
    for number in range(1, count + 1):
        for models, is_sloped in ((even, False), (sloped, True)):
            if len(models) == number:
                models += _with_one_more(*picture, models[-1], is_sloped)
    ordered = [even[0]] + [
        models[k] for k in range(1, count + 1) for models in (even, sloped) if k < len(models)
    ]
    best = min(model.rms for model in ordered)
    chance = best**2 * (1 + CORRELATED * SIGNIFICANT / len(luminance))
    limit = chance + UNEXPLAINED**2
    chosen = next(model for model in ordered if model.rms**2 <= limit)
    return _with_least_light(picture, chosen, max(chance, chosen.rms**2), limit)


def _with_one_more(normals, luminance, clipped, before, is_sloped):
    """The best model with one more light, in a list; none where that light is weak, or nothing starts one."""
    step = max(1, len(luminance) // _FEW)
    few = normals[::step], luminance[::step], clipped[::step]
    starts = [np.vstack([before.vectors, start]) for start in _starts(*few, before.vectors)]
    starts += _splits(before.vectors)
    if not starts:
        return []
    tried = [refined(*few, start, before.ambient, is_sloped) for start in starts]
    best = sorted(tried, key=_rms)[:_TURNED]
    start = min((_turned_round(few, model, is_sloped) for model in best), key=_rms)
    found = refined(normals, luminance, clipped, start.vectors, start.ambient, is_sloped)
    return [found] if _is_useful(found, normals) else []


def _turned_round(picture, model, is_sloped):
    """The model, with lights turned round while that explains more."""
    for _ in model.vectors:
        better = min(_turns(picture, model, is_sloped), key=_rms)
        if better.rms > _BETTER * model.rms:
            break
        model = better
    return model


def _turns(picture, model, is_sloped):
    """The models to which turning round one light of this one leads."""
    for number in range(len(model.vectors)):
        vectors = model.vectors.copy()
        vectors[number] *= -1
        yield refined(*picture, vectors, model.ambient, is_sloped)


def _with_least_light(picture, chosen, equal, limit):
    """Of the models that a turn tells from the chosen one, that with the least light.

    equal: mean square up to which a model explains as much as the chosen one. limit: up to which it is
    possible, so that what it says otherwise is uncertainty.
    """
    rivals = [
        model
        for model in _turns(picture, chosen, bool(chosen.ambient[1:].any()))
        if model.rms**2 <= limit and _is_useful(model, picture[0])
    ]
    least = min([chosen, *(model for model in rivals if model.rms**2 <= equal)], key=_light)
    doubts = [_angles_deg(least.vectors, model.vectors) for model in (chosen, *rivals)]
    return replace(least, uncertainty_deg=np.max([least.uncertainty_deg, *doubts], axis=0))


def _rms(model):
    return model.rms


def _light(model):
    return np.linalg.norm(model.vectors, axis=1).sum()


def _angles_deg(vectors, others):
    """Of vectors (k, 3), the angle (k,) [°] to the nearest of others (m, 3)."""
    if not len(vectors):
        return np.zeros(0)
    units = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in (vectors, others)]
    return np.degrees(np.arccos(np.clip((units[0] @ units[1].T).max(axis=1), -1, 1)))


def _is_useful(model, normals):
    """Whether each light is one, beside the others."""
    lengths = np.linalg.norm(model.vectors, axis=1)
    reach = np.mean(normals @ model.vectors.T > 0, axis=0)
    is_strong = lengths.min(initial=np.inf) >= LEAST_STRENGTH * lengths.max(initial=0)
    return is_strong and (len(lengths) <= 1 or reach.min() >= LEAST_REACH)


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


def _spread(count):
    """(count, 3) unit vectors, evenly over the sphere: Fibonacci's spiral."""
    index = np.arange(count) + 0.5
    z = 1 - 2 * index / count
    turn = index * np.pi * (1 + np.sqrt(5))
    radius = np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)
