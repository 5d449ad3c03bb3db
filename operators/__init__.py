"""Blender operators and property groups: read the scene, call one function, report."""

import bpy

from . import (
    asset_library,
    calibration,
    clipped_light,
    layer_properties,
    layers,
    light,
    light_probe,
    light_probe_panorama,
    long_work,
    picking,
    pictures,
    placing,
    probes,
    properties,
    render_job,
    render_presets,
    set_files,
    shadow_lights,
    shadow_page,
    shadow_preview,
    shadow_preview_properties,
    sun_picker,
    sun_position,
    surfaces,
    view_properties,
    viewing,
)
from .tools import base, draw_shape, pick_points

OPERATORS = (
    long_work,
    set_files,
    picking,
    pick_points,
    calibration,
    draw_shape,
    probes,
    placing,
    sun_picker,
    sun_position,
    light_probe,
    light_probe_panorama,
    surfaces,
    viewing,
    light,
    clipped_light,
    pictures,
    render_presets,
    layers,
    shadow_lights,
    shadow_preview,
    shadow_page,
    asset_library,
)


def register():
    """Register the scene's panorama set, its view settings and layers, then the operators on them."""
    properties.register()
    view_properties.register()
    layer_properties.register()
    shadow_preview_properties.register()
    base.register()
    for module in OPERATORS:
        for cls in module.classes:
            bpy.utils.register_class(cls)


def unregister():
    """Take them back, in reverse."""
    render_job.unregister()
    long_work.unregister()
    for module in reversed(OPERATORS):
        for cls in reversed(module.classes):
            bpy.utils.unregister_class(cls)
    base.unregister()
    shadow_preview_properties.unregister()
    layer_properties.unregister()
    view_properties.unregister()
    properties.unregister()
