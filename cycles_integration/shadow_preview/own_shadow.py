"""The lights of a preview, and their own shadows: switched off meanwhile, so that none is seen twice."""

from __future__ import annotations

import bpy

MOST_LIGHTS = 4
"""Of a preview: each has its map, and graphics cards promise a shader no more than 16 images, of which the
views need some themselves and materials theirs. Each costs a map's time, too."""


def lights_of(preview) -> list[bpy.types.Object]:
    """The lights that a preview has and the scene too: pointers keep what was deleted. Each once."""
    there = (row.light for row in preview.lights if row.light is not None and not is_gone(row))
    return list(dict.fromkeys(there))[:MOST_LIGHTS]


def is_gone(row) -> bool:
    """Whether the light of one of a preview's rows was deleted."""
    return row.light is not None and not is_in(row.light, row.id_data)


def is_in(thing: bpy.types.Object, scene: bpy.types.Scene) -> bool:
    """Whether a scene has an object. Its name tells it soon, unless one of another file has the same."""
    return scene.objects.get(thing.name) == thing or thing in scene.objects[:]


def is_there(preview) -> bool:
    """Whether a scene has a preview, in materials or in its compositor."""
    return preview.group is not None or preview.composite_group is not None


def settle_shadows(preview):
    """Leave the own shadows of the preview's lights out, if it stands for them, and give back all others.

    A light that is so already is not touched: else it would count as changed, and its map as out of date.
    """
    replaced = [light.data for light in lights_of(preview)] if preview.replaces_own else []
    if not is_there(preview):
        replaced = []
    _give_back(preview, replaced)
    held = [row.light for row in preview.switched_off]
    for data in dict.fromkeys(replaced):
        if data.library is not None or not (data.use_shadow or _is_off_for_others(data, preview)):
            continue
        if data not in held:
            preview.switched_off.add().light = data
        if data.use_shadow:
            data.use_shadow = False


def seen_twice(preview) -> list[str]:
    """A sentence on each light whose own shadow stays beside the preview's, for it is linked."""
    lights = lights_of(preview) if preview.replaces_own else []
    return [
        f"'{light.name}': its own shadow is seen too, for the light is linked from another file"
        for light in lights
        if light.data.library is not None and light.data.use_shadow
    ]


def _give_back(preview, replaced):
    """Their shadows to lights not replaced any more, unless another scene's preview wants them off."""
    for index in reversed(range(len(preview.switched_off))):
        data = preview.switched_off[index].light
        if data not in replaced:
            preview.switched_off.remove(index)
            if data is not None and not _is_off_for_others(data, preview):
                data.use_shadow = True


def _is_off_for_others(data, preview):
    others = (scene.panorama_shadow_preview for scene in bpy.data.scenes if scene != preview.id_data)
    return any(is_there(other) and data in [row.light for row in other.switched_off] for other in others)
