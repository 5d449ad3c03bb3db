"""`panorama build SET -o SCENE.blend`: the place as a Blender file, ready for objects."""

import os
from pathlib import Path

from ..ibl_toolkit.images import replacing
from . import blender
from .job import open_job, place_in, rebuild, refuse_output
from .progress import Progress

SUMMARY = "rebuild the place as a Blender file: meshes with roles and materials, origin, world"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "SCENE.blend", ".blend", True


def add_options(_parser):
    """It has none."""


def run(set_path, output, _options, progress):
    """Do the verb -> what `--json` prints."""
    return build_scene(set_path, output, progress)


def build_scene(set_path, output, progress=None):
    """Write the .blend of a set's place, prepared for rendering -> {"shapes": [...]}, sizes in metres."""
    progress = progress or Progress()
    job = open_job(set_path)
    refuse_output(output, ".blend", (job.set.objects,))
    pieces = rebuild(job)
    with blender.empty_scene(progress) as scene:
        from ..cycles_integration import preparation

        made = place_in(scene, job, pieces)
        with progress.step("preparing"):
            preparation.prepare(scene)
        with progress.step("writing"):
            _save(Path(output), made.image)
    return {"shapes": [piece.to_json() for piece in pieces]}


def _save(path, image):
    import bpy

    folder = os.path.abspath(path.parent)
    # On Windows no relative path leads to another drive.
    if os.path.splitdrive(folder)[0] == os.path.splitdrive(image.filepath)[0]:
        image.filepath = bpy.path.relpath(image.filepath, start=folder)
    with replacing(path) as temporary, blender.errors_of(path):
        bpy.ops.wm.save_as_mainfile(
            filepath=os.path.abspath(temporary),
            copy=True,
            compress=True,
            relative_remap=False,
            check_existing=False,
        )


def describe(result):
    """One line per shape."""
    return [
        f"{shape['name']}: {shape['kind']}, {' × '.join(f'{length:.3f}' for length in shape['size'])} m, "
        f"{shape['vertices']} vertices, {shape['faces']} faces, residual {shape['residual']:.4f} m"
        for shape in result["shapes"]
    ]
