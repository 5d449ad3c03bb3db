"""The view layers of the render methods: which collections each sees, and what it passes on."""

from __future__ import annotations

import bpy

from . import materials

OBJECTS, BACKPLATE, WITHOUT, MASK = (
    "Panorama Objects",
    "Panorama Backplate",
    "Panorama Without",
    "Panorama Mask",
)
OURS = (OBJECTS, BACKPLATE, WITHOUT, MASK)
BACKPLATE_SAMPLES, MASK_SAMPLES = 16, 16


def add_objects(scene, place, *, as_catchers: bool, with_environment: bool) -> bpy.types.ViewLayer:
    """The new objects in the place, whose surfaces are shadow catchers or plainly rendered."""
    layer = _layer(scene, place, OBJECTS)
    layer_collection(layer, place.surfaces).exclude = as_catchers
    layer_collection(layer, place.suns).exclude = with_environment
    place.catcher.hide_render = not as_catchers
    place.catcher.instance_collection = place.surfaces if with_environment else place.support
    layer.cycles.use_pass_shadow_catcher = as_catchers
    return layer


def add_backplate(scene, place) -> bpy.types.ViewLayer:
    """The photograph projected on the real surfaces, as the camera sees it, and what lies at infinity."""
    layer = _real_only(scene, place, BACKPLATE)
    layer_collection(layer, place.lights).exclude = True  # they stand before the surface: a parallax
    layer.material_override = materials.backplate_material(place)
    layer.use_pass_environment = True
    layer.samples = BACKPLATE_SAMPLES
    return layer


def add_without(scene, place) -> bpy.types.ViewLayer:
    """The place as the renderer lights it, without the new objects."""
    return _real_only(scene, place, WITHOUT)


def add_mask(scene, place) -> bpy.types.ViewLayer:
    """The new objects' coverage: the real surfaces cut holes."""
    layer = _layer(scene, place, MASK)
    for collection in (place.support, place.environment, place.lights):  # the flag reaches no children
        layer_collection(layer, collection).holdout = True
    layer.material_override = materials.black_material(place)
    layer.samples = MASK_SAMPLES
    return layer


def show_suns(scene, place, shown: bool):
    """Let the suns light the artist's own view layers, or not: beside the surfaces they would light twice."""
    for layer in scene.view_layers:
        if layer.name not in OURS:
            layer_collection(layer, place.suns).exclude = not shown


def remove_ours(scene):
    """Remove the layers of any method; the artist's own layer is for the viewport and renders no more."""
    for layer in list(scene.view_layers):
        if layer.name in OURS:
            scene.view_layers.remove(layer)
        else:
            layer.use = False


def layer_collection(layer, collection) -> bpy.types.LayerCollection:
    """Return the layer's handle on a collection, at any depth."""

    def find(parent):
        for child in parent.children:
            found = child if child.collection == collection else find(child)
            if found:
                return found
        return None

    return find(layer.layer_collection)


def _real_only(scene, place, name):
    layer = _layer(scene, place, name)
    for child in layer.layer_collection.children:
        if child.collection != place.collection:
            child.exclude = True
    layer_collection(layer, place.suns).exclude = True
    return layer


def _layer(scene, place, name):
    layer = scene.view_layers.new(name)
    layer.cycles.use_denoising = name in (OBJECTS, WITHOUT)
    layer_collection(layer, place.catchers).exclude = name != OBJECTS  # they lie where the surfaces are
    return layer
