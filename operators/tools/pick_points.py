"""The operator that runs the picking tool, and writes what was picked."""

import threading

import bpy
import numpy as np

from ...cycles_integration.blender_images import array_from_image
from .. import progress, solving
from ..properties import AXES, PICK_KINDS, PLANES
from ..reporting import possible
from . import base
from .lengths import Lengths
from .pick_tool import PickTool
from .picks_copy import PicksCopy
from .picks_editing import PicksEditing

BRIGHTEST = 60000
"""What half a float can hold; a sun is no brighter for the magnifier."""
BAND, PATIENCE = 64, 0.3
"""Rows converted at a time, and how long the tool waits for its first pixels before it begins [s]."""
SELECTED = ("SELECTED", "Selected Pick", "The pick that is selected in the list")


class PANORAMA_OT_pick_points(base.ToolOperator, bpy.types.Operator):
    """Set and drag the points of picks on the panorama, in 3D Views and Image Editors, with the result drawn
    live; Enter calibrates"""

    bl_idname = "panorama.pick_points"
    bl_label = "Pick Points"

    kind: bpy.props.EnumProperty(
        name="Kind", description="What the next clicks are points of", items=(SELECTED, *PICK_KINDS)
    )
    plane: bpy.props.EnumProperty(name="Plane", description="Where a new rectangle lies", items=PLANES)
    axis: bpy.props.EnumProperty(
        name="Axis", description="Axis of the world that new floor lines follow", items=AXES
    )

    @classmethod
    def poll(cls, context):
        """There must be a panorama, and no other tool."""
        return possible(cls, progress.image_missing(context.scene) or base.busy())

    def make_tool(self, context):
        """A copy of the picks, and of the image's pixels."""
        scene, state = context.scene, context.scene.panorama_set
        image = state.image
        if image is None or not image.size[0]:
            raise ValueError(f"{state.image_path}: the image is gone; open it again")
        editing = PicksEditing(PicksCopy.of(state), min(state.active_pick, len(state.picks) - 1))
        if self.kind != "SELECTED":
            if self.kind == "LENGTH" and editing.length is not None:
                raise ValueError("there is a known length already: the scale needs one only")
            editing.begin(self.kind, self.plane, self.axis)
        tool = PickTool(
            editing,
            image.size,
            lengths=Lengths.of_scene(scene),
            ui_scale=context.preferences.system.ui_scale,
        )
        pixels = threading.Thread(target=_give_pixels, args=(tool, array_from_image(image)), daemon=True)
        pixels.start()
        pixels.join(PATIENCE)
        tool.scene_name, tool.image_path, tool.settings = scene.name, state.image_path, _settings(state)
        return tool

    def modal(self, context, event):
        """Follow the sidebar, let go where the scene or its panorama is another, and work on."""
        tool = self.tool
        if tool is base.active_tool():
            scene = bpy.data.scenes.get(tool.scene_name)
            if scene is None or scene.panorama_set.image_path != tool.image_path:
                self.report({"WARNING"}, "Pick Points ended: its scene or panorama is another now")
                base.close_tool()
            elif scene != context.scene:
                return {"PASS_THROUGH"}
            else:
                _follow(tool, scene.panorama_set)
        return super().modal(context, event)

    def work(self, context):
        """Write the picks, and calibrate if they suffice."""
        tool = self.tool
        scene = bpy.data.scenes.get(tool.scene_name)
        if scene is None:
            raise ValueError(f"scene '{tool.scene_name}' is gone")
        state = scene.panorama_set
        if tool.editing.copied != PicksCopy.of(state):
            tool.editing.copied.write(state)
        state.active_pick = max(min(tool.editing.target, len(state.picks) - 1), 0)
        missing = progress.picks_missing(scene)
        if missing:
            return f"{_stored(state)}. To calibrate: {missing}"
        return self._calibrate(scene)

    def _calibrate(self, scene):
        try:
            found = solving.calibrate_scene(scene)
        except (ValueError, OSError) as error:  # the picks are kept, to be mended
            scene.panorama_set.problem, scene.panorama_set.calibration_is_old = str(error), True
            self.report({"WARNING"}, str(error))
            return f"{_stored(scene.panorama_set)}; they do not calibrate yet"
        for warning in found.warnings:
            self.report({"WARNING"}, warning)
        return f"Tilt {found.tilt_deg:.2f}° ± {found.uncertainty_tilt_deg:.2f}°"


def _stored(state):
    count = len(state.picks)
    return f"Stored {count} pick" + "s" * (count != 1)


def _give_pixels(tool, pixels):
    """Give a tool the image (H, W, 3) as half floats, while it already runs: the largest take a second."""
    if pixels.shape[2] < 3:
        pixels = np.repeat(pixels[..., :1], 3, axis=2)
    halves = np.empty(pixels.shape, np.float16)
    for row in range(0, len(pixels), BAND):
        if base.active_tool() not in (tool, None):
            return
        halves[row : row + BAND] = np.minimum(pixels[row : row + BAND], BRIGHTEST)
    tool.image = halves


def _settings(state):
    """What the sidebar can change while a tool runs: per pick, and the camera height."""
    picks = tuple((pick.kind, pick.plane, pick.axis, pick.metres) for pick in state.picks)
    return picks, state.camera_height


def _follow(tool, state):
    """Take over what the sidebar has changed since the last event."""
    (before, height_before), (now, height) = tool.settings, _settings(state)
    tool.settings = now, height
    for copied, old, new in zip(tool.editing.copied.picks, before, now, strict=False):
        if old != new and copied.kind == new[0] and not copied.is_new:
            _, copied.plane, copied.axis, copied.metres = new
    if height != height_before:
        tool.editing.copied.camera_height = height


classes = (PANORAMA_OT_pick_points,)
