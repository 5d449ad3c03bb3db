"""Which pick to blame when redundant picks disagree."""

import numpy as np

from .clicks import CLICK_ERROR_PIXELS
from .orientation import misfit

# Estimated click error from which picks count as contradictory, in half pixels: careful clicks err by one or
# two half pixels, hasty ones by four (2 pixels); beyond that something was misclicked or mislabelled.
CONTRADICTORY_MISFIT = 4.0
# Among equally small explanations, one is named alone only if the others leave at least twice its misfit.
CLEARLY_WORSE = 2.0


def disagreement(clicks, conditions, adjustment, degrees_per_click_error):
    """Warnings (tuple of str) about picks that don't fit together; empty if they do.

    A suspect is taken out by dropping its conditions C: the cost falls by k_C' Q_CC⁻¹ k_C (k multipliers,
    Q their cofactors), its squared studentised residual. The smallest suspect that makes the rest agree is
    named.
    """
    estimated = misfit(adjustment)
    if estimated <= CONTRADICTORY_MISFIT:
        return ()
    text = (
        f"the picks disagree: they fit as if clicked with an error of "
        f"{estimated * degrees_per_click_error:.2f}° ({estimated * CLICK_ERROR_PIXELS:.1f} pixels)"
    )
    named = _explanation(clicks, conditions, adjustment)
    if not named:
        return (text + "; too few picks to tell which one is off",)
    return (text + f"; the rest would agree without {' or '.join(named)}",)


def _explanation(clicks, conditions, adjustment):
    """Names of the smallest suspects whose removal makes the rest agree."""
    remaining = []
    for name, rows in _suspects(clicks, conditions).items():
        left = _misfit_without(adjustment, rows)
        if left is not None and left <= min(CONTRADICTORY_MISFIT, misfit(adjustment) / CLEARLY_WORSE):
            remaining.append((len(rows), left, name))
    if not remaining:
        return []
    smallest = min(size for size, _, _ in remaining)
    best = min(left for size, left, _ in remaining if size == smallest)
    alike = [
        (left, name)
        for size, left, name in remaining
        if size == smallest and left <= max(CLEARLY_WORSE * best, 1.0)
    ]
    return [name for _, name in sorted(alike)]


def _misfit_without(adjustment, rows):
    """Estimated click error without some conditions, or None if the rest would have nothing left to check."""
    cofactors = adjustment.multiplier_cofactors[np.ix_(rows, rows)]
    values, vectors = np.linalg.eigh(cofactors)
    controlled = values > 1e-9 * max(values.max(), 1e-300)
    redundancy = adjustment.redundancy - int(controlled.sum())
    if redundancy < 1:
        return None
    part = vectors[:, controlled].T @ adjustment.multipliers[rows]
    drop = float(np.sum(part**2 / values[controlled]))
    return float(np.sqrt(max(adjustment.cost - drop, 0.0) / redundancy))


def _suspects(clicks, conditions):
    """Names and the conditions that fall with them: corners, lines, rectangles, all lines of an axis."""
    suspects = {}
    for quad in clicks.quads:
        for number, click in enumerate(quad.clicks, start=1):
            rows = np.flatnonzero((conditions.first == click) | (conditions.second == click))
            suspects[f"{quad.name}, point {number}"] = rows
        suspects[quad.name] = _owned(conditions, quad.name)
    for line in clicks.lines:
        suspects[line.name] = _owned(conditions, line.name)
    for axis, name in (("X", "the X parallels"), ("Y", "the Y parallels"), ("Z", "the verticals")):
        rows = [k for line in clicks.lines if line.axis == axis for k in _owned(conditions, line.name)]
        if len(rows) > 1:
            suspects[name] = np.array(rows)
    return suspects


def _owned(conditions, name):
    return np.array([k for k, owner in enumerate(conditions.owner) if owner == name])
