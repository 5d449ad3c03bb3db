"""Jobs that look at the panorama behind the scene: bare views, and a head that turns. Runs in Blender."""

import math

import bpy
import hotel
import look
from mathutils import Euler, Quaternion


def bare_view(stage):
    """The hotel room, calibrated; a 3D view with nothing but the panorama."""
    path = hotel.picked_set(stage.folder)
    bpy.ops.panorama.import_set(filepath=str(path))
    bpy.ops.panorama.calibrate()
    stage.note(image=str(path.with_name("interior.exr")))
    for thing in bpy.context.scene.objects:
        thing.hide_set(True)
    space = look.area("VIEW_3D").spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    space.show_region_header = space.show_region_tool_header = space.show_region_toolbar = False
    yield
    return space


def snap(stage, name):
    """A picture of the window, and how its 3D view looks."""
    for _ in range(3):
        yield
    yield from stage.picture(name)
    area = look.area("VIEW_3D")
    view = area.spaces.active.region_3d
    matrices = {key: [list(row) for row in getattr(view, f"{key}_matrix")] for key in ("window", "view")}
    origin = [list(row) for row in bpy.context.scene.panorama_place.origin.matrix_world]
    file = str(stage.folder / f"{name}.png")
    stage.note(**{name: {**matrices, "origin": origin, "box": look.box(look.region(area)), "file": file}})


def every_kind_of_view(stage):
    """Perspective, plan, a camera with shift and darker, in solid mode; wires, the mix full on; and none."""
    space = yield from bare_view(stage)
    view, shading, shown = space.region_3d, space.shading, bpy.context.scene.panorama_view
    view.view_perspective, view.view_rotation = "PERSP", Quaternion((0.6, 0.5, 0.2, 0.6)).normalized()
    yield from snap(stage, "perspective")
    shading.type, shown.opacity = "WIREFRAME", 1
    yield from snap(stage, "wires")
    shading.type = "SOLID"
    shown.show_background = False
    yield from snap(stage, "none")
    shown.show_background = True
    view.view_perspective, view.view_rotation, view.view_distance = "ORTHO", Quaternion(), 3
    yield from snap(stage, "plan")
    camera = bpy.context.scene.camera
    camera.location, camera.rotation_euler = (1, 2, 3), Euler((math.radians(80), 0, math.radians(-100)))
    camera.data.lens, camera.data.shift_x, camera.data.shift_y = 20, 0.2, -0.1
    camera.data.show_passepartout = False
    view.view_perspective, shown.exposure = "CAMERA", -1
    yield from snap(stage, "camera")


def the_head_turns(stage):
    """Look around, and drag with the middle button: the eye stays."""
    space = yield from bare_view(stage)
    view, area = space.region_3d, look.area("VIEW_3D")
    with look.override(area):
        bpy.ops.panorama.look_around()
    yield
    before = view.view_rotation.copy()
    x, y = look.middle(area)
    yield from stage.hand.drag((x, y), (x + 300, y + 120), button="MIDDLEMOUSE")
    for _ in range(5):
        yield
    turned = math.degrees(before.rotation_difference(view.view_rotation).angle)
    stage.note(turned_deg=turned, eye=list(view.view_matrix.inverted().translation))


JOBS = (every_kind_of_view, the_head_turns)
