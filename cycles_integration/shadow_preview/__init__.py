"""A small device's shadow maps shown in Blender: the map of a light as an image, its test as nodes.

    made = shadow_map_of(light, depsgraph, settings)       the numpy reference, of a Blender light
    image = store_map(made, None, "Shadow Map")            its texels, bit by bit
    group = build_group(made, image, None, "Shadow Map Preview")
    put_on(material, group, darkness=1.0)

What the nodes give equals `ibl_toolkit.mobile.shadow_maps.visibility` within 1/255.
"""

from .casters import KINDS, casters_of, throwing_names
from .composite import composite_nodes, put_on_picture, take_off_picture
from .group import WIDEST_WINDOW, aim_group, build_group, fits
from .kinds import COMPOSITOR, SHADER
from .light_view import shadow_map_of
from .map_image import store_map
from .own_shadow import give_back_shadow, is_there, light_of, switch_off_shadow
from .receivers import has_surface, nodes_of, put_on, take_off
from .upkeep import discard, renew, settings_of

__all__ = [
    "COMPOSITOR",
    "KINDS",
    "SHADER",
    "WIDEST_WINDOW",
    "aim_group",
    "build_group",
    "casters_of",
    "composite_nodes",
    "discard",
    "fits",
    "give_back_shadow",
    "has_surface",
    "is_there",
    "light_of",
    "nodes_of",
    "put_on",
    "put_on_picture",
    "renew",
    "settings_of",
    "shadow_map_of",
    "store_map",
    "switch_off_shadow",
    "take_off",
    "take_off_picture",
    "throwing_names",
]
