"""The operator that makes sample balls and the place's look-up assets in the Asset Browser."""

from pathlib import Path

import bpy

from ..cycles_integration import assets
from ..cycles_integration.place import place_of
from . import progress
from .probes import BALLS, new_ball
from .reporting import Reporting

LIBRARY = "Expanded Panoramas"
RADIUS = 0.15


class PANORAMA_OT_add_asset_library(Reporting, bpy.types.Operator):
    """Put the sample balls and, once calibrated, this panorama's look-up node group into the Asset Browser,
    as the library "Expanded Panoramas". Called again, it brings them up to date"""

    bl_idname = "panorama.add_asset_library"
    bl_label = "Add to Asset Browser"
    bl_options = {"REGISTER"}  # the scene stays as it is

    directory: bpy.props.StringProperty(
        name="Folder",
        description="Folder of the library's .blend files; none: the extension's own folder of user files",
        subtype="DIR_PATH",
        options={"SKIP_SAVE"},
    )

    def work(self, context):
        """Write the files, then register their folder."""
        folder = Path(bpy.path.abspath(self.directory)) if self.directory else own_folder()
        folder.mkdir(parents=True, exist_ok=True)
        balls = {kind: new_ball(kind, RADIUS) for kind, *_ in BALLS}
        try:
            assets.write_balls(folder, balls)
        finally:
            for ball in balls.values():
                _remove(ball)
        names = [name for _, name, _ in BALLS]
        if not progress.calibration_missing(context.scene):
            names.append(assets.write_lookup(folder, place_of(context.scene)))
        is_new = assets.add_library(context.preferences, LIBRARY, folder)
        return f"{', '.join(names)} in the {'new ' if is_new else ''}asset library '{LIBRARY}': {folder}"


def own_folder() -> Path:
    """The folder that Blender gives the extension for files.

    Raises ValueError where the package runs as no extension and so has none.
    """
    package = __package__.rpartition(".")[0]
    try:
        return Path(bpy.utils.extension_path_user(package, path="assets", create=True))
    except ValueError as error:
        raise ValueError(
            "no folder for the assets: only an installed extension has one; give a folder of yours"
        ) from error


def _remove(ball):
    mesh, materials = ball.data, list(ball.data.materials)
    bpy.data.objects.remove(ball)
    bpy.data.meshes.remove(mesh)
    for material in materials:
        bpy.data.materials.remove(material)


classes = (PANORAMA_OT_add_asset_library,)
