"""What people look at: panels, overlays and menus."""

import bpy

from . import image_editor, lists, overlays, picture_panels, place_panels, shape_buttons

PANELS = (lists, shape_buttons, place_panels, picture_panels, image_editor)


def register():
    """Register lists and panels."""
    for module in PANELS:
        for cls in module.classes:
            bpy.utils.register_class(cls)
    overlays.register()


def unregister():
    """Take them back, in reverse."""
    overlays.unregister()
    for module in reversed(PANELS):
        for cls in reversed(module.classes):
            bpy.utils.unregister_class(cls)
