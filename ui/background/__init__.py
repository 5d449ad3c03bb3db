"""The panorama behind the scene in 3D views: two draw callbacks and a shader."""

import bpy

from . import painting, shader

CALLBACKS = ((painting.remember_scene_layer, "PRE_VIEW"), (painting.paint, "POST_VIEW"))
_handles = []


def register():
    """Draw from now on."""
    for callback, when in CALLBACKS:
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(callback, (), "WINDOW", when))


def unregister():
    """Draw no more, and keep nothing on the graphics card."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    painting.forget_scene_layer()
    painting.free_textures()
    shader.free()
