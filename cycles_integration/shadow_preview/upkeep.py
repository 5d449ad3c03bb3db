"""A scene's preview, from what its property group says: map and group made, renewed, and taken away."""

from __future__ import annotations

import bpy

from ...ibl_toolkit.mobile.shadow_maps import ShadowMap, ShadowSettings
from ...ibl_toolkit.mobile.shadow_maps.suggestion import offsets
from .group import aim_group, build_group, fits, refuse_wide
from .light_view import shadow_map_of
from .map_image import store_map
from .receivers import take_off

MAP, GROUP = "Shadow Map", "Shadow Map Preview"
OWN_SHADOW = "panorama_own_shadow"
"""Custom property of a light whose own shadow the preview has switched off."""


def settings_of(preview) -> ShadowSettings:
    """The settings that a scene's `panorama_shadow_preview` stands for.

    Raises ValueError where nodes cannot have them.
    """
    factor, units = preview.offset_factor, preview.offset_units
    if preview.offset_by_itself:
        factor, units = offsets(preview.method, preview.window)
    settings = ShadowSettings(
        method=preview.method,
        resolution=preview.resolution,
        storage=preview.storage,
        window=preview.window,
        offset_factor=factor,
        offset_units=units,
        bleeding_reduction=preview.bleeding_reduction,
        exponent=preview.exponent,
    )
    refuse_wide(settings)
    return settings


def renew(preview, depsgraph: bpy.types.Depsgraph) -> ShadowMap:
    """Make the map of the preview's light anew, and what shows it as far as that has to change.

    Raises ValueError, with all as it was, where no map can be made.
    """
    made = shadow_map_of(preview.light, depsgraph, settings_of(preview))
    image = store_map(made, preview.image, MAP)
    if preview.image != image:
        preview.image = image
    if fits(preview.group, made, image):
        aim_group(preview.group, made)
    else:
        preview.group = build_group(made, image, preview.group, GROUP)
    return made


def discard(preview):
    """Take the preview out of all materials and the file; lights have their own shadows again."""
    group, image = preview.group, preview.image
    preview.group = preview.image = None
    give_back_shadows()
    if group is not None:
        for material in bpy.data.materials:
            take_off(material, group)
        inner = {node.node_tree for node in group.nodes if node.type == "GROUP"}
        for tree in (group, *filter(None, inner)):
            bpy.data.node_groups.remove(tree)
    if image is not None:
        bpy.data.images.remove(image)


def switch_off_shadow(light: bpy.types.Object):
    """Leave a light's own shadow out, and that of no other."""
    give_back_shadows()
    if light.data.library is None and light.data.use_shadow:
        light.data[OWN_SHADOW] = True
        light.data.use_shadow = False


def give_back_shadows():
    """Give lights the shadows that `switch_off_shadow` has taken from them."""
    for data in bpy.data.lights:
        if OWN_SHADOW in data and data.library is None:
            del data[OWN_SHADOW]
            data.use_shadow = True
