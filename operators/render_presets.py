"""The operator behind the presets of render quality."""

import bpy
from bl_operators.presets import AddPresetBase

FOLDER = "expanded_panoramas/render"
"""Below Blender's folders of presets."""


class PANORAMA_OT_render_preset_add(AddPresetBase, bpy.types.Operator):
    """Keep method, samples and denoising as a preset of your own, or remove one"""

    bl_idname = "panorama.render_preset_add"
    bl_label = "Add Render Quality Preset"
    preset_menu = "PANORAMA_PT_render_presets"
    preset_subdir = FOLDER
    preset_defines = ["job = bpy.context.scene.panorama_set.job"]
    preset_values = [f"job.{name}" for name in ("method", "samples", "denoise")]


classes = (PANORAMA_OT_render_preset_add,)
