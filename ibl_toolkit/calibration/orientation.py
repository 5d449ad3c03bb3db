"""From clicks to the best orientation: every start value tried until one explains the clicks."""

import numpy as np

from .adjustment import adjust
from .conditions import build_conditions
from .picks import CalibrationError
from .start import minimal_rotation, start_values

# A start that ends in a misfit of no more than this many click errors (1½ pixels) needs no rival. Real clicks
# err by a pixel or two; a wall whose level sides were taken for the upright ones misfits by tens.
GOOD_MISFIT = 3.0
# Verticals that differ by more than this are different answers, not the same one reached twice.
RIVAL_COSINE = 0.7


def orient(clicks):
    """(Conditions, Adjustment, rival) of the most likely orientation.

    rival: True if walls are all there is and fit as well with their level sides standing up.
    Raises: CalibrationError if no orientation comes near the picks.
    """
    walls_only = not clicks.lines and all(quad.plane == "WALL" for quad in clicks.quads)
    found = []
    for start in start_values(clicks):
        conditions = build_conditions(clicks, start.upright_pairs)
        solution = adjust(clicks, conditions, start.world_from_panorama, start.azimuths)
        if solution.converged:
            found.append((conditions, solution))
            if misfit(solution) <= GOOD_MISFIT and not walls_only:
                break
    if not found:
        raise CalibrationError(
            "the picks contradict each other: no orientation comes near all of them; check planes and axes, "
            "and that corners were clicked in order"
        )
    # The first of equals: walls list the sides nearer to the panorama's own vertical first.
    best = min(found, key=lambda one: max(misfit(one[1]), GOOD_MISFIT))
    up = best[1].world_from_panorama[2]
    rival = any(
        misfit(other) <= max(misfit(best[1]), GOOD_MISFIT)
        and abs(np.dot(up, other.world_from_panorama[2])) < RIVAL_COSINE
        for _, other in found
    )
    return *best, rival


def misfit(adjustment):
    """Estimated click error in units of the assumed half pixel, √(Σv² / redundancy); 0 without redundancy."""
    return float(np.sqrt(adjustment.cost / adjustment.redundancy)) if adjustment.redundancy > 0 else 0.0


def final_rotation(conditions, adjustment):
    """world_from_panorama; where nothing gives an azimuth, the shortest rotation that levels the panorama."""
    if conditions.families:
        return adjustment.world_from_panorama
    return minimal_rotation(adjustment.world_from_panorama[2])
