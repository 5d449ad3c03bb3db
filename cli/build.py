"""`panorama build SET -o SCENE.blend`: the place as a Blender file, ready for objects.

Of an RGB-D panorama (`panorama build MAP.exr …`) the depth becomes the one surface.
"""

import os
from pathlib import Path

from ..ibl_toolkit.images import replacing
from . import blender
from .job import open_job, place_in, rebuild, refuse_output
from .progress import Progress

INPUT = "panorama set (.json), or an RGB-D panorama (.exr)"
SUMMARY = "rebuild the place as a Blender file: meshes with roles and materials, origin, world"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "SCENE.blend", ".blend", True


def add_options(_parser):
    """It has none."""


def run(set_path, output, _options, progress):
    """Do the verb -> what `--json` prints."""
    return build_scene(set_path, output, progress)


def build_scene(set_path, output, progress=None):
    """Write the .blend of a place, prepared for rendering -> {"shapes": [...]}, sizes in metres.

    set_path: a panorama set, or an RGB-D panorama (.exr).
    """
    progress = progress or Progress()
    make_place = _from_depth(set_path) if Path(set_path).suffix == ".exr" else _from_set(set_path, output)
    refuse_output(output, ".blend", ())
    with blender.empty_scene(progress) as scene:
        from ..cycles_integration import preparation

        made, pieces = make_place(scene)
        with progress.step("preparing"):
            preparation.prepare(scene)
        with progress.step("writing"):
            _save(Path(output), made.image)
    return {"shapes": [piece.to_json() for piece in pieces]}


def _from_set(path, output):
    job = open_job(path)
    refuse_output(output, ".blend", (job.set.objects,))
    pieces = rebuild(job)
    return lambda scene: (place_in(scene, job, pieces), pieces)


def _from_depth(path):
    def make_place(scene):
        from ..cycles_integration.rgbd_place import load_rgbd

        loaded = load_rgbd(scene, path)
        return loaded.place, [loaded.piece]

    return make_place


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
