"""The calibration drawn over the panorama: horizon, vertical planes, picks; live while they are picked."""

import numpy as np

from ..ibl_toolkit.equirectangular import direction_from_uv, uv_from_direction
from ..ibl_toolkit.overlay import HORIZON_COLOUR, XZ_COLOUR, YZ_COLOUR
from ..operators.canvas import calibration_of, free_area
from ..operators.pick_tool import PickTool
from ..operators.picks_copy import PicksCopy, solve_live
from ..operators.tools import active_tool
from . import drawing, magnifier, pick_texts
from .panorama_curves import circle, curve_pixels, outline

CLICKED, SOLVED = (1, 1, 1, 0.9), (1, 0.75, 0.2, 0.95)
TARGET, SELECTED = (1, 0.55, 0.1, 1), (1, 1, 0.3, 1)
FAINT = 0.55
ENLARGED = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
VISIBLE_PIXELS = 14
"""Half the length from which an ellipse can be read [px at a UI scale of 1]; shorter ones are enlarged."""
_stored = [None, None]  # what was solved last where no tool runs: (picks, size), Live


def draw(context, canvas):
    """Draw what belongs to the scene in one editor."""
    tool, scene = active_tool(), context.scene
    if isinstance(tool, PickTool):
        if tool.scene_name == scene.name:
            _draw_tool(context, canvas, tool)
    elif tool is None and scene.panorama_view.show_calibration:
        _draw_stored(canvas, scene)


def _draw_tool(context, canvas, tool):
    live, editing = tool.live, tool.editing
    if live.calibration is not None:
        _draw_planes(canvas, live.calibration.world_from_panorama, 1.0)
    factor = _draw_ellipses(canvas, live, (context.region.width, context.region.height))
    is_here = tool.region == context.region.as_pointer()
    if is_here or not tool.region:  # where the artist looks, or else everywhere
        pick_texts.draw(context, tool, factor)
    _draw_picks(canvas, editing.copied, live, editing.target, 1.0)
    _draw_labels(canvas, editing, live)
    if editing.active is not None:
        place = canvas.pixels_of(np.array(editing.point(editing.active).uv))
        drawing.dots(place, SELECTED, 5)
    if is_here and tool.xy is not None and tool.image is not None and canvas.uv_at(tool.xy) is not None:
        exposure = context.scene.panorama_view.exposure
        _, free = free_area(context.area, context.region)
        magnifier.draw(canvas, tool.xy, tool.image, exposure, free, tool.snapped(canvas, tool.xy))


def _draw_stored(canvas, scene):
    state = scene.panorama_set
    if state.result.is_solved:
        _draw_planes(canvas, calibration_of(scene)[0], FAINT)
    size = tuple(state.image.size)
    if len(state.picks) and size[0]:
        asked = PicksCopy.of(state), size
        if _stored[0] != asked:
            _stored[:] = asked, solve_live(*asked)
        _draw_picks(canvas, asked[0], _stored[1], -1, FAINT)


def _draw_planes(canvas, world_from_panorama, alpha):
    """The horizon, and where the world's planes xz and yz cut the panorama: Fig. 5-3."""
    x, y, z = world_from_panorama
    for first, second, colour in ((y, z, YZ_COLOUR), (x, z, XZ_COLOUR), (x, y, HORIZON_COLOUR)):
        drawing.lines(curve_pixels(canvas, circle(first, second)), _opaque(colour, alpha))


def _draw_picks(canvas, copied, live, target, alpha):
    """Each pick as clicked, and as the solution sees it."""
    for number, pick in enumerate(copied.picks):
        colour = TARGET if number == target else CLICKED
        for group, closed in _groups(pick):
            uv = np.array([point.uv for point in group])
            drawing.lines(
                curve_pixels(canvas, outline(direction_from_uv(uv), closed=closed)), _faded(colour, alpha)
            )
            corrected = _corrected(live, uv)
            if corrected is not None:
                curve = curve_pixels(canvas, outline(corrected, closed=closed))
                drawing.lines(curve, _faded(SOLVED, alpha), 1)
        picked = np.array([point.uv for point in pick.points if point.picked]).reshape(-1, 2)
        drawing.dots(canvas.pixels_of(picked), _faded(colour, alpha), 4)


def _groups(pick):
    """Points that are joined, and whether they close: a rectangle's so far, or the ends of each line."""
    if pick.kind == "RECTANGLE":
        picked = [point for point in pick.points if point.picked]
        return [(picked, not pick.missing)] if len(picked) > 1 else []
    pairs = zip(pick.points[::2], pick.points[1::2], strict=False)
    return [(pair, False) for pair in pairs if pair[0].picked and pair[1].picked]


def _corrected(live, uv):
    """Where the solution puts clicks (k, 2): directions (k, 3); None where it says nothing about them."""
    if live.report is None:
        return None
    indices = live.report.indices(uv)
    return live.report.corrected[indices] if (indices >= 0).all() else None


def _draw_ellipses(canvas, live, region_size):
    """One standard deviation of each corrected click; returns by how much they are enlarged, 0 for none."""
    report = live.report
    if report is None:
        return 0
    axes = np.stack([report.half_axes(k) for k in range(len(report.uv))])
    middles = canvas.pixels_of(uv_from_direction(report.corrected))
    ends = canvas.pixels_of(uv_from_direction(report.corrected[:, None] + np.swapaxes(axes, 1, 2)))
    lengths = np.linalg.norm(ends - middles[:, None], axis=-1).max(axis=1)
    shown = ((middles > 0) & (middles < region_size)).all(axis=1) & np.isfinite(lengths)
    if not shown.any():
        return 0
    least = VISIBLE_PIXELS * drawing.scale() / max(np.median(lengths[shown]), 1e-9)
    factor = next((factor for factor in ENLARGED if factor >= least), ENLARGED[-1])
    for k in np.flatnonzero(shown):
        turns = np.linspace(0, 2 * np.pi, drawing.ELLIPSE_STEPS)
        rim = report.corrected[k] + factor * np.stack([np.cos(turns), np.sin(turns)], axis=1) @ axes[k].T
        drawing.lines(curve_pixels(canvas, rim), SOLVED, 1)
    return factor


def _draw_labels(canvas, editing, live):
    """Number and residual of the points of the pick that is being filled."""
    if editing.target < 0:
        return
    for number, point in enumerate(editing.copied.picks[editing.target].points, 1):
        if not point.picked:
            continue
        index = -1 if live.report is None else live.report.indices(point.uv)[0]
        residual = "" if index < 0 else f"  {live.report.residual_pixels[index]:.2f} px"
        offset = 9 * drawing.scale()
        drawing.text(canvas.pixels_of(np.array(point.uv)) + offset, f"{number}{residual}", size=11)


def _opaque(colour, alpha):
    return (*(channel / 255 for channel in colour), alpha)


def _faded(colour, alpha):
    return (*colour[:3], colour[3] * alpha)
