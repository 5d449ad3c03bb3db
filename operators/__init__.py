"""Blender operators and property groups: read the scene, call one function, report."""

import bpy

from . import (
    calibration,
    clipped_light,
    draw_shape,
    light,
    picking,
    pictures,
    probes,
    properties,
    set_files,
    surfaces,
    tools,
    view_properties,
)

OPERATORS = (set_files, picking, calibration, draw_shape, probes, surfaces, light, clipped_light, pictures)


def register():
    """Register the scene's panorama set and its view settings, then the operators on them."""
    properties.register()
    view_properties.register()
    tools.register()
    for module in OPERATORS:
        for cls in module.classes:
            bpy.utils.register_class(cls)


def unregister():
    """Take them back, in reverse."""
    for module in reversed(OPERATORS):
        for cls in reversed(module.classes):
            bpy.utils.unregister_class(cls)
    tools.unregister()
    view_properties.unregister()
    properties.unregister()
