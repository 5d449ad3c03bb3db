"""From clicks to the best orientation: every start value tried until one explains the clicks."""

from dataclasses import replace

import numpy as np

from .adjustment import adjust
from .conditions import build_conditions
from .directions import minimal_rotation
from .picks import CalibrationError
from .start import start_values

# A start that ends in a misfit of no more than this many click errors (1½ pixels) needs no rival. Real clicks
# err by a pixel or two; a wall whose level sides were taken for the upright ones misfits by tens.
GOOD_MISFIT = 3.0
# Verticals that differ by more than this are different answers, not the same one reached twice.
RIVAL_COSINE = 0.7


def orient(clicks):
    """(Conditions, Adjustment, rival) of the most likely orientation.

    rival: True if walls decide the vertical, but all would fit as well with their level sides standing up.
    Raises: CalibrationError if no orientation comes near the picks.
    """
    found = _solutions(clicks)
    if not found:
        named = [name for name, rest in _parts(clicks) if _agrees(rest)]
        without = f"; the rest would agree without {' or '.join(named)}" if named else ""
        raise CalibrationError(
            f"the picks contradict each other: no orientation comes near all of them{without}; check planes "
            f"and axes, and that corners were clicked in order"
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


def _solutions(clicks):
    """All (Conditions, Adjustment) worth comparing, one per start value that leads to a minimum."""
    level = any(quad.plane != "WALL" for quad in clicks.quads)
    only_walls_stand = not level and any(clicks.quads)
    found = []
    for start in start_values(clicks):
        conditions = build_conditions(clicks, start.upright_pairs)
        solution = adjust(clicks, conditions, start.world_from_panorama, start.azimuths)
        if solution.converged:
            found.append((conditions, solution))
            if misfit(solution) <= GOOD_MISFIT and not only_walls_stand:
                break
    return found


def _parts(clicks):
    """(name, clicks without it) of each rectangle and of all lines along each axis."""
    for quad in clicks.quads:
        yield quad.name, replace(clicks, quads=tuple(other for other in clicks.quads if other is not quad))
    for axis, name in (("X", "the X parallels"), ("Y", "the Y parallels"), ("Z", "the verticals")):
        rest = tuple(line for line in clicks.lines if line.axis != axis)
        if len(rest) < len(clicks.lines):
            yield name, replace(clicks, lines=rest)


def _agrees(clicks):
    try:
        return any(misfit(solution) <= GOOD_MISFIT for _, solution in _solutions(clicks))
    except CalibrationError:  # too little is left to orient anything
        return False


def misfit(adjustment):
    """Estimated click error in units of the assumed half pixel, √(Σv² / redundancy); 0 without redundancy."""
    return float(np.sqrt(adjustment.cost / adjustment.redundancy)) if adjustment.redundancy > 0 else 0.0


def final_rotation(conditions, adjustment):
    """world_from_panorama; where nothing gives an azimuth, the shortest rotation that levels the panorama."""
    if conditions.families:
        return adjustment.world_from_panorama
    return minimal_rotation(adjustment.world_from_panorama[2])
