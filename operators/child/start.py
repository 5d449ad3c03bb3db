"""How a child Blender starts: on a copy of the file, with all that its job needs in one temporary folder."""

from __future__ import annotations

import pickle
import sys
import tempfile
from pathlib import Path

import bpy

from .job import FILE, JOB, Job, save_edited_images
from .process import ChildProcess


def start_child(long_part, scene, inputs: dict) -> ChildProcess:
    """Start a Blender that does the long part on a copy of the file. Raises OSError or RuntimeError."""
    folder = tempfile.TemporaryDirectory(
        prefix="panorama_", dir=bpy.app.tempdir, ignore_cleanup_errors=True
    )  # within Blender's own, which goes with it
    path = Path(folder.name)
    try:
        images = save_edited_images(path)
        _save_copy(path / FILE)
        job = Job(long_part, scene.name, inputs, images, use_scripts=not bpy.app.autoexec_fail)
        (path / JOB).write_bytes(pickle.dumps(job))
        return ChildProcess(folder, command(folder.name))
    except (OSError, RuntimeError):
        folder.cleanup()
        raise


def _save_copy(path):
    """Save a copy without the preview, a picture of the window that takes longer than all the rest."""
    preferences = bpy.context.preferences
    kept, is_dirty = preferences.filepaths.file_preview_type, preferences.is_dirty
    try:
        preferences.filepaths.file_preview_type = "NONE"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    finally:
        preferences.filepaths.file_preview_type, preferences.is_dirty = kept, is_dirty


def command(folder: str) -> list[str]:
    """The command line of the child: this Blender with the user's settings, for the sake of their GPU."""
    code = (
        f"import sys; sys.path += [path for path in {sys.path!r} if path not in sys.path]; "
        f"from importlib import import_module; import_module({Job.__module__!r}).main({folder!r})"
    )
    return [bpy.app.binary_path, "--background", "--python-exit-code", "1", "--python-expr", code]
