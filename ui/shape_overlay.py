"""Shapes over the panorama: the one being drawn, with its sizes, and the outlines of those that are built.

In 3D Views these are meshes; but while a tool runs there, the panorama covers them.
"""

import textwrap

import numpy as np

from ..ibl_toolkit.drawing import sizes, wireframe
from ..ibl_toolkit.drawn_shape import on_floor
from ..ibl_toolkit.overlay import ROLE_COLOURS, segment_points
from ..operators.canvas import ImageCanvas, free_area
from ..operators.tools import active_tool
from ..operators.tools.draw_tool import DrawTool
from ..operators.tools.shape_lines import built_lines
from . import drawing

COLOURS = {role: tuple(value / 255 for value in colour) for role, colour in ROLE_COLOURS.items()}
BUILT_ALPHA = 0.55
WRONG, CAUTION = (1, 0.45, 0.4, 1), (1, 0.8, 0.3, 1)
ASTRAY = "Seen from here, the picture does not lie on the floor: Look Around shows it in its place"
BESIDE = np.array([16.0, 12.0])
"""Where text stands from what it is about [px of a plain screen]."""
LETTER = (6.5, 14)
"""Room for a letter [px of a plain screen]."""
LINE, WIDEST = 24, 56
"""Distance of lines [px of a plain screen], and letters in one."""


def draw(context, canvas):
    """Draw the shapes in a region that shows the panorama."""
    tool = active_tool()
    if context.space_data.overlay.show_overlays and (tool is not None or isinstance(canvas, ImageCanvas)):
        for role, segments in built_lines(context.scene).items():
            drawing.lines(_curves(canvas, segments), (*COLOURS[role], BUILT_ALPHA), 1)
    if isinstance(tool, DrawTool):
        _draw_tool(canvas, tool)
        if tool.region == context.region.as_pointer():
            _draw_at_mouse(context, canvas, tool)


def _draw_tool(canvas, tool):
    shape = tool.shape
    points, base, height, _ = tool.preview()
    colour = (*COLOURS[shape.role], 1)
    lines = [on_floor(points)] if base is None else wireframe(base.outline, height)
    segments = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    drawing.lines(_curves(canvas, shape.stand.from_origin(segments)), colour, 2)
    for point in shape.points:
        drawing.dots(_pixels(canvas, shape, (*point, 0)), colour)
    said = [((*middle, 0), length) for middle, length in sizes(shape.flat, points, base)]
    if height is not None:
        edge = tool.top[:2] if tool.top is not None else base.outline[0]
        said.append(((*edge, height), height))
    texts = [(_pixels(canvas, shape, point), tool.lengths.text(length)) for point, length in said]
    _draw_labels(reversed(texts))


def _draw_at_mouse(context, canvas, tool):
    """What was typed, and what is wrong, beside the mouse and within the region."""
    problem = tool.problem or tool.preview()[3]
    is_known = canvas.has_floor_in_place or tool.takes_numbers  # once it has begun, it was read
    said = [(problem, WRONG), ("" if is_known or problem else ASTRAY, CAUTION)]
    lines = [(line, colour) for text, colour in said for line in reversed(textwrap.wrap(text, WIDEST))]
    if tool.typed:
        lines.insert(0, (tool.typed, (1, 1, 1, 1)))
    scale = drawing.scale()
    rightmost = free_area(context.area, context.region)[1][0] - LETTER[0] * scale * max(
        (len(line) for line, _ in lines), default=0
    )
    left, bottom = tool.xy + 2 * BESIDE * scale
    for row, (line, colour) in enumerate(lines):
        drawing.text((min(left, rightmost), bottom + row * LINE * scale), line, colour, backed=True)


def _draw_labels(texts):
    """Draw (pixels (2,), string), the first ones where there isn't room for all."""
    taken = []
    for pixels, string in texts:
        low = pixels + BESIDE / 2 * drawing.scale()
        high = low + np.array([LETTER[0] * len(string), LETTER[1]]) * drawing.scale()
        if not any((low < other_high).all() and (other_low < high).all() for other_low, other_high in taken):
            drawing.text(low, string, backed=True)
            taken.append((low, high))


def _pixels(canvas, shape, point):
    return canvas.curve_of(shape.stand.from_origin(np.array([point], float)))[0]


def _curves(canvas, segments):
    """Pixels (n, 2) of straight segments (m, 2, 3) of the panorama frame [m]; NaN between them."""
    gap = np.full((1, 2), np.nan)
    curves = [part for ends in segments for part in (canvas.curve_of(segment_points(*ends)), gap)]
    return np.concatenate(curves) if curves else gap
