"""Buttons and a menu that draw shapes with the mouse, for sidebars and for Blender's Add menu."""

import bpy

from ..operators.tools.draw_shape import DRAWN_KINDS
from .lists import SHAPE_ICONS

ICONS = {**SHAPE_ICONS, "room": "HOME"}


class PANORAMA_MT_draw_shape(bpy.types.Menu):
    """The kinds of shapes that can be drawn."""

    bl_label = "Draw Shape"

    def draw(self, context):
        """The room first."""
        self.layout.operator_context = "INVOKE_REGION_WIN"
        for kind, name, _ in DRAWN_KINDS:
            icon = ICONS.get(kind, "MESH_PLANE")
            self.layout.operator("panorama.draw_shape", text=name, icon=icon).kind = kind


def draw_buttons(layout, context):
    """A button for the room, and the menu; in a 3D View first those that show the floor in its place."""
    if context.space_data is not None and context.space_data.type == "VIEW_3D":
        draw_looks(layout)
    row = layout.row(align=True)
    row.operator("panorama.draw_shape", text="Draw Room", icon=ICONS["room"]).kind = "room"
    row.menu("PANORAMA_MT_draw_shape", text="Draw Shape", icon="GREASEPENCIL")


def draw_looks(layout):
    """The two views in which the panorama shows the floor where it is."""
    row = layout.row(align=True)
    row.operator("panorama.look_around", icon="ORIENTATION_GIMBAL")
    row.operator("panorama.look_at_plan", icon="VIEW_ORTHO")


classes = (PANORAMA_MT_draw_shape,)
