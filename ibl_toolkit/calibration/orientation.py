"""From clicks to the best orientation: every start value tried until one explains the clicks."""

import numpy as np

from .adjustment import adjust
from .conditions import build_conditions
from .picks import CalibrationError
from .start import minimal_rotation, start_values

# A start that ends in a misfit of no more than this many click errors (1½ pixels) needs no rival. Real clicks
# err by a pixel or two; a wall whose level sides were taken for the upright ones misfits by tens.
GOOD_MISFIT = 3.0


def orient(clicks):
    """(Conditions, Adjustment) of the most likely orientation. Raises: CalibrationError if there is none."""
    best = None
    for start in start_values(clicks):
        conditions = build_conditions(clicks, start.upright_pairs)
        if len(conditions.first) < (3 if conditions.families else 2):
            raise CalibrationError(
                f"{len(conditions.first)} lines are too few; add a rectangle or two verticals"
            )
        solution = adjust(clicks, conditions, start.world_from_panorama, start.azimuths)
        if solution.converged and (best is None or solution.cost < best[1].cost * (1.0 - 1e-6)):
            best = conditions, solution
        if best is not None and misfit(best[1]) <= GOOD_MISFIT:
            break
    if best is None:
        raise CalibrationError(
            "the picks contradict each other: no orientation comes near all of them; check the planes and axes, "
            "and that corners were clicked in order"
        )
    return best


def misfit(adjustment):
    """Estimated click error in units of the assumed half pixel, √(Σv² / redundancy); 0 without redundancy."""
    return float(np.sqrt(adjustment.cost / adjustment.redundancy)) if adjustment.redundancy > 0 else 0.0


def final_rotation(conditions, adjustment):
    """world_from_panorama; where nothing gives an azimuth, the shortest rotation that levels the panorama."""
    if conditions.families:
        return adjustment.world_from_panorama
    return minimal_rotation(adjustment.world_from_panorama[2])
