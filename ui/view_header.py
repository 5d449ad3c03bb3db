"""The 3D View's header: panorama on or off, and how it is shown."""

import bpy


class PANORAMA_PT_view(bpy.types.Panel):
    """How 3D views show the panorama"""

    bl_label = "Panorama Background"
    bl_space_type, bl_region_type = "VIEW_3D", "HEADER"
    bl_ui_units_x = 12

    def draw(self, context):
        """Settings of the view, and ways to look."""
        view, layout = context.scene.panorama_view, self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        column = layout.column()
        column.active = view.show_background
        column.prop(view, "exposure")
        row = column.row()
        row.active = context.space_data.shading.type == "WIREFRAME"
        row.prop(view, "opacity", text="Wireframe Mix", slider=True)
        column = layout.column(heading="Show")
        column.prop(view, "show_calibration")
        column.prop(context.space_data.overlay, "show_floor", text="Blender's Grid")
        layout.operator("panorama.look_around", icon="ORIENTATION_GIMBAL")


def draw_toggle(self, context):
    """The button and its pop-over, where the scene has a panorama."""
    scene = context.scene
    if scene.panorama_set.image is None and scene.panorama_place.image is None:
        return
    row = self.layout.row(align=True)
    row.prop(scene.panorama_view, "show_background", text="", icon="WORLD")
    row.popover("PANORAMA_PT_view", text="")


classes = (PANORAMA_PT_view,)


def register():
    """Put the button into the header."""
    bpy.types.VIEW3D_HT_header.append(draw_toggle)


def unregister():
    """Take it out."""
    bpy.types.VIEW3D_HT_header.remove(draw_toggle)
