"""Modal tools on the panorama: one runs at a time, in all editors that show it at once.

A `Tool` is plain Python: it holds what is being picked or drawn as numbers, so that undo, file loading or the
end of Blender in the midst of it cost nothing, and the scene changes only when the artist confirms. A
`ToolOperator` feeds it events and applies it.
"""

from __future__ import annotations

import bpy

from .. import canvas
from ..reporting import Reporting

RUNNING, PASS, CONFIRM, CANCEL = "RUNNING", "PASS", "CONFIRM", "CANCEL"
"""What a tool makes of an event: it was used; it is Blender's; the tool is done; it is given up."""
NAVIGATION = {
    "MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "WHEELINMOUSE", "WHEELOUTMOUSE",
    "WHEELLEFTMOUSE", "WHEELRIGHTMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "MOUSESMARTZOOM",
    "NDOF_MOTION", "NDOF_BUTTON_FIT", "HOME", "NUMPAD_ASTERIX",
}  # fmt: skip
MOUSE = {"LEFTMOUSE", "RIGHTMOUSE", "MOUSEMOVE", "INBETWEEN_MOUSEMOVE"}
_active = None


class Tool:
    """What is being picked or drawn. A tool overrides `handle`, and pushes a copy before each change."""

    label = ""
    keys: tuple[tuple[str, str], ...] = ()
    """Icons of keys and mouse buttons with what they do, for the status bar."""

    def __init__(self):
        """Nothing is done yet."""
        self.canvas, self.xy = None, None  # where the mouse is: for the magnifier
        self.region = 0  # address of the region under the mouse, to know it while it draws
        self.dragged = None  # what the mouse holds; until it lets go, the tool hears of it everywhere
        self.takes_numbers = False  # while it does, the number pad does not turn the view
        self.problem = ""  # what is wrong with what is there so far, to be drawn beside it
        self._past, self._future = [], []

    def handle(self, on, xy, event) -> str:
        """Use an event. ``on``: the canvas under the mouse at ``xy`` (2,) [region px], or None."""
        raise NotImplementedError

    def state(self):
        """A copy of what is picked or drawn so far, for undo within the tool."""
        raise NotImplementedError

    def restore(self, state):
        """Set what `state` gave."""
        raise NotImplementedError

    def push(self):
        """Keep the state before a change."""
        self._past.append(self.state())
        self._future.clear()

    def undo(self, *, redo=False):
        """Step back, or forth again."""
        source, target = (self._future, self._past) if redo else (self._past, self._future)
        if source:
            target.append(self.state())
            self.restore(source.pop())


def active_tool() -> Tool | None:
    """The tool that runs now."""
    return _active


def busy() -> str:
    """Why nothing else may change what a tool works on; "" where none runs."""
    return f"{_active.label} is running: confirm or cancel it first" if _active else ""


def close_tool():
    """End the tool that runs, without applying it; its operator goes with the next event."""
    global _active
    _active = None


class ToolOperator(Reporting):
    """An operator that runs a tool: `make_tool(context)` begins, `work(context)` applies `self.tool`.

    Both may raise ValueError: the first refuses, the second says what is wrong and the tool goes on.
    """

    bl_options = {"UNDO"}  # not REGISTER: there is no adjusting of what the mouse did
    tool = None
    shown_keys = None

    def execute(self, context):
        """Apply what was picked or drawn."""
        if self.tool is None:
            self.report({"ERROR"}, "It works with the mouse: start it from its button or menu")
            return {"CANCELLED"}
        return super().execute(context)

    def invoke(self, context, event):
        """Begin."""
        global _active
        if busy():
            self.report({"ERROR"}, busy())
            return {"CANCELLED"}
        try:
            self.tool = _active = self.make_tool(context)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.window_manager.modal_handler_add(self)
        self._show_keys(context)
        canvas.redraw(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Hand an event to the tool, and do what it answers."""
        if self.tool is not _active:
            return self._end(context, {"CANCELLED"})
        if event.type.startswith("TIMER"):  # of long work, which goes on beside the tool
            return {"PASS_THROUGH"}
        if self._is_navigation(event):
            canvas.redraw(context)
            return {"PASS_THROUGH"}
        under = canvas.canvas_under(context, event)
        on, xy = (under[0], under[3]) if under else (None, None)
        if on is None and event.type in MOUSE and self.tool.dragged is None:
            self._leave(context)
            return {"PASS_THROUGH"}
        if event.type == "Z" and event.ctrl and event.value in {"PRESS", "DOUBLE_CLICK"}:
            self.tool.undo(redo=event.shift)
            answer = RUNNING
        else:
            self.tool.canvas, self.tool.xy = on, xy
            self.tool.region = under[2].as_pointer() if under else 0
            answer = self.tool.handle(on, xy, event)
        canvas.redraw(context)
        self._show_keys(context)
        return self._answered(context, answer)

    def cancel(self, context):
        """Blender ends the operator: another file, or its own end."""
        self._end(context, {"CANCELLED"})

    def _leave(self, context):
        if self.tool.canvas is not None:
            self.tool.canvas, self.tool.xy, self.tool.region = None, None, 0
            canvas.redraw(context)

    def _is_navigation(self, event):
        if event.alt and event.type == "LEFTMOUSE":  # as of a mouse without a middle button
            return True
        on_number_pad = event.type.startswith("NUMPAD_") and event.type != "NUMPAD_ENTER"
        return event.type in NAVIGATION or (on_number_pad and not self.tool.takes_numbers)

    def _answered(self, context, answer):
        if answer == CONFIRM:
            result = self.execute(context)
            return self._end(context, result) if "FINISHED" in result else {"RUNNING_MODAL"}
        if answer == CANCEL:
            return self._end(context, {"CANCELLED"})
        return {"PASS_THROUGH"} if answer == PASS else {"RUNNING_MODAL"}

    def _end(self, context, result):
        if self.tool is _active:
            close_tool()
        if context.workspace:
            context.workspace.status_text_set(None)
        canvas.redraw(context)
        return result

    def _show_keys(self, context):
        if self.tool.keys != self.shown_keys:
            self.shown_keys = self.tool.keys
            context.workspace.status_text_set(_draw_status)


def _draw_status(header, context):  # Blender calls functions only, no methods
    for icon, text in _active.keys if _active else ():
        header.layout.label(text=text, icon=icon)


def register():
    """Nothing runs."""
    bpy.app.handlers.load_pre.append(_before_loading)


def unregister():
    """Nothing runs any more."""
    bpy.app.handlers.load_pre.remove(_before_loading)
    close_tool()


@bpy.app.handlers.persistent
def _before_loading(*_):
    close_tool()
