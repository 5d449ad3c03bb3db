"""Blender's own render job, which Esc ends: then the operator that began it is undone."""

import bpy

POLL_EVERY = 0.2
"""[s]"""
_began_by = ""
_is_cancelled = False


def running() -> str:
    """Why no other render can begin, "" where none runs."""
    return "Blender is rendering: wait, or cancel it with Esc" if bpy.app.is_job_running("RENDER") else ""


def start(operator: str):
    """Render in Blender's render window, for the operator of this idname, which pushes the next undo step."""
    global _began_by, _is_cancelled
    _began_by, _is_cancelled = operator, False
    bpy.app.handlers.render_cancel.append(_cancelled)
    bpy.app.timers.register(_watch, first_interval=POLL_EVERY)
    bpy.ops.render.render("INVOKE_DEFAULT")


def unregister():
    """Watch no more."""
    if bpy.app.timers.is_registered(_watch):
        bpy.app.timers.unregister(_watch)
    if _cancelled in bpy.app.handlers.render_cancel:  # loading a file drops it
        bpy.app.handlers.render_cancel.remove(_cancelled)


def _cancelled(*_):
    """Blender calls this from the render's thread, so it touches no Blender data."""
    global _is_cancelled
    _is_cancelled = True


def _watch():
    if running():
        return POLL_EVERY
    unregister()
    manager = bpy.context.window_manager
    is_last = bool(manager.operators) and manager.operators[-1].bl_idname == _began_by
    if _is_cancelled and is_last:  # else the artist went on, and it is theirs to undo
        with bpy.context.temp_override(window=manager.windows[0]):
            if bpy.ops.ed.undo.poll():
                bpy.ops.ed.undo()
    return None
