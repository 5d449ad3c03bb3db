"""The sidebar's box in step 4 for lights that a photograph of a ball tells."""

import bpy

from ..operators.light_probe import told_by_photo
from .steps import InSidebar
from .texts import figure, paragraph


class PANORAMA_PT_light_of_photo(InSidebar, bpy.types.Panel):
    """Buttons, and what the last photograph told."""

    bl_label = "Light from a Photo"
    bl_parent_id = "PANORAMA_PT_objects"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Lights and panorama of a ball; the suns that there are, and what is doubtful about them."""
        layout = self.layout
        column = layout.column(align=True)
        column.operator("panorama.lights_of_probe", text="Lights from Probe Photo...", icon="LIGHT_SUN")
        column.operator("panorama.panorama_of_ball", text="Panorama from Mirror Ball...", icon="WORLD")
        told = told_by_photo(context.scene)
        if told is None:
            paragraph(layout, context, "Photograph a mirror or matte ball where the new objects will stand")
            return
        box = layout.box().column(align=True)
        figure(box, "Photo", told.photo)
        for name, altitude_deg, strength in told.lights:
            figure(box, name, f"{altitude_deg:.0f}° high, strength {strength:.2g}")
        for warning in told.warnings:
            paragraph(box, context, warning, "ERROR")


classes = (PANORAMA_PT_light_of_photo,)
