"""A scene with a shadow preview for tests: its light's map, and what the file holds meanwhile."""

import bpy
import numpy as np
import shadow_pictures

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.operators import shadow_watch


def add_scene():
    """A floor that is selected, a box and a ball of its material, and a sun, in the scene that is shown."""
    shadow_pictures.still_life()
    shadow_pictures.add_light("SUN")
    bpy.context.scene.panorama_shadow_preview.resolution = 64
    select("plane")
    return bpy.context.scene


def select(*names):
    bpy.ops.object.select_all(action="DESELECT")
    for name in names:
        bpy.data.objects[name].select_set(True)


def texels(scene):
    """Numbers of the map of a preview with one light."""
    (image,) = shadow_preview.images_of(scene.panorama_shadow_preview.group)
    values = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(values)
    return values


def counts():
    """Of the blocks that a preview makes."""
    return len(bpy.data.node_groups), len(bpy.data.images), len(bpy.data.materials)


def at_rest():
    """Follow the scene until no map waits to be made."""
    for _ in range(3):
        bpy.context.view_layer.update()
        shadow_watch.work_off()
    bpy.context.view_layer.update()
    assert not shadow_watch.is_waiting()
