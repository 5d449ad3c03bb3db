"""What the picking tool says beside its picks: what is to be clicked, and what the clicks give."""

import textwrap

from ..operators.canvas import free_area
from ..operators.conversion import pick_label
from . import drawing
from .texts import LETTER

PLAIN, GOOD, WARNING, ERROR = (1, 1, 1, 1), (0.6, 1, 0.6, 1), (1, 0.8, 0.3, 1), (1, 0.65, 0.55, 1)
TEXT, LINE, MARGIN = 12, 24, 16
"""Size of letters, distance of lines, and from the border [px at a UI scale of 1]."""


def draw(context, tool, factor):
    """Draw the lines at the lower left of a region; factor: by how much ellipses are enlarged."""
    scale = drawing.scale()
    (left, bottom), (right, _) = free_area(context.area, context.region)
    letters = max(int((right - left) / (LETTER * scale)) - 4, 24)
    wrapped = [
        (part, colour) for line, colour in lines(tool, factor) for part in textwrap.wrap(line, letters)
    ]
    for row, (line, colour) in enumerate(reversed(wrapped)):
        drawing.text(
            (left + MARGIN * scale, bottom + (MARGIN + row * LINE) * scale), line, colour, TEXT, backed=True
        )


def lines(tool, factor=0):
    """(sentence, colour) from the top."""
    live = tool.live
    found = [(_task(tool), PLAIN), (_scale(tool), PLAIN)]
    if tool.problem:
        found.append((tool.problem, WARNING))
    if live.calibration is not None:
        found += [(figures(live), GOOD)]
        found += [(warning, WARNING) for warning in live.calibration.warnings]
    if live.problem:
        found.append((live.problem, ERROR))
    if live.missing:
        found.append((f"To calibrate: {live.missing}", WARNING))
    if factor:
        size = "" if factor == 1 else f", drawn {factor} times as large"
        found.append((f"Ellipses: one standard deviation for half a pixel of click error{size}", PLAIN))
    return found


def figures(live):
    """The calibration in one line."""
    found, pixels = live.calibration, live.report.residual_pixels
    return (
        f"Tilt {found.tilt_deg:.2f}° ± {found.uncertainty_tilt_deg:.2f}°    "
        f"Residual {(pixels**2).mean() ** 0.5:.2f} px, largest {pixels.max():.2f} px    "
        f"Condition {found.condition:.1f} (1 is best)"
    )


def _task(tool):
    editing = tool.editing
    snapping = "Snapping to corners" if tool.snapping else "Not snapping"
    if editing.target < 0:
        return f"Drag points. {snapping} (S)"
    pick = editing.copied.picks[editing.target]
    label = pick_label(pick, editing.target).partition(": ")[2] + (" (P)" if editing.has_plane else "")
    if pick.missing:
        return f"{label}: click point {pick.missing[0] + 1} of {len(pick.points)}. {snapping} (S)"
    more = "click the next line, " if editing.adds == pick.kind else ""
    return f"{label}: {more}drag points, Enter to calibrate. {snapping} (S)"


def _scale(tool):
    length = tool.editing.length
    name = "Camera height" if length is None else "Known length"
    metres = tool.editing.copied.camera_height if length is None else length.metres
    if tool.typed:
        return f"{name}: {tool.typed}_"
    return f"{name}: {tool.lengths.text(metres)} (type to change)" if metres > 0 else f"{name}: type it"
