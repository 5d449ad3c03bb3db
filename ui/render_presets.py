"""Presets of render quality in the header of the step Render: three of the extension, and the user's own.

They are Blender's presets: small scripts, those of the extension below `presets/` beside this file, the
user's where Blender keeps all presets.
"""

from pathlib import Path

import bpy
from bl_ui.utils import PresetPanel

from ..operators.render_presets import FOLDER


class PANORAMA_PT_render_presets(PresetPanel, bpy.types.Panel):
    """The menu of presets."""

    bl_label = "Render Quality Presets"
    preset_subdir = FOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = "panorama.render_preset_add"


classes = (PANORAMA_PT_render_presets,)


def register():
    """Let Blender find the extension's own presets."""
    bpy.utils.register_preset_path(str(Path(__file__).parent))


def unregister():
    """No more."""
    bpy.utils.unregister_preset_path(str(Path(__file__).parent))
