"""From clicks to the best orientation: every start value tried until one explains the clicks."""

from dataclasses import replace

import numpy as np

from .adjustment import MOST_STEPS, RIVAL_STEPS, adjust
from .conditions import build_conditions
from .directions import minimal_rotation
from .picks import CalibrationError
from .start import start_values
from .uncertainty import propagate

# Misfit of at most this many click errors (1½ pixels): careful clicks err by half a pixel to that.
GOOD_MISFIT = 3.0
# Solutions whose costs differ by less are told apart by chance: three standard deviations for clicks that err
# by a whole pixel, (3 · 2)².
RIVAL_COST = 36.0
# A figure that could be taken for its reverse in depth tells the tilt only to a degree or more (see the
# tests); half of that leaves a margin.
DOUBTFUL_TILT = np.radians(0.5)
# Starts within this of a solution lead to it again; solutions farther apart are different answers.
SAME_VERTICAL_COSINE = np.cos(np.radians(5.0))


def orient(clicks):
    """(Conditions, Adjustment, rivals) of the most likely orientation.

    rivals: tilts [deg] of other verticals that chance could have made as likely. Of those the one nearest
    to the panorama's own top is taken: tripods stand.
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
    least = min(solution.cost for _, solution in found)
    alike = [one for one in found if one[1].cost <= least + RIVAL_COST]
    alike = [one for one in alike if _right_side_up(clicks, one[1])] or alike
    alike.sort(key=lambda one: -one[1].world_from_panorama[2, 2])
    best, others = alike[0], [_up(solution) for _, solution in alike[1:]]
    rivals = {
        round(float(np.degrees(np.arccos(up[2]))))
        for up in others
        if up @ _up(best[1]) < SAME_VERTICAL_COSINE
    }
    return *best, sorted(rivals)


def _solutions(clicks):
    """All different (Conditions, Adjustment) that the start values lead to, until one leaves no doubt."""
    found, steps = [], MOST_STEPS
    for start in start_values(clicks):
        up = start.world_from_panorama[2]
        if any(up @ _up(other) > SAME_VERTICAL_COSINE and misfit(other) <= GOOD_MISFIT for _, other in found):
            continue
        conditions = build_conditions(clicks, start.upright_pairs)
        solution = adjust(clicks, conditions, start.world_from_panorama, start.azimuths, steps)
        if not solution.converged:
            continue
        found.append((conditions, solution))
        if misfit(solution) <= GOOD_MISFIT:
            steps = RIVAL_STEPS
            if _beyond_doubt(clicks, conditions, solution):
                break
    return found


def _beyond_doubt(clicks, conditions, solution):
    """Whether no other vertical comes as near: strong perspective, and not only walls to say what stands."""
    level = any(quad.plane != "WALL" for quad in clicks.quads) or not clicks.quads
    return level and propagate(conditions, solution).tilt < DOUBTFUL_TILT


def _up(adjustment):
    return np.clip(adjustment.world_from_panorama[2], -1.0, 1.0)


def _right_side_up(clicks, adjustment):
    """Whether the floor lies below and the ceiling above the horizon."""
    elevation = clicks.directions @ _up(adjustment)
    return not (
        np.any(elevation[clicks.floor_clicks()] > 0.0) or np.any(elevation[clicks.ceiling_clicks()] < 0.0)
    )


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
