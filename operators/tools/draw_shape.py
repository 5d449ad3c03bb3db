"""The operator that draws shapes of the place on its floor with the mouse."""

import bpy
import numpy as np

from ...ibl_toolkit.drawing import FLAT, floor_shape
from ...ibl_toolkit.drawn_shape import ROOM, DrawnShape
from ...ibl_toolkit.equirectangular import direction_from_uv
from ...ibl_toolkit.stand import Stand
from .. import conversion, progress, solving
from ..canvas import calibration_of
from ..properties import SHAPE_KINDS
from ..reporting import possible
from .base import ToolOperator
from .draw_tool import DrawTool
from .lengths import Lengths

DRAWN_KINDS = (
    (
        ROOM,
        "Room",
        "The corners of the floor, then walls with a ceiling over it, raised to a point of their edge",
    ),
    *SHAPE_KINDS,
)


class PANORAMA_OT_draw_shape(ToolOperator, bpy.types.Operator):
    """Draw a shape of the real place on its floor with the mouse, in a 3D View or on the flat image"""

    bl_idname = "panorama.draw_shape"
    bl_label = "Draw Shape"

    kind: bpy.props.EnumProperty(name="Kind", description="What is drawn", items=DRAWN_KINDS)
    of: bpy.props.StringProperty(
        name="Over",
        description="The flat shape over which walls are raised; the selected or last one if empty",
    )

    @classmethod
    def poll(cls, context):
        """There must be a calibrated floor to draw on."""
        return possible(cls, progress.drawing_missing(context.scene) or _wrong_mode(context))

    def make_tool(self, context):
        """Begin with nothing, or for walls with the shape that they stand over."""
        scene = context.scene
        stand = Stand(*calibration_of(scene))
        over = _over(scene.panorama_set, stand, self.of) if self.kind == "walls" else (None, None)
        shape = DrawnShape(self.kind, stand, over)
        return DrawTool(shape, Lengths.of_scene(scene), context.preferences.system.ui_scale or 1)

    def work(self, context):
        """Add what was drawn to the set and build it. Where that fails, the tool goes on and says why."""
        state, stand = context.scene.panorama_set, self.tool.shape.stand
        try:
            if not stand.is_close(*calibration_of(context.scene)):
                raise ValueError("the calibration has changed since: cancel, and draw it again")
            shapes = self.tool.result(lambda name: conversion.free_name(state, name))
            solving.add_shapes(context.scene, shapes)
        except (ValueError, OSError) as error:
            self.tool.refuse(str(error))
            raise
        for shape in list(state.shapes)[-len(shapes) :]:
            for warning in shape.warnings.splitlines():
                self.report({"WARNING"}, f"{shape.name}: {warning}")
        return f"Built {' and '.join(shape.name for shape in shapes)}"


def _wrong_mode(context):
    return "" if context.mode == "OBJECT" else "Only in Object Mode"


def _over(state, stand, name):
    """Name and FloorShape of the flat shape over which walls are raised."""
    flat = [shape for shape in state.shapes if shape.kind in FLAT and all(p.picked for p in shape.points)]
    active = state.shapes[state.active_shape : state.active_shape + 1]
    wanted = (
        [shape for shape in flat if shape.name == name]
        if name
        else [s for s in active if s in flat] or flat[-1:]
    )
    if not wanted:
        missing = f"no flat shape is called '{name}'" if name else "draw a flat shape first"
        raise ValueError(f"{missing}: walls stand over one")
    directions = direction_from_uv([point.uv for point in wanted[0].points])
    points = [stand.floor_under(np.zeros(3), direction) for direction in directions]
    return wanted[0].name, floor_shape(wanted[0].kind, points, stand.camera_height)


classes = (PANORAMA_OT_draw_shape,)
