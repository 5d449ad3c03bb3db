"""What is drawn over the panorama in 3D Views and Image Editors: its calibration, and the tool that runs."""

import bpy

from ..operators.canvas import canvas_of
from . import pick_overlay, shape_overlay

OVERLAYS = (pick_overlay, shape_overlay)
SPACES = (bpy.types.SpaceView3D, bpy.types.SpaceImageEditor)
_handles = []


def draw():
    """Draw all overlays in the region that Blender draws now."""
    context = bpy.context
    area, region, space = context.area, context.region, context.space_data
    if area is None or (area.type == "VIEW_3D" and not space.overlay.show_overlays):
        return
    canvas = canvas_of(context, area, region)
    if canvas is not None:
        for overlay in OVERLAYS:
            overlay.draw(context, canvas)


def register():
    """Draw from now on."""
    for space in SPACES:
        _handles.append((space, space.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")))


def unregister():
    """Draw no more."""
    while _handles:
        space, handle = _handles.pop()
        space.draw_handler_remove(handle, "WINDOW")
