"""Operators that show the shadow maps of small devices in materials."""

from __future__ import annotations

import bpy

from ..cycles_integration.roles import is_editable
from ..cycles_integration.shadow_preview import (
    COMPOSITOR,
    KINDS,
    SHADER,
    discard,
    has_surface,
    is_there,
    light_of,
    put_on,
    put_on_picture,
    renew,
    settings_of,
)
from . import shadow_watch
from .reporting import Reporting, possible

NO_LIGHT = "Add a light first: its shadow is shown"
NEW_MATERIAL = "Shadow Receiver"


class PANORAMA_OT_preview_shadows(Reporting, bpy.types.Operator):
    """Show on the selected objects the shadow of the light as a small device draws it: makes the shadow map
    and puts a node group before the output of their materials, in EEVEE and Cycles"""

    bl_idname = "panorama.preview_shadows"
    bl_label = "Preview Shadows"

    @classmethod
    def poll(cls, context):
        """There is a light, and something that receives its shadow."""
        return possible(cls, preview_missing(context))

    def work(self, context):
        """Make the map, and put the group on."""
        preview = context.scene.panorama_shadow_preview
        materials, bare, left = _sorted_out(_receivers(context))
        warnings = _make(context, SHADER)
        for material in materials + _clothed(bare):
            put_on(material, preview.group, preview.darkness)
        shadow_watch.looks_changed(preview, context)
        for warning in (*left, *warnings):
            self.report({"WARNING"}, warning[0].upper() + warning[1:])
        count = len(materials) + bool(bare)
        return f"Shadow of '{preview.light.name}' on {count} material{'s' * (count > 1)}; {size_of(preview)}"


class PANORAMA_OT_composite_shadows(Reporting, bpy.types.Operator):
    """Darken the rendered picture by the shadow of the light as a small device draws it: puts a node group
    before the output of the compositor, fed by the passes Position and Normal. Materials stay as they are"""

    bl_idname = "panorama.composite_shadows"
    bl_label = "Shadows in the Compositor"

    @classmethod
    def poll(cls, context):
        """There is a light."""
        return possible(cls, "" if light_for(context) else NO_LIGHT)

    def work(self, context):
        """Make the map, and put the group before the output."""
        preview = context.scene.panorama_shadow_preview
        warnings = _make(context, COMPOSITOR)
        put_on_picture(context.scene, context.view_layer, preview.composite_group, preview.darkness)
        shadow_watch.looks_changed(preview, context)
        for warning in warnings:
            self.report({"WARNING"}, warning[0].upper() + warning[1:])
        return f"Shadow of '{preview.light.name}' on the rendered picture; {size_of(preview)}"


class PANORAMA_OT_renew_shadow_preview(Reporting, bpy.types.Operator):
    """Make the shadow map anew, from where light and objects are now"""

    bl_idname = "panorama.renew_shadow_preview"
    bl_label = "Renew Shadow Map"

    @classmethod
    def poll(cls, context):
        """There is a preview of a light."""
        return possible(cls, _none_yet(context.scene))

    def work(self, context):
        """Make it."""
        preview = context.scene.panorama_shadow_preview
        preview.problem = "; ".join(renew(preview, context.evaluated_depsgraph_get()).warnings)
        return f"Shadow of '{preview.light.name}' is current; {size_of(preview)}"


class PANORAMA_OT_remove_shadow_preview(Reporting, bpy.types.Operator):
    """Take the preview out of all materials and the compositor, with its map. What they show is as before,
    and so is the light. Materials and a compositor that had to be added stay, and so do the passes"""

    bl_idname = "panorama.remove_shadow_preview"
    bl_label = "Remove Shadow Preview"

    @classmethod
    def poll(cls, context):
        """There is one."""
        there = is_there(context.scene.panorama_shadow_preview)
        return possible(cls, "" if there else "There is no preview")

    def work(self, context):
        """Take it away."""
        discard(context.scene.panorama_shadow_preview)
        context.scene.panorama_shadow_preview.problem = ""
        return "The shadow preview is gone"


def light_for(context) -> bpy.types.Object | None:
    """The chosen light, else a selected one, else the scene's first sun, else its first light."""
    chosen = light_of(context.scene.panorama_shadow_preview)
    if chosen is not None:
        return chosen
    lights = [thing for thing in context.scene.objects if thing.type == "LIGHT" and thing.visible_get()]
    return min(lights, key=lambda one: (not one.select_get(), one.data.type != "SUN"), default=None)


def preview_missing(context) -> str:
    """What Preview Shadows needs."""
    if context.mode != "OBJECT":
        return "Leave edit mode first"
    if light_for(context) is None:
        return NO_LIGHT
    return "" if _receivers(context) else "Select the objects that receive the shadow"


def size_of(preview) -> str:
    """What the map takes on the device.

    Raises ValueError for settings that nodes cannot have.
    """
    settings = settings_of(preview)
    return f"{settings.bytes_per_texel * settings.resolution**2 / 2**20:.3g} MiB on the device"


def _make(context, kind):
    """Make the map and a kind of group of the light that is to be shown -> warnings."""
    preview = context.scene.panorama_shadow_preview
    before, preview.light = preview.light, light_for(context)
    try:
        made = renew(preview, context.evaluated_depsgraph_get(), kind)
    except ValueError:
        preview.light = before
        raise
    preview.problem = "; ".join(made.warnings)
    return made.warnings


def _none_yet(scene):
    preview = scene.panorama_shadow_preview
    if not is_there(preview):
        return "There is no preview"
    return "Choose a light" if light_of(preview) is None else ""


def _receivers(context):
    return [thing for thing in context.selected_objects if thing.type in KINDS]


def _sorted_out(things):
    """Materials that can be darkened, things that get one, and sentences on what is left alone.

    Raises ValueError where nothing is left.
    """
    slots = {thing: [slot.material for slot in thing.material_slots if slot.material] for thing in things}
    bare = [
        thing for thing, worn in slots.items() if not worn and is_editable(thing) and is_editable(thing.data)
    ]
    worn = sorted({material for worn in slots.values() for material in worn}, key=lambda one: one.name)
    linked = [one for one in worn if not is_editable(one)]
    dark = [one for one in worn if one not in linked and not has_surface(one)]
    left = [
        f"{', '.join(repr(one.name) for one in some)}: {why}, so left alone"
        for some, why in (
            (linked, "linked from another file"),
            (dark, "has no surface that a shadow could darken"),
        )
        if some
    ]
    usable = [one for one in worn if one not in linked and one not in dark]
    if not usable and not bare:
        raise ValueError(
            "; ".join(left) or "what is selected is linked from another file and has no material"
        )
    return usable, bare, left


def _clothed(bare):
    """A new material in a list, put on things without any; none for none."""
    if not bare:
        return []
    material = bpy.data.materials.new(NEW_MATERIAL)
    if bpy.app.version < (5,):
        material.use_nodes = True
    for thing in bare:
        if thing.material_slots:
            thing.material_slots[0].material = material
        elif not thing.data.materials:  # things may share their data
            thing.data.materials.append(material)
    return [material]


classes = (
    PANORAMA_OT_preview_shadows,
    PANORAMA_OT_composite_shadows,
    PANORAMA_OT_renew_shadow_preview,
    PANORAMA_OT_remove_shadow_preview,
)
