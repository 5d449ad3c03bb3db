"""Operators of the panorama in layers: made of the place, opened as objects, written for other programs."""

from __future__ import annotations

from dataclasses import replace

import bpy
from bpy_extras.io_utils import ExportHelper

from ..cycles_integration import roles
from ..cycles_integration.layer_capture import LayerCapture, capture_surfaces
from ..cycles_integration.layer_objects import add_layers
from ..cycles_integration.layer_scene import frame_of
from ..cycles_integration.pieces import PIECE
from ..cycles_integration.place_layers import capture_place
from ..cycles_integration.rgbd_place import NAME as DEPTH
from ..ibl_toolkit.images import is_rgbd, read_rgbd
from ..ibl_toolkit.images.atomic import refuse_unwritable
from ..ibl_toolkit.layers.export.writing import export_layers
from ..ibl_toolkit.layers.files.folder import refuse_other_folder, write_folder
from ..ibl_toolkit.layers.files.storage import read_layers
from ..ibl_toolkit.layers.making.check import check_layers
from ..ibl_toolkit.layers.making.from_rgbd import layers_of
from ..ibl_toolkit.layers.making.sorting import Classes, sorted_layers
from . import progress
from .layer_properties import folder_of, look_into_folder
from .long_work import LongWork
from .reporting import Reporting, possible

FORMATS = (
    (".glb", "glTF (.glb)", "One file with textures, for viewers, game engines and the web"),
    (".obj", "Wavefront (.obj)", "Text, with materials and textures beside it"),
    (".ply", "PLY (.ply)", "A coloured point for each pixel, for point-cloud programs"),
)


def make_layers(scene, tell, folder, radius, width, most, classes):
    """The long part of Make Layers: writes them -> how many there are, and a line for each thing amiss.

    classes: keywords of `Classes`.
    """
    panorama, continuous = _captured(scene, tell, radius or None, width, most)
    if any(classes.values()):
        tell("sorting")
        panorama, _ = sorted_layers(panorama, Classes(**classes))
    tell("writing")
    write_folder(panorama, folder)
    tell("checking")
    report = check_layers(panorama)
    return len(panorama.layers), (report if continuous else replace(report, jumps={})).warnings


def _captured(scene, tell, radius, width, most):
    """A panorama, and whether its layers should be continuous in depth.

    Surfaces are kept as they are rendered: where their depth jumps their meshes are cut.
    """
    path = bpy.path.abspath(scene.panorama_set.image_path)
    if not path:
        cycles = scene.cycles
        options = LayerCapture(width, cycles.samples, most, cycles.use_denoising, cycles.seed)
        return capture_surfaces(scene, frame_of(scene), radius, options, tell), False
    if [thing.get(PIECE) for thing in roles.real_objects(scene)] != [DEPTH] or not is_rgbd(path):
        options = LayerCapture(width=width, samples=1, most=most)
        return capture_place(scene, radius, options, tell), False
    tell("layers")  # of the file's own depth, which that one surface follows only so far
    return layers_of(read_rgbd(path), radius, most), True


def making_missing(scene) -> str:
    """What Make Layers needs: a place, or without a panorama a scene and the camera where it is captured."""
    if scene.panorama_set.image_path:
        missing = progress.surfaces_missing(scene)
    else:
        missing = "" if scene.camera else "Open a panorama, or add a camera to a scene of your own"
    return missing or ("" if scene.panorama_layers.folder else "Choose a folder for the layers")


def layers_missing(scene) -> str:
    """What opening and writing layers need."""
    layers = scene.panorama_layers
    return "" if layers.found else layers.problem or "Choose a folder with layers, or make them"


class PANORAMA_OT_make_layers(LongWork, bpy.types.Operator):
    """Make a panorama in layers of the place: what is seen from the point of capture, and behind it what
    comes into sight within the radius. Without a panorama, Cycles renders it of the scene itself from where
    its camera stands, with the scene's samples. It goes into the folder, in the stead of layers that are
    there. Seconds to minutes, in which you can go on working; Esc cancels"""

    bl_idname = "panorama.make_layers"
    bl_label = "Make Layers"

    long_part = staticmethod(make_layers)
    missing = staticmethod(making_missing)

    def inputs(self, context):
        """Folder and sizes. Raises ValueError where the folder has other files in it."""
        layers = context.scene.panorama_layers
        folder = folder_of(layers)
        refuse_other_folder(folder)
        return {
            "folder": folder,
            "radius": layers.radius,
            "width": layers.width // 2 * 2,
            "most": layers.most,
            "classes": {"geometry": layers.geometry, "infinity": layers.infinity},
        }

    def apply(self, scene, found):
        """Note what the folder holds now."""
        count, warnings = found
        look_into_folder(scene.panorama_layers)
        for warning in warnings:
            self.report({"WARNING"}, warning)
        return f"{count} layer{'s' if count > 1 else ''} in {scene.panorama_layers.folder}"


class PANORAMA_OT_open_layers(Reporting, bpy.types.Operator):
    """Add the folder's layers as objects: a mesh for each, showing its own part of the panorama, all below
    one Empty that can be moved and turned. Where the scene has a place, they get a scene of their own"""

    bl_idname = "panorama.open_layers"
    bl_label = "Open Layers"

    @classmethod
    def poll(cls, context):
        """There must be layers, and nothing be edited."""
        editing = "" if context.mode == "OBJECT" else "Only in Object Mode"
        return possible(cls, editing or layers_missing(context.scene))

    def work(self, context):
        """Read them and add their objects."""
        scene = context.scene
        panorama = read_layers(folder_of(scene.panorama_layers))
        if not progress.calibration_missing(scene):  # they would stand in the place's own pictures
            scene = _scene_like(scene)
        try:
            made = add_layers(scene, panorama)
        except ValueError:
            if scene != context.scene:
                bpy.data.scenes.remove(scene)
            raise
        if context.window:
            context.window.scene = scene
        triangles = sum(len(thing.data.polygons) for thing in made.objects)
        return f"{len(made.objects)} meshes with {triangles} triangles in scene '{scene.name}'"


class PANORAMA_OT_export_layers(Reporting, ExportHelper, bpy.types.Operator):
    """Write the folder's layers as meshes with their pictures, or as points, for other programs. Their light
    is clipped to 8 bits; the factor that it was multiplied with is reported"""

    bl_idname = "panorama.export_layers"
    bl_label = "Export Layers"
    bl_options = set()

    file_format: bpy.props.EnumProperty(
        name="Format", description="Kind of file that is written", items=FORMATS
    )
    filter_glob: bpy.props.StringProperty(default="*.glb;*.obj;*.ply", options={"HIDDEN"})

    @property
    def filename_ext(self) -> str:
        """What the file browser ends names with."""
        return self.file_format

    @classmethod
    def poll(cls, context):
        """There must be layers."""
        return possible(cls, layers_missing(context.scene))

    def work(self, context):
        """Read them and write the file."""
        path = bpy.path.ensure_ext(bpy.path.abspath(self.filepath), self.file_format)
        refuse_unwritable(path)
        done = export_layers(read_layers(folder_of(context.scene.panorama_layers)), path)
        vertices = sum(layer.vertices for layer in done.layers)
        triangles = sum(layer.triangles for layer in done.layers)
        light = f"radiance × {done.exposure:.4g}, {100 * done.clipped:.3g} % of the pixels clipped"
        return f"Wrote {path}: {vertices} vertices, {triangles} triangles, {light}"


def _scene_like(scene):
    """An empty scene that is rendered and shown in the same way, with the same layers."""
    other = bpy.data.scenes.new("Layers")
    other.render.engine = scene.render.engine
    other.view_settings.view_transform = scene.view_settings.view_transform
    other.panorama_layers.folder = scene.panorama_layers.folder
    return other


classes = (PANORAMA_OT_make_layers, PANORAMA_OT_open_layers, PANORAMA_OT_export_layers)
