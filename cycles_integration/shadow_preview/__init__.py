"""A small device's shadow maps shown in Blender: the map of each light as an image, their test as nodes.

    (made,) = shadow_maps_of([light], depsgraph, settings)  the numpy reference, of Blender lights
    image = store_map(made, None, "Shadow Map")             its texels, bit by bit
    shown = [ShownLight(made, image, strength_of(light, depsgraph))]
    group = build_group(shown, None, "Shadow Map Preview")
    put_on(material, group, darkness=1.0)

What the nodes give equals `visibility` of `ibl_toolkit.mobile.shadow_maps` within 1/255, or of several lights
its `remaining_light`.
"""

from .casters import KINDS, casters_of, drawn_things
from .composite import composite_nodes, put_on_picture, take_off_picture
from .group import MOST_LOOK_UPS, ShownLight, aim_group, build_group, fits, images_of
from .kinds import COMPOSITOR, SHADER
from .light_view import shadow_maps_of
from .map_image import store_map
from .own_shadow import MOST_LIGHTS, is_gone, is_in, is_there, lights_of, settle_shadows
from .real_surfaces import show_photograph
from .receivers import has_surface, nodes_of, put_on, take_off
from .strength import strength_of, strongest_first
from .upkeep import discard, renew, settings_of

__all__ = [
    "COMPOSITOR",
    "KINDS",
    "MOST_LIGHTS",
    "MOST_LOOK_UPS",
    "SHADER",
    "ShownLight",
    "aim_group",
    "build_group",
    "casters_of",
    "composite_nodes",
    "discard",
    "drawn_things",
    "fits",
    "has_surface",
    "images_of",
    "is_gone",
    "is_in",
    "is_there",
    "lights_of",
    "nodes_of",
    "put_on",
    "put_on_picture",
    "renew",
    "settings_of",
    "settle_shadows",
    "shadow_maps_of",
    "show_photograph",
    "store_map",
    "strength_of",
    "strongest_first",
    "take_off",
    "take_off_picture",
]
