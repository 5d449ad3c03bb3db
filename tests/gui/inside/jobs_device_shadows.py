"""Jobs of the step of device shadows: a ball's shadow on the hotel room's floor. Runs in Blender."""

import bpy
import look
import numpy as np
from jobs_layers import press, view
from jobs_sidebar import choose_file, import_set
from mathutils import Vector
from waiting import Until

LAST_PANEL = 13
"""Middle of the header of the last panel, above the lower edge of the sidebar that is scrolled down [px]."""
BALL = (0.85, -0.35, 0)
"""Where the ball stands on the floor [m]."""
BESIDE, LENS_MM = 0.2, 32
"""So far beside it the view looks [m], since the sidebar hides a part of it."""
AROUND = 3
"""So many pixels to each side are seen at a place."""
LOOKS = 60
"""Pictures in which a shadow must have come: software compiles the shader for a while."""


def preview_follow_and_remove(stage):
    """Choose the sun, preview, turn the sun, remove, undo, and write the page."""
    yield from import_set(stage)
    furnish()
    yield from open_last_panel(stage)
    before = yield from look_at(stage, "shadows_before", lambda seen: seen["floor"] > 0)
    yield from press(stage, "panorama.add_shadow_lights", "SELECTED")
    preview = bpy.context.scene.panorama_shadow_preview
    stage.note(lights=[row.light.name for row in preview.lights])
    select("floor", ball().name)
    yield from press(stage, "panorama.preview_shadows")
    shown = yield from look_at(stage, "shadows_shown", lambda seen: seen["here"] < 0.8 * seen["floor"])
    yield from scroll_down(stage)
    yield from stage.picture("shadows_preview", look.box(view()))
    select(sun().name)
    yield from turn_sun(stage)
    turned = yield from look_at(stage, "shadows_turned", lambda seen: seen["there"] < 0.8 * seen["floor"])
    yield from scroll_down(stage)
    yield from press(stage, "panorama.remove_shadow_preview")
    removed = yield from look_at(stage, "shadows_removed", lambda seen: seen["there"] > 0.9 * before["there"])
    stage.note(before=before, shown=shown, turned=turned, removed=removed, left=is_there())
    yield from stage.hand.move(*look.middle(look.region(view())))
    yield from stage.hand.key("Z", ctrl=True)
    undone = yield from look_at(stage, "shadows_undone", lambda seen: seen["there"] < 0.8 * seen["floor"])
    stage.note(undone=undone, is_back=is_there())
    page = stage.folder / "shadows.html"
    yield from scroll_down(stage)
    yield from press(stage, "panorama.export_shadow_page")
    yield from choose_file(stage, page)
    yield Until(page.exists, "the page", 120)
    stage.note(begins=page.read_text("utf-8")[:15].lower(), bytes=page.stat().st_size)


def furnish():
    """The room built, with a ball, a sun and a camera; in Material Preview."""
    scene = bpy.context.scene
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    bpy.ops.panorama.calibrate()
    bpy.ops.panorama.build()
    scene.cursor.location = BALL
    bpy.ops.panorama.add_ball(kind="MATTE")
    bpy.ops.panorama.add_sun()
    scene.panorama_shadow_preview.darkness, scene.panorama_shadow_preview.window = 0.6, 7
    scene.panorama_view.show_calibration = False
    for thing in scene.objects:  # their wires
        thing.hide_set(thing.panorama_role != "SYNTHETIC" and thing.name != "floor")
    with look.override(view()):
        bpy.ops.panorama.look_around()
    space = view().spaces.active
    space.shading.type, space.lens = "MATERIAL", LENS_MM
    overlay = space.overlay
    overlay.show_extras = overlay.show_outline_selected = overlay.show_relationship_lines = False
    overlay.show_floor = overlay.show_axis_x = overlay.show_axis_y = overlay.show_cursor = False
    overlay.show_object_origins = space.show_gizmo = space.show_region_toolbar = False
    bpy.context.view_layer.update()
    away = ball().location - scene.panorama_place.origin.location
    side = away.cross(Vector((0, 0, 1))).normalized()
    space.region_3d.view_rotation = (away + BESIDE * side).to_track_quat("-Z", "Y")


def open_last_panel(stage):
    """Scroll down, open it, scroll down again."""
    yield from scroll_down(stage)
    sidebar = look.region(view(), "UI")
    yield from stage.hand.click(sidebar.x + 0.4 * sidebar.width, sidebar.y + LAST_PANEL)
    for _ in range(20):  # it unrolls
        yield
    yield from scroll_down(stage)


def scroll_down(stage):
    """To the end of the sidebar."""
    yield from stage.hand.move(*look.middle(look.region(view(), "UI")))
    yield from stage.hand.wheel("WHEELDOWNMOUSE", 60)
    yield


def turn_sun(stage):
    """R Z 90 Enter over the view, as one turns a light."""
    yield from stage.hand.move(*look.middle(look.region(view())))
    for key in ("R", "Z"):
        yield from stage.hand.key(key)
    yield from stage.hand.type_text("90")
    yield from stage.hand.key("RET")


def look_at(stage, name, is_so):
    """Take pictures until what is seen at three places of the floor is so -> brightness of each, 0 to 1.

    `here` is in the shadow as the sun stands at first, `there` where it falls after a quarter turn, `floor`
    in neither.
    """
    points = places(stage)
    for _ in range(LOOKS):
        yield from stage.picture(name)
        seen = brightness(stage.folder / f"{name}.png", points)
        if is_so(seen):
            return seen
    raise AssertionError(f"{name}: {seen}")


def places(stage):
    """Window pixels (x, y) by name; the shadow of the ball's middle on the floor, and two beside it."""
    middle = ball().location
    if "beam" not in stage.notes:
        stage.note(beam=list(sun().matrix_world.col[2][:3]))
    x, y, z = stage.notes["beam"]
    way = -np.array([x, y]) / z * middle.z
    turned = np.array([-way[1], way[0]])
    shifts = {"here": 1.6 * way, "there": 1.6 * turned, "floor": -3.2 * way}
    return {name: pixel_of((middle.x + x, middle.y + y, 0)) for name, (x, y) in shifts.items()}


def pixel_of(point):
    """Where the view shows a point of the world."""
    window = look.region(view())
    x, y, _, w = view().spaces.active.region_3d.perspective_matrix @ Vector((*point, 1))
    return window.x + (x / w + 1) / 2 * window.width, window.y + (y / w + 1) / 2 * window.height


def brightness(path, points):
    """Mean of the picture around each point."""
    image = bpy.data.images.load(str(path))
    width, height = image.size
    values = np.empty(4 * width * height, np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    values = values.reshape(height, width, 4)[..., :3]
    boxes = {name: np.round([y, x]).astype(int) for name, (x, y) in points.items()}
    return {
        name: float(values[y - AROUND : y + AROUND + 1, x - AROUND : x + AROUND + 1].mean())
        for name, (y, x) in boxes.items()
    }


def select(*names):
    """Select these alone."""
    for thing in bpy.context.scene.objects:
        thing.select_set(thing.name in names)
    bpy.context.view_layer.objects.active = bpy.data.objects[names[0]]


def ball():
    """The ball; asked for each time, since undo replaces it."""
    return next(thing for thing in bpy.context.scene.objects if "Ball" in thing.name)


def sun():
    """The sun."""
    return next(thing for thing in bpy.context.scene.objects if thing.type == "LIGHT")


def is_there():
    """Whether there is a preview in materials."""
    return bpy.context.scene.panorama_shadow_preview.group is not None


JOBS = (preview_follow_and_remove,)
