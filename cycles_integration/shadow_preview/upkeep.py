"""A scene's preview, from what its property group says: map and group made, renewed, and taken away."""

from __future__ import annotations

import bpy

from ...ibl_toolkit.mobile.shadow_maps import ShadowMap, ShadowSettings
from ...ibl_toolkit.mobile.shadow_maps.suggestion import exponent, offsets, reduction
from .composite import take_off_picture
from .group import aim_group, build_group, fits, refuse_wide
from .kinds import COMPOSITOR, SHADER
from .light_view import shadow_map_of
from .map_image import store_map
from .own_shadow import give_back_shadow
from .receivers import take_off

MAP = "Shadow Map"
KINDS_OF = {
    SHADER: ("image", "group", "Shadow Map Preview"),
    COMPOSITOR: ("composite_image", "composite_group", "Shadow Map Composite"),
}
"""Kind of node tree → the preview's properties for its image and group, and the group's name."""


def settings_of(preview) -> ShadowSettings:
    """The settings that a scene's `panorama_shadow_preview` stands for.

    Raises ValueError where nodes cannot have them.
    """
    factor, units = preview.offset_factor, preview.offset_units
    bleeding, strength = preview.bleeding_reduction, preview.exponent
    if preview.offset_by_itself:
        factor, units = offsets(preview.method, preview.window)
        bleeding, strength = reduction(preview.method, preview.storage), exponent(preview.storage)
    settings = ShadowSettings(
        method=preview.method,
        resolution=preview.resolution,
        storage=preview.storage,
        window=preview.window,
        offset_factor=factor,
        offset_units=units,
        bleeding_reduction=bleeding,
        exponent=strength,
    )
    refuse_wide(settings)
    return settings


def renew(preview, depsgraph: bpy.types.Depsgraph, *more: str) -> ShadowMap:
    """Make the map of the preview's light anew, and what shows it as far as that has to change.

    more: of KINDS_OF, those groups that the preview shall have beside the ones that it has.
    Raises ValueError, with all as it was, where no map can be made.
    """
    made = shadow_map_of(preview.light, depsgraph, settings_of(preview))
    for kind, (image_name, group_name, name) in KINDS_OF.items():
        if kind in more or getattr(preview, group_name) is not None:
            image = store_map(made, getattr(preview, image_name), MAP, as_floats=kind == COMPOSITOR)
            _keep(preview, image_name, image)
            group = getattr(preview, group_name)
            if fits(group, made, image):
                aim_group(group, made)
            else:
                _keep(preview, group_name, build_group(made, image, group, name, kind))
    return made


def discard(preview):
    """Take the preview out of materials, compositor and file; its light has its own shadow again."""
    for image_name, group_name, _ in KINDS_OF.values():
        image, group = getattr(preview, image_name), getattr(preview, group_name)
        setattr(preview, image_name, None)
        setattr(preview, group_name, None)
        if group is not None:
            _remove(group, preview.id_data)
        if image is not None:
            bpy.data.images.remove(image)
    give_back_shadow(preview)


def _keep(preview, name, value):
    if getattr(preview, name) != value:  # else the scene would count as changed
        setattr(preview, name, value)


def _remove(group, scene):
    for material in bpy.data.materials:
        take_off(material, group)
    take_off_picture(scene, group)
    inner = {node.node_tree for node in group.nodes if node.type == "GROUP"}
    for tree in (group, *filter(None, inner)):
        bpy.data.node_groups.remove(tree)
