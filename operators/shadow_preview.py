"""Operators that show the shadow maps of small devices in materials."""

from __future__ import annotations

import bpy

from ..cycles_integration.pieces import built_pieces
from ..cycles_integration.place import place_in
from ..cycles_integration.roles import is_editable
from ..cycles_integration.shadow_preview import (
    COMPOSITOR,
    KINDS,
    SHADER,
    discard,
    has_surface,
    is_there,
    lights_of,
    put_on,
    put_on_picture,
    renew,
    settings_of,
    show_photograph,
)
from . import shadow_watch
from .reporting import Reporting, possible
from .shadow_lights import NO_LIGHT, candidates, choose

NEW_MATERIAL = "Shadow Receiver"


class PANORAMA_OT_preview_shadows(Reporting, bpy.types.Operator):
    """Show on the selected objects the shadows of the lights as a small device draws them: makes the shadow
    maps and puts a node group before the output of their materials, in EEVEE and Cycles. Rebuilt surfaces
    without a material show the photograph meanwhile"""

    bl_idname = "panorama.preview_shadows"
    bl_label = "Preview Shadows"

    @classmethod
    def poll(cls, context):
        """There is a light, and something that receives its shadow."""
        return possible(cls, preview_missing(context))

    def work(self, context):
        """Make the maps, and put the group on."""
        preview = context.scene.panorama_shadow_preview
        materials, bare, left = _sorted_out(_receivers(context))
        warnings = _make(context, SHADER)
        worn = materials + _clothed(bare, context.scene)
        for material in worn:
            put_on(material, preview.group, preview.darkness)
        shadow_watch.looks_changed(preview, context)
        for warning in (*left, *warnings):
            self.report({"WARNING"}, warning[0].upper() + warning[1:])
        count = len(worn)
        return f"{_shadows(preview)} on {count} material{'s' * (count > 1)}; {size_of(preview)}"


class PANORAMA_OT_composite_shadows(Reporting, bpy.types.Operator):
    """Darken the rendered picture by the shadows of the lights as a small device draws them: puts a node
    group before the output of the compositor, fed by the passes Position and Normal. Materials stay as is"""

    bl_idname = "panorama.composite_shadows"
    bl_label = "Shadows in the Compositor"

    @classmethod
    def poll(cls, context):
        """There is a light."""
        return possible(cls, light_missing(context))

    def work(self, context):
        """Make the maps, and put the group before the output."""
        preview = context.scene.panorama_shadow_preview
        warnings = _make(context, COMPOSITOR)
        put_on_picture(context.scene, context.view_layer, preview.composite_group, preview.darkness)
        shadow_watch.looks_changed(preview, context)
        for warning in warnings:
            self.report({"WARNING"}, warning[0].upper() + warning[1:])
        return f"{_shadows(preview)} on the rendered picture; {size_of(preview)}"


class PANORAMA_OT_renew_shadow_preview(Reporting, bpy.types.Operator):
    """Make the shadow maps anew, from where lights and objects are now"""

    bl_idname = "panorama.renew_shadow_preview"
    bl_label = "Renew Shadow Maps"

    @classmethod
    def poll(cls, context):
        """There is a preview of a light."""
        return possible(cls, _none_yet(context.scene))

    def work(self, context):
        """Make them."""
        preview = context.scene.panorama_shadow_preview
        preview.problem = "; ".join(renew(preview, context.evaluated_depsgraph_get()))
        return f"{_shadows(preview)}, made anew; {size_of(preview)}"


class PANORAMA_OT_remove_shadow_preview(Reporting, bpy.types.Operator):
    """Take the preview out of all materials and the compositor, with its maps. What they show is as before,
    and so are the lights. Materials and a compositor that had to be added stay, and so do the passes"""

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


def light_missing(context) -> str:
    """What a preview needs wherever it is shown."""
    return "" if lights_of(context.scene.panorama_shadow_preview) or candidates(context) else NO_LIGHT


def preview_missing(context) -> str:
    """What Preview Shadows needs."""
    if context.mode != "OBJECT":
        return "Leave edit mode first"
    missing = light_missing(context)
    if not missing and not _receivers(context):
        missing = "Select the objects that receive the shadow"
    return missing


def size_of(preview) -> str:
    """What the maps take on the device."""
    settings, count = settings_of(preview), len(lights_of(preview))
    return f"{count * settings.bytes_per_texel * settings.resolution**2 / 2**20:.3g} MiB on the device"


def _shadows(preview):
    names = ", ".join(f"'{light.name}'" for light in lights_of(preview))
    return f"Shadow{'s' * (',' in names)} of {names}"


def _make(context, kind):
    """Make the maps and a kind of group of the lights that are to be shown -> warnings."""
    preview = context.scene.panorama_shadow_preview
    before = [row.light for row in preview.lights]
    left = choose(context)
    try:
        warnings = renew(preview, context.evaluated_depsgraph_get(), kind)
    except ValueError:
        preview.lights.clear()
        for light in before:
            preview.lights.add().light = light
        raise
    preview.problem = "; ".join(warnings)
    return left + warnings


def _none_yet(scene):
    preview = scene.panorama_shadow_preview
    if not is_there(preview):
        return "There is no preview"
    return "" if lights_of(preview) else "Choose a light"


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


def _clothed(bare, scene):
    """Materials in a list, put on things without any: on rebuilt surfaces the photograph; none for none."""
    place = place_in(scene)
    pieces = [thing for thing in bare if place is not None and thing in built_pieces(place)]
    others = [thing for thing in bare if thing not in pieces]
    made = [show_photograph(place, pieces)] if pieces else []
    return [*made, _plain(others)] if others else made


def _plain(things):
    material = bpy.data.materials.new(NEW_MATERIAL)
    if bpy.app.version < (5,):
        material.use_nodes = True
    for thing in things:
        for slot in thing.material_slots:
            slot.material = material
        if not thing.data.materials:  # things may share their data
            thing.data.materials.append(material)
    return material


classes = (
    PANORAMA_OT_preview_shadows,
    PANORAMA_OT_composite_shadows,
    PANORAMA_OT_renew_shadow_preview,
    PANORAMA_OT_remove_shadow_preview,
)
