"""What a solution must look like to be trusted: picks on the right side of the horizon, figures that mean something."""

import numpy as np

from .conditions import anchor_quad
from .picks import CalibrationError
from .start import side_directions

# A floor point half a degree below the horizon is 115 camera heights away: half a pixel of a 4k image moves
# it by a tenth of that.
LEAST_DEPRESSION_DEG = 0.5
LOW_DEPRESSION_DEG = 3.0  # 19 camera heights away; half a pixel of a 4k image is 1.5 % of the distance
# A degree of tilt lifts the far end of a room of 6 m by 10 cm: visible in any composite.
POOR_TILT_DEG = 1.0
# Beyond this, first-order figures no longer hold (see the chart), and neither does the result.
MEANINGLESS_TILT_DEG = 10.0
POOR_AZIMUTH_DEG = 2.0
POOR_SCALE_PERCENT = 10.0
MEANINGLESS_SCALE_PERCENT = 50.0
# If the sides of a lone wall lean alike against the panorama's own vertical, that can't say which are upright.
UNDECIDED_SIDES_DEG = 20.0


def check_horizon(clicks, world_from_panorama):
    """Refuse floor picks above or at the horizon and ceiling picks below; warn of low ones. Gives warnings.

    Raises: CalibrationError naming the first such pick and its angle.
    """
    elevation_deg = np.degrees(np.arcsin(np.clip(clicks.directions @ world_from_panorama[2], -1.0, 1.0)))
    for what, sign, indices in (
        ("floor", -1.0, clicks.floor_clicks()),
        ("ceiling", 1.0, clicks.ceiling_clicks()),
    ):
        right, wrong = ("below", "above") if sign < 0 else ("above", "below")
        for k in indices:
            beyond = sign * elevation_deg[k]
            if beyond < 0.0:
                raise CalibrationError(
                    f"{clicks.names[k]}: lies {-beyond:.2f}° {wrong} the horizon; picks on the {what} must lie {right} it"
                )
            if beyond < LEAST_DEPRESSION_DEG:
                raise CalibrationError(
                    f"{clicks.names[k]}: lies only {beyond:.2f}° {right} the horizon; at least "
                    f"{LEAST_DEPRESSION_DEG}° are needed on the {what}"
                )
    low = [
        k
        for k in clicks.floor_clicks() + clicks.ceiling_clicks()
        if abs(elevation_deg[k]) < LOW_DEPRESSION_DEG
    ]
    if not low:
        return ()
    worst = min(low, key=lambda k: abs(elevation_deg[k]))
    return (
        f"{clicks.names[worst]} lies only {abs(elevation_deg[worst]):.1f}° from the horizon: distances there are "
        f"uncertain; prefer nearer picks",
    )


def check_uncertainty(tilt_deg, azimuth_deg, scale_percent, length_given):
    """Warnings for poor figures. Raises: CalibrationError where they are meaningless."""
    cause = "the picks are too small, too near the nadir or the horizon, or too much alike"
    if not tilt_deg <= MEANINGLESS_TILT_DEG:
        raise CalibrationError(
            f"the picks leave the tilt undetermined (±{min(tilt_deg, 180.0):.0f}° for half a pixel, at most "
            f"{MEANINGLESS_TILT_DEG:g}° can be used): {cause}"
        )
    if length_given and not scale_percent <= MEANINGLESS_SCALE_PERCENT:
        raise CalibrationError(
            f"length: leaves the scale undetermined (±{scale_percent:.0f} % for half a pixel, at most "
            f"{MEANINGLESS_SCALE_PERCENT:g} % can be used): its points are too close together or too far away"
        )
    warnings = []
    if tilt_deg > POOR_TILT_DEG:
        warnings.append(f"the tilt is uncertain by {tilt_deg:.1f}° for half a pixel of click error: {cause}")
    if azimuth_deg > POOR_AZIMUTH_DEG:
        warnings.append(
            f"the direction of +x is uncertain by {min(azimuth_deg, 180.0):.1f}° for half a pixel of click error: "
            f"what gives it is too small or too far away"
        )
    if scale_percent > POOR_SCALE_PERCENT:
        what = "the camera height" if length_given else "a length on the floor"
        warnings.append(f"{what} is uncertain by {scale_percent:.0f} % for half a pixel of click error")
    return tuple(warnings)


def check_up(clicks, conditions, world_from_panorama):
    """Warnings about what the picks could not say: which way is up, the azimuth, which sides of a wall stand."""
    warnings = []
    tilt_deg = np.degrees(np.arccos(np.clip(world_from_panorama[2, 2], -1.0, 1.0)))
    if not (clicks.floor_clicks() or clicks.ceiling_clicks()):
        warnings.append("no pick lies on floor or ceiling: the panorama's own top was taken for up")
    elif tilt_deg > 90.0:
        warnings.append(
            f"the panorama is upside down (tilt {tilt_deg:.1f}°); if it is not, picks on the ceiling were called floor "
            f"or the other way round"
        )
    if not conditions.families:
        warnings.append(
            "nothing gives an azimuth: +x stays where the panorama has it; add a rectangle or parallels"
        )
    walls = [quad for quad in clicks.quads if quad.plane == "WALL"]
    if len(walls) == 1 and len(clicks.quads) == 1 and not clicks.lines and anchor_quad(clicks) is not None:
        lean_deg = np.degrees(
            np.arccos(np.abs(side_directions(clicks.directions[list(walls[0].clicks)])[:, 2]))
        )
        if abs(lean_deg[0] - lean_deg[1]) < UNDECIDED_SIDES_DEG:
            warnings.append(
                f"{walls[0].name}: its sides lean {lean_deg[0]:.0f}° and {lean_deg[1]:.0f}° against the panorama's own "
                f"vertical, so which ones are upright is a guess; add a vertical or a floor rectangle"
            )
    return warnings
