"""What people look at: panels, overlays and menus."""

import bpy

from . import (
    background,
    file_handlers,
    image_editor,
    layer_panel,
    lists,
    menus,
    overlays,
    picture_panels,
    place_panels,
    probe_panel,
    render_presets,
    shadow_panel,
    shape_buttons,
    view_header,
)

PANELS = (
    lists,
    shape_buttons,
    render_presets,
    place_panels,
    picture_panels,
    probe_panel,
    layer_panel,
    shadow_panel,
    image_editor,
    menus,
    file_handlers,
    view_header,
)
HOOKS = (menus, render_presets, view_header, background, overlays)
"""What enters Blender's own menus, folders and editors."""


def register():
    """Register lists and panels."""
    for module in PANELS:
        for cls in module.classes:
            bpy.utils.register_class(cls)
    for module in HOOKS:
        module.register()


def unregister():
    """Take them back, in reverse."""
    for module in reversed(HOOKS):
        module.unregister()
    for module in reversed(PANELS):
        for cls in reversed(module.classes):
            bpy.utils.unregister_class(cls)
