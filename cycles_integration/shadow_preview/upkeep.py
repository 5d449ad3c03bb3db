"""A scene's preview, from what its property group says: maps and groups made, renewed, and taken away."""

from __future__ import annotations

import bpy

from ...ibl_toolkit.mobile.shadow_maps import ShadowSettings
from ...ibl_toolkit.mobile.shadow_maps.suggestion import exponent, offsets, reduction
from ..place import place_in
from .composite import take_off_picture
from .group import ShownLight, aim_group, build_group, fits, images_of, refuse_wide
from .kinds import COMPOSITOR, SHADER
from .light_view import shadow_maps_of
from .map_image import store_map
from .own_shadow import is_gone, lights_of, seen_twice, settle_shadows
from .real_surfaces import undress
from .receivers import take_off
from .strength import strength_of

MAP = "Shadow Map"
GROUPS = {
    SHADER: ("group", "Shadow Map Preview"),
    COMPOSITOR: ("composite_group", "Shadow Map Composite"),
}
"""Kind of node tree → the preview's property for its group, and the group's name."""


def settings_of(preview) -> ShadowSettings:
    """The settings that a scene's `panorama_shadow_preview` stands for; nodes cannot have all of them.

    Raises ValueError where a device cannot have them either.
    """
    factor, units = preview.offset_factor, preview.offset_units
    bleeding, strength = preview.bleeding_reduction, preview.exponent
    if preview.offset_by_itself:
        factor, units = offsets(preview.method, preview.window)
        bleeding, strength = reduction(preview.method, preview.storage), exponent(preview.storage)
    return ShadowSettings(
        method=preview.method,
        resolution=preview.resolution,
        storage=preview.storage,
        window=preview.window,
        offset_factor=factor,
        offset_units=units,
        bleeding_reduction=bleeding,
        exponent=strength,
    )


def renew(preview, depsgraph: bpy.types.Depsgraph, *more: str) -> list[str]:
    """Make the maps of the preview's lights anew, and what shows them as far as that has to change.

    more: of GROUPS, those that the preview shall have beside the ones that it has.
    Returns what the maps cannot show, and what is shown amiss, in words.
    Raises ValueError, with all as it was, where there is no light, no map can be made, or nodes cannot have
    the settings.
    """
    lights = lights_of(preview)
    if not lights:
        raise ValueError("the preview's light is gone: choose another")
    settings = settings_of(preview)
    refuse_wide(settings, len(lights))
    maps = shadow_maps_of(lights, depsgraph, settings)
    strengths = [strength_of(light, depsgraph) for light in lights]
    for kind, (property_name, name) in GROUPS.items():
        group = getattr(preview, property_name)
        if kind in more or group is not None:
            made = _renewed(group, maps, strengths, kind, name)
            if made != group:  # else the scene would count as changed
                setattr(preview, property_name, made)
    gone = [f"'{row.light.name}' is gone from the scene" for row in preview.lights if is_gone(row)]
    said = zip(lights, maps, strict=True)
    amiss = [f"'{light.name}': {words}" for light, made in said for words in made.warnings]
    return gone + seen_twice(preview) + amiss


def discard(preview):
    """Take the preview out of materials, compositor and file; its lights have their own shadows again, and
    so have those of other scenes whose preview was the same, as a copy's is."""
    for property_name, _ in GROUPS.values():
        group = getattr(preview, property_name)
        setattr(preview, property_name, None)
        if group is not None:
            _remove(group, preview.id_data)
    place = place_in(preview.id_data)
    if place is not None:
        undress(place)
    for scene in bpy.data.scenes:
        if scene.library is None:
            settle_shadows(scene.panorama_shadow_preview)


def _renewed(group, maps, strengths, kind, name):
    """A group, the one given if there is one, that shows maps; it has no more images than these."""
    images = images_of(group)
    spare = images[len(maps) :]
    images += [None] * (len(maps) - len(images))
    shown = []
    for made, strength, image in zip(maps, strengths, images, strict=False):
        stored = store_map(made, image, MAP, as_floats=kind == COMPOSITOR)
        shown.append(ShownLight(made, stored, strength))
    if fits(group, shown):
        aim_group(group, shown)
    else:
        group = build_group(shown, group, name, kind)
    for image in spare:
        bpy.data.images.remove(image)
    return group


def _remove(group, scene):
    for material in bpy.data.materials:
        take_off(material, group)
    take_off_picture(scene, group)
    images = images_of(group)
    inner = {node.node_tree for node in group.nodes if node.type == "GROUP"}
    for tree in (group, *filter(None, inner)):
        bpy.data.node_groups.remove(tree)
    for image in images:
        bpy.data.images.remove(image)
