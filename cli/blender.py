"""Blender for a job: an empty file with the package registered, in a Python with bpy or in Blender itself."""

from contextlib import contextmanager
from importlib import import_module

from .. import ROOMS


@contextmanager
def empty_scene(progress):
    """The scene of an empty file, for one job; its renders report to `progress`.

    Raises: ValueError without bpy.
    """
    try:
        import bpy
    except ModuleNotFoundError as missing:
        raise ValueError(
            "this verb needs Blender: install bpy beside, or use blender --background --command panorama …"
        ) from missing
    # The user's add-ons stay as they are: read_factory_settings would take this one away while it runs.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    _register_once(bpy)
    progress.blender_folder = bpy.app.tempdir
    with _reporting(bpy.app.handlers, progress):
        yield bpy.context.scene


def _register_once(bpy):
    if hasattr(bpy.types.Scene, "panorama_place"):
        return
    for room in ROOMS:
        if room != "cli":  # whose register makes the command known to a Blender
            import_module(f"..{room}", __package__).register()


@contextmanager
def _reporting(handlers, progress):
    def begin(*_):
        progress.rendering = True

    def end(*_):
        progress.rendering = False

    def stats(text, *_):
        progress.on_render_stats(text)

    ours = {"render_init": begin, "render_stats": stats, "render_complete": end, "render_cancel": end}
    for name, handler in ours.items():
        getattr(handlers, name).append(handler)
    try:
        yield
    finally:
        for name, handler in ours.items():
            listed = getattr(handlers, name)
            if handler in listed:  # loading a file drops them
                listed.remove(handler)


@contextmanager
def errors_of(path):
    """Turn what Blender's operators raise while they read or write a file into an OSError about it."""
    try:
        yield
    except RuntimeError as error:
        raise OSError(f"{path}: {' '.join(str(error).split())}") from error
