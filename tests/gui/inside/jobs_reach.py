"""Jobs of what lies within reach: sample room, Send to This Place, suns, presets. Runs in Blender."""

import bpy
import look
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector
from waiting import Until

SPOT = (0.4, -0.3, 0.0)
"""A place on the floor that the view shows [m]."""
LAMP = (0.684, 0.525)
"""A lamp of the hotel room, (u, v)."""


def job():
    """The settings of render quality."""
    found = bpy.context.scene.panorama_set.job
    return [found.method, found.samples, found.denoise]


def in_window(view, point):
    """Where a view shows a point of the world [window px]."""
    region = look.region(view)
    x, y = location_3d_to_region_2d(region, view.spaces.active.region_3d, Vector(point))
    return region.x + x, region.y + y


def place_of_sample(stage):
    """The sample room by its button, calibrated and built; the view from above, the first cube small."""
    view = look.area("VIEW_3D")
    sidebar = yield from look.open_sidebar(stage.hand, view)
    yield from look.click_button(stage.hand, sidebar, "panorama.load_sample")
    yield Until(lambda: len(bpy.context.scene.panorama_set.picks), "the sample room")
    with look.override(view):
        bpy.ops.panorama.calibrate()
        bpy.ops.panorama.build()
    cube = bpy.data.objects["Cube"]
    cube.scale, cube.rotation_euler, cube.location = (0.15,) * 3, (0.3, 0.2, 0.5), (0, 0, 1)
    view.spaces.active.region_3d.view_location = (0, 0, 0.6)
    view.spaces.active.region_3d.view_distance = 4.5
    bpy.ops.ed.undo_push(message="before")
    yield
    return view, sidebar


def lowest():
    """The lowest corner of the cube [m], and where its bounds have their middle (x, y)."""
    bpy.context.view_layer.update()
    cube = bpy.data.objects["Cube"]
    corners = [cube.matrix_world @ vertex.co for vertex in cube.data.vertices]
    middle = [(min(c[i] for c in corners) + max(c[i] for c in corners)) / 2 for i in (0, 1)]
    return [*middle, min(c.z for c in corners)]


def send_by_click(stage):
    """Press the button, click the floor; then the sky; then undo."""
    view, sidebar = yield from place_of_sample(stage)
    before = lowest()
    yield from look.click_button(stage.hand, sidebar, "panorama.send_to_place")
    yield from stage.hand.click(*in_window(view, SPOT))
    yield
    stage.note(spot=SPOT, sent=lowest())
    yield from stage.picture("sent_to_place", look.box(view))
    region = look.region(view)
    yield from look.click_button(stage.hand, sidebar, "panorama.send_to_place")
    yield from stage.hand.click(region.x + 300, region.y + region.height - 60)
    yield
    stage.note(after_sky=lowest())
    yield from stage.hand.key("ESC")
    yield from stage.hand.move(*look.middle(view))
    yield from stage.hand.key("Z", ctrl=True)
    yield
    stage.note(before=before, undone=lowest())


def sun_by_click(stage):
    """Look at a lamp, press the button, click it."""
    view, sidebar = yield from place_of_sample(stage)
    place = bpy.context.scene.panorama_place
    towards = place.origin.matrix_world.to_3x3() @ Vector(look.direction_of(LAMP).tolist())
    orbit = view.spaces.active.region_3d
    orbit.view_rotation = towards.to_track_quat("-Z", "Y")
    orbit.view_location = place.origin.location
    yield
    yield from look.click_button(stage.hand, sidebar, "panorama.pick_sun")
    region = look.region(view)
    yield from stage.hand.click(region.x + region.width // 2, region.y + region.height // 2)
    yield
    sun = bpy.data.objects["Sun from Panorama"]
    bpy.context.view_layer.update()
    shines_from = sun.matrix_world.to_3x3() @ Vector((0, 0, 1))
    stage.note(off_deg=shines_from.angle(towards) * 57.29578, across_deg=sun.data.angle * 57.29578)


def sun_of_today(stage):
    """Press the button, take what the dialog proposes; then undo."""
    _, sidebar = yield from place_of_sample(stage)
    yield from look.click_button(stage.hand, sidebar, "panorama.add_sun_by_time")
    yield
    yield from stage.hand.key("RET")
    yield Until(lambda: "Sun by Time" in bpy.data.objects, "the sun")
    sun = bpy.data.objects["Sun by Time"]
    bpy.context.view_layer.update()
    shines_from = sun.matrix_world.to_3x3() @ Vector((0, 0, 1))
    stage.note(direction=list(shines_from), kept=sun["panorama_sun_by_time"].to_dict())
    yield from stage.hand.move(*look.middle(look.area("VIEW_3D")))
    yield from stage.hand.key("Z", ctrl=True)
    yield
    stage.note(undone="Sun by Time" not in bpy.data.objects)


def preset_by_click(stage):
    """Open the presets in the header of the step Render, and choose one by its name."""
    view, _ = yield from place_of_sample(stage)
    stage.note(before=job())
    with look.override(view):
        bpy.ops.wm.call_panel("INVOKE_DEFAULT", name="PANORAMA_PT_render_presets", keep_open=False)
    yield
    x, y = stage.hand.x, stage.hand.y
    around = (x - 150, y - 60, 300, 120)
    found = yield from look.find_button(stage.hand, around, "Preview", columns=(0.3, 0.5))
    stage.note(found=found is not None)
    if found:
        yield from stage.hand.click(*found)
        yield
    stage.note(after=job())


JOBS = (send_by_click, sun_by_click, sun_of_today, preset_by_click)
