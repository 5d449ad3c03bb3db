"""Operators whose long part a child Blender does on a copy of the file, while the window stays alive.

Only what the child found is applied to the scene, in one step of undo; Esc, another file or Blender's own end
stop the child, and the scene is what it was. In the background, and called by scripts, the same operators do
all of it here and now.
"""

from __future__ import annotations

import bpy
from bpy_extras.io_utils import ExportHelper

from ..ibl_toolkit.images.atomic import refuse_unwritable
from . import canvas, tools
from .child.process import ChildProcess
from .child.start import start_child
from .reporting import Reporting, possible, refuse_linked

POLL_EVERY = 0.1
"""[s]"""
_running = None


class Running:
    """The long work that runs now: its child, and what shows it."""

    def __init__(self, label: str, scene: bpy.types.Scene, child: ChildProcess, depends_on: str):
        self.label, self.child, self.depends_on = label, child, depends_on
        self.scene_uid = scene.session_uid  # a scene may be renamed meanwhile
        self.timer, self.shown_second = None, -1

    def text(self) -> str:
        """What it is doing, for the status bar."""
        samples = "sample {} of {}, ".format(*self.child.samples) if self.child.samples else ""
        minutes, seconds = divmod(int(self.child.seconds), 60)
        return f"{self.label}: {self.child.step}, {samples}{minutes}:{seconds:02}"

    def scene(self) -> bpy.types.Scene | None:
        """Its scene, if that is still there."""
        return next((s for s in bpy.data.scenes if s.session_uid == self.scene_uid), None)


def running() -> str:
    """Why no other long work can begin, "" where none runs."""
    return f"{_running.label} is running: wait, or cancel it with Esc" if _running else ""


class LongWork(Reporting):
    """An operator in two parts: `long_part` finds something, and `apply` gives it to the scene at once.

    A class names `long_part`, a function of its module as in `child.job.Job`, and `missing(scene)`, why it
    cannot begin. `depends_on(scene)` is a text that changes with what the result would no longer fit.
    """

    bl_options = {"UNDO"}  # no REGISTER: Adjust Last Operation would do the long part in the window
    long_part = missing = None

    @staticmethod
    def depends_on(scene) -> str:
        """Nothing, where the scene is only read."""
        return ""

    def inputs(self, context) -> dict:
        """What else the long part is told."""
        return {}

    def apply(self, scene, found) -> str:
        """Give the scene what was found; returns the line to report."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context):
        """Nothing long may run, and nothing be missing."""
        return possible(cls, running() or cls.missing(context.scene))

    def work(self, context):
        """Both parts, here and now."""
        found = self.long_part(context.scene, lambda step: None, **self.inputs(context))
        return self.apply(context.scene, found)

    def invoke(self, context, event):
        """Start the child; in the background, where there is nobody to wait for, work at once."""
        return self.execute(context) if bpy.app.background else self.begin(context)

    def begin(self, context):
        """Start the child."""
        global _running
        scene = context.scene
        try:
            refuse_linked(scene)
            depends_on = self.depends_on(scene)
            child = start_child(self.long_part, scene, self.inputs(context))
        except (ValueError, OSError, RuntimeError) as error:
            self.report({"ERROR"}, " ".join(str(error).split()))
            return {"CANCELLED"}
        _running = self.running = Running(self.bl_label, scene, child, depends_on)
        manager = context.window_manager
        _running.timer = manager.event_timer_add(POLL_EVERY, window=context.window)
        manager.modal_handler_add(self)
        show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Look after the child; everything but Esc is for others."""
        if self.running is not _running:
            return {"CANCELLED", "PASS_THROUGH"}  # ended from elsewhere: this event is not for it
        if event.type == "ESC" and event.value == "PRESS" and tools.active_tool() is None:
            self.cancel(context)
            self.report({"INFO"}, f"{self.bl_label}: cancelled, nothing has changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        _running.child.read_progress()
        if int(_running.child.seconds) != _running.shown_second:  # a window is costly to draw
            show(context)
        return self._finish(context) if _running.child.is_done() else {"PASS_THROUGH"}

    def cancel(self, context):
        """Blender ends the operator: another file, or its own end."""
        stop()

    def _finish(self, context):
        try:
            found = _running.child.value()
            scene = self._unchanged_scene()
            done = self.apply(scene, found)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            stop()
        self.report({"INFO"}, done)
        return {"FINISHED"}

    def _unchanged_scene(self):
        scene = _running.scene()
        if scene is None:
            raise ValueError(f"{self.bl_label}: its scene is gone, so what was found is dropped")
        if self.depends_on(scene) != _running.depends_on:
            raise ValueError(
                f"{self.bl_label}: the place was changed meanwhile, so what was found is dropped: do it again"
            )
        return scene


class LongExport(LongWork, ExportHelper):
    """Long work that writes an OpenEXR file; the file browser asks where, unless a path is given already."""

    bl_options = set()  # the file browser itself would push a step of undo, before anything has changed
    filename_ext = ".exr"
    filter_glob: bpy.props.StringProperty(default="*.exr", options={"HIDDEN"})

    def path(self) -> str:
        """The file, absolute. Raises OSError where it cannot be written: better told before than after."""
        path = bpy.path.abspath(self.filepath)
        refuse_unwritable(path)
        return path

    def invoke(self, context, event):
        """Ask for the file, or start."""
        if bpy.app.background or self.properties.is_property_set("filepath"):
            return super().invoke(context, event)
        self.is_browsing = True
        return ExportHelper.invoke(self, context, event)

    def execute(self, context):
        """Work here and now; the file browser, which frees its operator afterwards, has another one start."""
        if not getattr(self, "is_browsing", False):
            return super().execute(context)
        _, _, verb = type(self).bl_idname.rpartition(".")
        given = self.as_keywords(ignore=("filter_glob", "check_existing"))
        getattr(bpy.ops.panorama, verb)("INVOKE_DEFAULT", **given)
        return {"CANCELLED"}


class PANORAMA_OT_cancel_work(bpy.types.Operator):
    """End the long work that runs now and leave the scene as it is, like Esc in the window where it began"""

    bl_idname = "panorama.cancel_work"
    bl_label = "Cancel Long Work"
    bl_options = set()

    @classmethod
    def poll(cls, context):
        """Something must run."""
        return possible(cls, "" if _running else "No long work is running")

    def execute(self, context):
        """End it; its operator goes with the next event."""
        self.report({"INFO"}, f"{_running.label}: cancelled, nothing has changed")
        stop()
        return {"FINISHED"}


def show(context):
    """Show in the status bar what runs, unless a tool shows its keys there."""
    if tools.active_tool() is None:
        _running.shown_second = int(_running.child.seconds)
        context.workspace.status_text_set(_draw_status)


def stop():
    """End the child, if one runs, and all that shows it."""
    global _running
    ended, _running = _running, None
    if ended is None:
        return
    ended.child.stop()
    manager = bpy.context.window_manager
    manager.event_timer_remove(ended.timer)
    if tools.active_tool() is None:
        for window in manager.windows:
            window.workspace.status_text_set(None)
    canvas.redraw(bpy.context)


def _draw_status(header, context):
    if _running is not None:
        row = header.layout.row()  # the button first: what follows changes its width
        row.operator(PANORAMA_OT_cancel_work.bl_idname, text="Cancel (Esc)", icon="X")
        row.label(text=_running.text())


def unregister():
    """Nothing runs any more: Blender drops the operator without a word."""
    stop()


classes = (PANORAMA_OT_cancel_work,)
