"""Jobs of how the sidebar looks: light and dark themes, small and large interfaces. Runs in Blender."""

import pathlib

import bpy
import hotel
import look

THEMES = {"light": "Blender_Light.xml", "dark": "Blender_Dark.xml"}
SCALES = (0.75, 1.0, 2.0)


def prepared(stage):
    """The hotel room, imported, calibrated and built."""
    bpy.ops.panorama.import_set(filepath=str(hotel.picked_set(stage.folder)))
    bpy.ops.panorama.calibrate()
    bpy.ops.panorama.build()
    yield


def set_theme(name):
    """Load one of Blender's own themes."""
    folders = bpy.utils.preset_paths("interface_theme")
    path = next(p for f in folders for p in [pathlib.Path(f) / THEMES[name]] if p.exists())
    bpy.ops.script.execute_preset(filepath=str(path), menu_idname="USERPREF_MT_interface_theme_presets")


def themes(stage):
    """A picture of view and sidebar in either theme."""
    yield from prepared(stage)
    view = look.area("VIEW_3D")
    yield from look.open_sidebar(stage.hand, view)
    try:
        for name in THEMES:
            set_theme(name)
            yield from stage.picture(f"theme_{name}", look.box(look.area("VIEW_3D")))
        yield from both_halves(stage, look.region(view, "UI"))
    finally:
        bpy.ops.preferences.reset_default_theme()


def both_halves(stage, sidebar):
    """Pictures of the sidebar above and below."""
    yield from stage.picture("sidebar_above", look.box(sidebar))
    yield from stage.hand.move(*look.middle(sidebar))
    yield from stage.hand.wheel("WHEELDOWNMOUSE", 40)
    yield from stage.picture("sidebar_below", look.box(sidebar))
    yield from stage.hand.wheel("WHEELUPMOUSE", 40)


def scales(stage):
    """A picture of the sidebar in each size of the interface, and how wide it is."""
    yield from prepared(stage)
    preferences, widths = bpy.context.preferences.view, {}
    try:
        for scale in SCALES:
            preferences.ui_scale = scale
            yield
            view = look.area("VIEW_3D")
            sidebar = yield from look.open_sidebar(stage.hand, view)
            for _ in range(10):
                yield
            yield from stage.picture(f"scale_{scale}", look.box(view))
            widths[scale] = sidebar.width
    finally:
        preferences.ui_scale = 1
    stage.note(widths=widths)


def seeing(stage):
    """Pictures of the header's pop-over, and of the plan of the floor that a view from above shows."""
    yield from prepared(stage)
    for name in ("Cube", "Camera", "Light"):
        bpy.data.objects.remove(bpy.data.objects[name])
    view = look.area("VIEW_3D")
    yield from look.click_in_header(stage.hand, view, "PANORAMA_PT_view")
    yield
    left, bottom, width, height = look.box(view)
    yield from stage.picture("see_settings", (left + width - 280, bottom + height - 190, 480, 190))
    yield from stage.hand.key("ESC")
    yield from stage.hand.move(*look.middle(look.region(view)))
    yield from stage.hand.key("NUMPAD_7")
    yield from stage.hand.key("HOME")
    yield from stage.hand.wheel("WHEELUPMOUSE", 2)
    yield from stage.picture("see_plan", look.box(view))
    stage.note(is_plan=view.spaces.active.region_3d.view_perspective == "ORTHO")


JOBS = (themes, scales, seeing)
