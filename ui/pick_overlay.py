"""The calibration drawn over the panorama: horizon, vertical planes, picks; live while they are picked."""

import numpy as np

from ..ibl_toolkit.equirectangular import direction_from_uv, uv_from_direction
from ..ibl_toolkit.overlay import HORIZON_COLOUR, XZ_COLOUR, YZ_COLOUR
from ..operators.canvas import calibration_of, free_area
from ..operators.tools import active_tool
from ..operators.tools.pick_tool import PickTool
from ..operators.tools.picks_copy import PicksCopy, solve_live
from . import drawing, magnifier, pick_texts
from .panorama_curves import circle, curve_pixels, segments

CLICKED, SOLVED = (1, 1, 1, 0.9), (1, 0.75, 0.2, 0.95)
TARGET, SELECTED = (1, 0.55, 0.1, 1), (1, 1, 0.3, 1)
FAINT = 0.55
ENLARGED = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
VISIBLE_PIXELS = 14
"""Half the length from which an ellipse can be read [px at a UI scale of 1]; shorter ones are enlarged."""
LARGE_RESIDUAL = 1.5
"""Of a click [px of the image]: careful ones err by half a pixel to that."""
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
    solved, clicked, dots = [], {TARGET: [], CLICKED: []}, {TARGET: [], CLICKED: []}
    for number, pick in enumerate(copied.picks):
        colour = TARGET if number == target else CLICKED
        for pair in _pairs(pick):
            clicked[colour].append(pair)
            indices = [] if live.report is None else live.report.indices(pair)
            if len(indices) and min(indices) >= 0:
                solved.append(live.report.corrected[indices])
        dots[colour] += [point.uv for point in pick.points if point.picked]
    for colour, pairs in clicked.items():
        _draw_sides(canvas, direction_from_uv(np.reshape(pairs, (-1, 2, 2))), _faded(colour, alpha))
    _draw_sides(canvas, np.reshape(solved, (-1, 2, 3)), _faded(SOLVED, alpha), 1)
    for colour, uv in dots.items():
        drawing.dots(canvas.pixels_of(np.reshape(uv, (-1, 2))), _faded(colour, alpha), 4)


def _draw_sides(canvas, ends, colour, width=1.5):
    """Straight lines of the place between directions (m, 2, 3)."""
    if len(ends):
        drawing.lines(curve_pixels(canvas, segments(ends[:, 0], ends[:, 1])), colour, width)


def _pairs(pick):
    """The image points that are joined, two by two: a rectangle's sides so far, or the ends of each line."""
    points = [point.uv if point.picked else None for point in pick.points]
    is_rectangle = pick.kind == "RECTANGLE"
    joined = (
        zip(points, points[1:] + points[:1], strict=True)
        if is_rectangle
        else zip(points[::2], points[1::2], strict=True)
    )
    return [pair for pair in joined if None not in pair]


def _draw_ellipses(canvas, live, region_size):
    """One standard deviation of each corrected click; returns by how much they are enlarged, 0 for none."""
    report = live.report
    if report is None:
        return 0
    axes = report.half_axes()
    middles = canvas.pixels_of(uv_from_direction(report.corrected))
    ends = canvas.pixels_of(uv_from_direction(report.corrected[:, None] + np.swapaxes(axes, 1, 2)))
    lengths = np.linalg.norm(ends - middles[:, None], axis=-1).max(axis=1)
    shown = ((middles > 0) & (middles < region_size)).all(axis=1) & np.isfinite(lengths)
    if not shown.any():
        return 0
    least = VISIBLE_PIXELS * drawing.scale() / max(np.median(lengths[shown]), 1e-9)
    factor = next((factor for factor in ENLARGED if factor >= least), ENLARGED[-1])
    turns = np.linspace(0, 2 * np.pi, drawing.ELLIPSE_STEPS)
    unit = factor * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    rims = report.corrected[shown][:, None] + unit @ np.swapaxes(axes[shown], 1, 2)
    drawing.lines(curve_pixels(canvas, rims), SOLVED, 1)
    return factor


def _draw_labels(canvas, editing, live):
    """Number and residual of the points of the pick that is being filled; of others where it is large."""
    for number, pick in enumerate(editing.copied.picks):
        for k, point in enumerate(pick.points):
            if not point.picked:
                continue
            index = -1 if live.report is None else live.report.indices(point.uv)[0]
            residual = 0.0 if index < 0 else live.report.residual_pixels[index]
            if number == editing.target or residual > LARGE_RESIDUAL:
                said = f"{k + 1}" if number == editing.target else ""
                said += f"  {residual:.2f} px" if index >= 0 else ""
                place = canvas.pixels_of(np.array(point.uv)) + 12 * drawing.scale()
                colour = pick_texts.WARNING if residual > LARGE_RESIDUAL else pick_texts.PLAIN
                drawing.text(place, said.strip(), colour, 11, backed=True)


def _opaque(colour, alpha):
    return (*(channel / 255 for channel in colour), alpha)


def _faded(colour, alpha):
    return (*colour[:3], colour[3] * alpha)
