"""The sidebar's step from a place to a panorama in layers, and from there to objects and other programs."""

import bpy

from ..operators.layers import layers_missing, making_missing
from .steps import Step


class PANORAMA_PT_layers(Step, bpy.types.Panel):
    """Step 7."""

    bl_label = "7  Layers"
    bl_options = {"DEFAULT_CLOSED"}

    def is_done(self, scene):
        """There are layers in the folder."""
        return not layers_missing(scene)

    def draw(self, context):
        """The folder, how layers are made, and what can be done with them."""
        scene, layout = context.scene, self.layout
        layers = scene.panorama_layers
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(layers, "folder")
        for name in ("radius", "width", "most", "infinity", "geometry"):
            column.prop(layers, name)
        self.say(context, making_missing(scene))
        layout.operator("panorama.make_layers", icon="RENDERLAYERS")
        if layers.found:
            self.say(context, layers.found, "CHECKMARK")
        else:
            self.say(context, layers_missing(scene), "ERROR" if layers.problem else "INFO")
        column = layout.column(align=True)
        column.operator("panorama.open_layers", icon="IMPORT")
        column.operator("panorama.export_layers", text="Export Layers...", icon="EXPORT")


classes = (PANORAMA_PT_layers,)
