"""When to trust a solution: picks on their side of the horizon, figures that mean something."""

import numpy as np

from .directions import angle_between
from .picks import CalibrationError

# A floor point half a degree below the horizon is 115 camera heights away: half a pixel of a 4k image moves
# it by a tenth of that.
LEAST_DEPRESSION_DEG = 0.5
LOW_DEPRESSION_DEG = 3.0  # 19 camera heights away; half a pixel of a 4k image is 1.5 % of the distance
# A degree of tilt lifts the far end of a room of 6 m by 10 cm: visible in any composite.
POOR_TILT_DEG = 1.0
# Beyond these, simulation leaves the first-order figures (docs/charts/calibration.png), results are biased.
MEANINGLESS_TILT_DEG = 5.0
MEANINGLESS_SCALE_PERCENT = 25.0
POOR_AZIMUTH_DEG = 2.0  # 20 cm aside at the far end of the same room
POOR_SCALE_PERCENT = 5.0  # an object of 2 m would be 10 cm off


def elevations_deg(clicks, world_from_panorama):
    """Height of each click above the horizon (n,) [deg]."""
    return np.degrees(np.arcsin(np.clip(clicks.directions @ world_from_panorama[2], -1.0, 1.0)))


def check_horizon(clicks, world_from_panorama):
    """Refuse floor picks above or at the horizon and ceiling picks below it; warnings (tuple) for low ones.

    Raises: CalibrationError naming the first such pick and its angle.
    """
    elevation = elevations_deg(clicks, world_from_panorama)
    _check_side(clicks, clicks.floor_clicks(), -elevation, "floor", "below", "above")
    _check_side(clicks, clicks.ceiling_clicks(), elevation, "ceiling", "above", "below")
    level = clicks.floor_clicks() + clicks.ceiling_clicks()
    low = [k for k in level if abs(elevation[k]) < LOW_DEPRESSION_DEG]
    if not low:
        return ()
    worst = min(low, key=lambda k: abs(elevation[k]))
    return (
        f"{clicks.names[worst]}: lies only {abs(elevation[worst]):.1f}° from the horizon, where distances "
        f"are uncertain; prefer nearer picks",
    )


def _check_side(clicks, indices, beyond_deg, what, right, wrong):
    for k in indices:
        if beyond_deg[k] < 0.0:
            raise CalibrationError(
                f"{clicks.names[k]}: lies {-beyond_deg[k]:.2f}° {wrong} the horizon; picks on the {what} "
                f"must lie {right} it"
            )
        if beyond_deg[k] < LEAST_DEPRESSION_DEG:
            raise CalibrationError(
                f"{clicks.names[k]}: lies only {beyond_deg[k]:.2f}° {right} the horizon; picks on the {what} "
                f"need at least {LEAST_DEPRESSION_DEG}°"
            )


def check_uncertainty(clicks, world_from_panorama, uncertainty, scale_percent):
    """Warnings (tuple of str) for poor figures. Raises: CalibrationError where they mean nothing."""
    tilt_deg, azimuth_deg = np.degrees(uncertainty.tilt), np.degrees(uncertainty.azimuth)
    cause = _cause(clicks, world_from_panorama)
    if not tilt_deg <= MEANINGLESS_TILT_DEG:
        raise CalibrationError(
            f"the picks leave the tilt undetermined (±{min(tilt_deg, 180.0):.0f}° for half a pixel, at most "
            f"±{MEANINGLESS_TILT_DEG:g}° is of use): {cause}"
        )
    if clicks.length is not None and not scale_percent <= MEANINGLESS_SCALE_PERCENT:
        raise CalibrationError(
            f"length: leaves the scale undetermined (±{scale_percent:.0f} % for half a pixel, at most "
            f"±{MEANINGLESS_SCALE_PERCENT:g} % is of use): its points are too close together or too far away"
        )
    warnings = []
    if tilt_deg > POOR_TILT_DEG:
        warnings.append(f"the tilt is uncertain by ±{tilt_deg:.1f}° for half a pixel of click error: {cause}")
    if azimuth_deg > POOR_AZIMUTH_DEG:
        warnings.append(
            f"the direction of +x is uncertain by ±{min(azimuth_deg, 180.0):.1f}° for half a pixel of click "
            f"error: what gives it is too small or too far away"
        )
    if scale_percent > POOR_SCALE_PERCENT:
        what = "a length on the floor" if clicks.length is None else "the camera height"
        warnings.append(f"{what} is uncertain by ±{scale_percent:.0f} % for half a pixel of click error")
    return tuple(warnings)


def _cause(clicks, world_from_panorama):
    """Why the tilt is poorly known, with the figures of the largest rectangle."""
    if not clicks.quads:
        return "the lines are too short, too few, or run too much alike; add some in other directions"
    spans = [_span_deg(clicks, quad) for quad in clicks.quads]
    largest = int(np.argmax(spans))
    quad = clicks.quads[largest]
    elevation = elevations_deg(clicks, world_from_panorama)[list(quad.clicks)].mean()
    place = f"{abs(elevation):.0f}° {'below' if elevation < 0 else 'above'} the horizon"
    return (
        f"{quad.name} spans {spans[largest]:.1f}°, {place}; take a larger one, nearer to 45° from the "
        f"horizon, or add lines in other directions"
    )


def _span_deg(clicks, quad):
    """The shorter diagonal of a rectangle as the camera sees it [deg]."""
    a, b, c, d = clicks.directions[list(quad.clicks)]
    return float(np.degrees(min(angle_between(a, c), angle_between(b, d))))


def check_evidence(clicks, conditions, world_from_panorama, redundancy, rivals):
    """Warnings (list of str) about what the picks could not say: which way is up, the azimuth, a check."""
    warnings = []
    tilt_deg = np.degrees(np.arccos(np.clip(world_from_panorama[2, 2], -1.0, 1.0)))
    if not (clicks.floor_clicks() or clicks.ceiling_clicks()):
        warnings.append("no pick lies on floor or ceiling: the panorama's own top was taken for up")
    elif tilt_deg > 90.0:
        warnings.append(
            f"the panorama is upside down (tilt {tilt_deg:.1f}°); if it is not, picks on the ceiling were "
            f"called floor or the other way round"
        )
    if redundancy == 0:
        warnings.append(
            "no pick is redundant, so a misplaced one would go unnoticed; add a line or a rectangle"
        )
    if not conditions.families:
        warnings.append(
            "nothing gives an azimuth: +x stays near the panorama's; add a rectangle or parallels"
        )
    if rivals:
        others = " or ".join(f"{rival}°" for rival in rivals)
        warnings.append(
            f"the picks fit other verticals as well: tilt {others} instead of {tilt_deg:.0f}°, which is "
            f"nearest to the panorama's own top; add verticals or a larger rectangle"
        )
    return warnings
