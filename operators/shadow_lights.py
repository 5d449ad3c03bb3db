"""Operators that choose the lights of a scene's shadow preview."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, IntProperty

from ..cycles_integration.shadow_preview import MOST_LIGHTS, lights_of, strongest_first
from . import shadow_watch
from .reporting import Reporting, possible

NO_LIGHT = "Add a light first: its shadow is shown"
WHICH = (
    ("SELECTED", "Selected", "Those that are selected"),
    ("VISIBLE", "All Visible", "Those that the view shows"),
)


class PANORAMA_OT_add_shadow_lights(Reporting, bpy.types.Operator):
    """Add lights whose shadows are shown, strongest first, up to 4 together"""

    bl_idname = "panorama.add_shadow_lights"
    bl_label = "Add Lights"

    which: EnumProperty(name="Which", description="Lights that are added", items=WHICH)

    @classmethod
    def poll(cls, context):
        """There is one to add, and room for it."""
        if len(context.scene.panorama_shadow_preview.lights) >= MOST_LIGHTS:
            return possible(cls, f"There are {MOST_LIGHTS} lights, as many as one preview can have")
        return possible(cls, "" if _more(context) else "Every light that is visible is in the list")

    def work(self, context):
        """Add them, and have their maps made."""
        preview = context.scene.panorama_shadow_preview
        more = [light for light in _more(context) if self.which == "VISIBLE" or light.select_get()]
        if not more:
            raise ValueError("select the lights to add")
        room = MOST_LIGHTS - len(preview.lights)
        for light in strongest_first(more, context.evaluated_depsgraph_get())[:room]:
            preview.lights.add().light = light
        if len(more) > room:
            self.report({"WARNING"}, left_out(len(more) - room))
        names = ", ".join(f"'{light.name}'" for light in lights_of(preview))
        return f"Shadows of {names}"


class PANORAMA_OT_remove_shadow_light(Reporting, bpy.types.Operator):
    """Leave this light out of the preview. It has its own shadow again"""

    bl_idname = "panorama.remove_shadow_light"
    bl_label = "Remove Light"

    index: IntProperty(name="Index", description="Number of the light in the list, from 0", min=0)

    def work(self, context):
        """Take it off the list, and have the map made without it."""
        preview = context.scene.panorama_shadow_preview
        if self.index >= len(preview.lights):
            raise ValueError(f"there is no light {self.index}: the list has {len(preview.lights)}")
        preview.lights.remove(self.index)
        shadow_watch.light_changed(preview, context)
        return "The light is out of the preview"


def candidates(context) -> list[bpy.types.Object]:
    """The lights of a preview that has none yet: all selected ones, else the first sun, else the first."""
    lights = _visible(context)
    return [light for light in lights if light.select_get()] or sorted(lights, key=_is_no_sun)[:1]


def choose(context) -> list[str]:
    """Give a preview without lights those that come into question; returns a warning of what is left out."""
    preview = context.scene.panorama_shadow_preview
    if lights_of(preview):
        return []
    lights = strongest_first(candidates(context), context.evaluated_depsgraph_get())
    preview.lights.clear()
    for light in lights[:MOST_LIGHTS]:
        preview.lights.add().light = light
    return [left_out(len(lights) - MOST_LIGHTS)] if len(lights) > MOST_LIGHTS else []


def left_out(count: int) -> str:
    """A sentence on lights that are too many."""
    return f"{count} weaker light{'s' * (count > 1)} left out: {MOST_LIGHTS} is the most for one preview"


def _visible(context):
    return [thing for thing in context.scene.objects if thing.type == "LIGHT" and thing.visible_get()]


def _more(context):
    there = lights_of(context.scene.panorama_shadow_preview)
    return [light for light in _visible(context) if light not in there]


def _is_no_sun(light):
    return light.data.type != "SUN"


classes = (PANORAMA_OT_add_shadow_lights, PANORAMA_OT_remove_shadow_light)
