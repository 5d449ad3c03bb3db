"""The Image Editor's sidebar tab "Panorama": points are set to where its 2D cursor is."""

import bpy

from .lists import draw_picks, draw_shapes
from .shape_buttons import draw_buttons
from .texts import paragraph


class _InImageEditor:
    bl_space_type, bl_region_type, bl_category = "IMAGE_EDITOR", "UI", "Panorama"


class PANORAMA_PT_cursor(_InImageEditor, bpy.types.Panel):
    """How points are picked."""

    bl_label = "Panorama Cursor"

    def draw(self, context):
        """Where the cursor is, and how to move it."""
        space, layout = context.space_data, self.layout
        if space.ui_mode != "MASK":  # elsewhere Blender neither draws the cursor nor lets it be placed
            layout.prop_enum(space, "ui_mode", "MASK", text="Show 2D Cursor", icon="PIVOT_CURSOR")
            return
        text = "Shift + right click places the cursor; the button beside a point sets it there"
        paragraph(layout, context, text)
        layout.prop(space, "cursor_location", text="Cursor")


class PANORAMA_PT_pick_points(_InImageEditor, bpy.types.Panel):
    """The calibration's picks."""

    bl_label = "Calibration Picks"

    def draw(self, context):
        """The list, with buttons for points."""
        draw_picks(self.layout, context.scene.panorama_set, from_cursor=True)


class PANORAMA_PT_shape_points(_InImageEditor, bpy.types.Panel):
    """The shapes' points."""

    bl_label = "Shapes"

    def draw(self, context):
        """Drawn with the mouse, or the list, with buttons for points."""
        draw_buttons(self.layout, context)
        draw_shapes(self.layout, context, context.scene.panorama_set, from_cursor=True)


class PANORAMA_PT_by_click(_InImageEditor, bpy.types.Panel):
    """What a click on the picture does once it is calibrated."""

    bl_label = "By a Click"

    def draw(self, context):
        """Press the button, then click."""
        column = self.layout.column(align=True)
        column.operator("panorama.send_to_place", icon="TRACKER")
        column.operator("panorama.pick_sun", icon="EYEDROPPER")


classes = (PANORAMA_PT_cursor, PANORAMA_PT_by_click, PANORAMA_PT_pick_points, PANORAMA_PT_shape_points)
