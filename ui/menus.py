"""Entries in Blender's own menus: Add, and the objects' context menu."""

import bpy

AT_MOUSE = "INVOKE_REGION_WIN"
"""Blender's own entries before ours run without the mouse; ours want to know where it points in the view."""


class PANORAMA_MT_add(bpy.types.Menu):
    """What a place needs, or can give."""

    bl_label = "Panorama"

    def draw(self, context):
        """Sample balls, cameras, suns, the sample room."""
        layout = self.layout
        layout.operator_context = AT_MOUSE
        ball = layout.operator("panorama.add_ball", text="Mirror Ball", icon="SHADING_RENDERED")
        ball.kind = "MIRROR"
        layout.operator("panorama.add_ball", text="Matte Ball", icon="SHADING_SOLID").kind = "MATTE"
        layout.separator()
        layout.operator("panorama.add_camera", text="Camera at the Point of Capture", icon="CAMERA_DATA")
        stay = layout.operator("panorama.camera_from_view", text="Camera from View, at the Point of Capture")
        stay.at_origin = True
        layout.operator("panorama.camera_from_view", text="Camera from View").at_origin = False
        layout.separator()
        layout.operator("panorama.add_sun", text="Sun of the Panorama", icon="LIGHT_SUN")
        layout.operator("panorama.pick_sun", text="Sun of a Lamp (click it)", icon="EYEDROPPER")
        layout.operator("panorama.add_sun_by_time", text="Sun of a Place and Time...", icon="TIME")
        layout.operator("panorama.lights_of_probe", text="Lights from Probe Photo...", icon="LIGHT_SUN")
        layout.separator()
        layout.operator("panorama.load_sample", text="Sample Room", icon="HOME")


def draw_in_add_menu(menu, context):
    """The entry in Add."""
    menu.layout.separator()
    menu.layout.menu("PANORAMA_MT_add", icon="WORLD")


def draw_in_object_menu(menu, context):
    """The entry in the objects' context menu, once there is a place."""
    if context.scene.panorama_place.origin is not None:
        menu.layout.separator()
        menu.layout.operator_context = AT_MOUSE
        menu.layout.operator("panorama.send_to_place", icon="TRACKER")


ENTRIES = (("VIEW3D_MT_add", draw_in_add_menu), ("VIEW3D_MT_object_context_menu", draw_in_object_menu))

classes = (PANORAMA_MT_add,)


def register():
    """Put the entries into Blender's menus."""
    for menu, draw in ENTRIES:
        getattr(bpy.types, menu).append(draw)


def unregister():
    """Take them out."""
    for menu, draw in ENTRIES:
        getattr(bpy.types, menu).remove(draw)
