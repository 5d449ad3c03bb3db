"""Operators on how a 3D view looks at the panorama."""

import bpy

from .canvas import calibration_of
from .reporting import Reporting, possible

ARM = 1e-4
"""What a view turns around lies so far before its eye [m]: turning it turns the head."""
BLENDERS_LENS, WIDE_LENS = 50.0, 24.0
"""Of a view [mm]: the one that it begins with is narrow for a room."""
PLAN_ARM = 6.0
"""Distance of the plan's eye [camera heights], which gives its scale: some metres across."""


class PANORAMA_OT_look_around(Reporting, bpy.types.Operator):
    """Look from where the panorama was captured. Turning the view then turns the head, and things stay on
    their picture; zoom and pan leave the place"""

    bl_idname = "panorama.look_around"
    bl_label = "Look Around"
    bl_options = {"REGISTER"}  # a view is no part of the file's undo

    @classmethod
    def poll(cls, context):
        """There must be a panorama, and a view that may turn."""
        return possible(cls, _look_missing(context))

    def work(self, context):
        """Move the eye, keep the direction, and widen a lens that nobody has set."""
        view = context.space_data.region_3d
        if context.space_data.lens == BLENDERS_LENS:
            context.space_data.lens = WIDE_LENS
        x, y, z = _origin(context.scene)
        view.view_perspective = "PERSP"
        view.view_location, view.view_distance = (x, y, z), ARM
        return f"The view is {z:.2f} m above the floor, where the panorama was captured"


class PANORAMA_OT_look_at_plan(Reporting, bpy.types.Operator):
    """Look down on the place: the panorama is shown as it lies on the floor, a plan to draw on"""

    bl_idname = "panorama.look_at_plan"
    bl_label = "Plan"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        """There must be a panorama, and a view that may turn."""
        return possible(cls, _look_missing(context))

    def work(self, context):
        """From above, orthographic, the point of capture in the middle."""
        view, height = context.space_data.region_3d, _origin(context.scene)[2]
        view.view_perspective, view.view_rotation = "ORTHO", (1, 0, 0, 0)
        view.view_location, view.view_distance = (0, 0, 0), PLAN_ARM * height
        return "From above, x to the right and y upwards"


def follow_origin(scene):
    """Take the views that look around along when calibration moves the point of capture.

    Else what is drawn in them would be off by as much, with nothing to be seen of it.
    """
    for window in bpy.context.window_manager.windows if bpy.context.window_manager else ():
        if window.scene != scene:
            continue
        for area in window.screen.areas:
            view = area.spaces.active.region_3d if area.type == "VIEW_3D" else None
            if view is not None and view.view_perspective == "PERSP" and view.view_distance < 2 * ARM:
                view.view_location = _origin(scene)


def _origin(scene):
    """Where the panorama was captured (3,) [m]."""
    return 0.0, 0.0, calibration_of(scene)[1]


def _look_missing(context):
    scene, space = context.scene, context.space_data
    if scene.panorama_set.image is None and scene.panorama_place.image is None:
        return "Open a panorama first"
    if space is None or space.type != "VIEW_3D":
        return "Only in a 3D View"
    return "This view's rotation is locked" if space.region_3d.lock_rotation else ""


classes = (PANORAMA_OT_look_around, PANORAMA_OT_look_at_plan)
