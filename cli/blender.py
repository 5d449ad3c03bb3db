"""Blender for a job: an empty file with the package registered, in a Python with bpy or in Blender itself."""

import os
from contextlib import contextmanager
from importlib import import_module

from .. import ROOMS


@contextmanager
def empty_scene(progress):
    """The scene of an empty file, for one job; its renders report to `progress`.

    Raises: ValueError without bpy.
    """
    bpy = _blender()
    # The user's add-ons stay as they are: read_factory_settings would take this one away while it runs.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with _registered(bpy), _reporting(bpy.app.handlers, progress):
        yield bpy.context.scene


@contextmanager
def opened_scene(path, progress):
    """The active scene of a .blend, for one job; its renders report to `progress`. Its scripts don't run.

    Raises: ValueError without bpy; OSError where the file cannot be read.
    """
    bpy = _blender()
    with _registered(bpy):
        with errors_of(path):
            bpy.ops.wm.open_mainfile(filepath=os.path.abspath(path), load_ui=False, use_scripts=False)
        with _reporting(bpy.app.handlers, progress):
            yield bpy.context.scene


def _blender():
    try:
        import bpy
    except ModuleNotFoundError as missing:
        raise ValueError(
            "this verb needs Blender: install bpy beside, or use blender --background --command panorama …"
        ) from missing
    return bpy


@contextmanager
def _registered(bpy):
    """The package registered, unless a Blender has done it; taken back, or bpy 4.5 hangs as it exits."""
    if hasattr(bpy.types.Scene, "panorama_place"):
        yield
        return
    names = [name for name in ROOMS if name != "cli"]  # its register makes the command known to a Blender
    rooms = [import_module(f"..{name}", __package__) for name in names]
    for room in rooms:
        room.register()
    try:
        yield
    finally:
        for room in reversed(rooms):
            room.unregister()


@contextmanager
def _reporting(handlers, progress):
    def report(text, *_):
        progress.on_render_stats(text)

    handlers.render_stats.append(report)
    try:
        yield
    finally:
        if report in handlers.render_stats:  # loading a file drops it
            handlers.render_stats.remove(report)


@contextmanager
def errors_of(path):
    """Turn what Blender's operators raise while they read or write a file into an OSError about it."""
    try:
        yield
    except RuntimeError as error:
        raise OSError(f"{path}: {' '.join(str(error).split())}") from error
