"""The sidebar's step to the shadows of small devices."""

import bpy

from ..operators.shadow_lights import MOST_LIGHTS, candidates, lights_of
from ..operators.shadow_preview import is_there, preview_missing
from .steps import Step

FILTERED = ("pcf", "vsm", "evsm")


class PANORAMA_PT_device_shadows(Step, bpy.types.Panel):
    """Step 8."""

    bl_label = "8  Device Shadows"
    bl_options = {"DEFAULT_CLOSED"}

    def is_done(self, scene):
        """There is a preview."""
        return is_there(scene.panorama_shadow_preview)

    def draw(self, context):
        """Lights, method, offset, looks; and what makes and removes the preview."""
        layout, preview = self.layout, context.scene.panorama_shadow_preview
        exists = is_there(preview)
        self._draw_lights(context, preview)
        for names in (_map_names(preview), _offset_names(preview), ("darkness", "replaces_own")):
            column = layout.column(align=True)
            column.use_property_split, column.use_property_decorate = True, False
            for name in names:
                column.prop(preview, name)
        self.say(context, preview_missing(context))
        column = layout.column(align=True)
        column.operator("panorama.preview_shadows", icon="SHADING_RENDERED")
        column.operator("panorama.composite_shadows", icon="NODE_COMPOSITING")
        column.operator("panorama.export_shadow_page", text="Export Shadow Page...", icon="EXPORT")
        if not exists:
            return
        self.say(context, preview.problem, "ERROR")
        row = layout.row(align=True)
        row.prop(preview, "keep_current", toggle=True, icon="FILE_REFRESH")
        if not preview.keep_current:
            row.operator("panorama.renew_shadow_preview", text="Renew")
        layout.operator("panorama.remove_shadow_preview", icon="TRASH")

    def _draw_lights(self, context, preview):
        """A row for each light; below, what adds one more."""
        column = self.layout.column(align=True)
        for index, light in enumerate(preview.lights):
            row = column.row(align=True)
            row.prop(light, "light", text="")
            row.operator("panorama.remove_shadow_light", text="", icon="REMOVE").index = index
        if not lights_of(preview):
            names = ", ".join(f"'{light.name}'" for light in candidates(context)[:MOST_LIGHTS])
            self.say(context, f"None chosen, so {names}" if names else "")
        if len(preview.lights) < MOST_LIGHTS:
            column = self.layout.column(align=True)
            column.prop(preview, "another", text="", icon="LIGHT", placeholder="Add Light")
            row = column.row(align=True)
            for which, text in (("SELECTED", "Add Selected"), ("VISIBLE", "Add All Visible")):
                row.operator("panorama.add_shadow_lights", text=text).which = which


def _map_names(preview):
    names = ["method", "resolution", "storage"]
    if preview.method in FILTERED:
        names.append("window")
    return names


def _offset_names(preview):
    if preview.offset_by_itself:
        return ["offset_by_itself"]
    names = ["offset_by_itself", "offset_factor", "offset_units"]
    if preview.method in ("vsm", "evsm"):
        names.append("bleeding_reduction")
    return [*names, "exponent"] if preview.method == "evsm" else names


classes = (PANORAMA_PT_device_shadows,)
