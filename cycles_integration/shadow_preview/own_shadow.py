"""The light of a preview, and its own shadow: switched off meanwhile, so that none is seen twice."""

from __future__ import annotations

import bpy


def light_of(preview) -> bpy.types.Object | None:
    """The light that a preview has, as long as the scene has it: a pointer keeps what was deleted."""
    light = preview.light
    return light if light is not None and preview.id_data.objects.get(light.name) == light else None


def is_there(preview) -> bool:
    """Whether a scene has a preview, in materials or in its compositor."""
    return preview.group is not None or preview.composite_group is not None


def switch_off_shadow(preview):
    """Leave the own shadow of the preview's light out, and that of no other light on its behalf.

    A light that is so already is not touched: else it would count as changed, and its map as out of date.
    """
    data = light_of(preview).data
    if preview.switched_off == data and not data.use_shadow:
        return
    give_back_shadow(preview)
    if data.library is None and (data.use_shadow or _is_off_for_others(data, preview)):
        preview.switched_off = data
        data.use_shadow = False


def give_back_shadow(preview):
    """Give back the shadow that the preview has switched off, unless another scene's wants it off."""
    data = preview.switched_off
    if data is None:
        return
    preview.switched_off = None
    if not _is_off_for_others(data, preview):
        data.use_shadow = True


def _is_off_for_others(data, preview):
    others = (scene.panorama_shadow_preview for scene in bpy.data.scenes if scene != preview.id_data)
    return any(other.switched_off == data and is_there(other) for other in others)
