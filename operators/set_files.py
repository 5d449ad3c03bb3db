"""Operators that open a panorama, and read and write the set file."""

import math
from dataclasses import replace
from pathlib import Path

import bpy
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..cycles_integration.objects_file import append_objects
from ..cycles_integration.rgbd_place import load_rgbd
from ..cycles_integration.shipped import shipped_panorama
from ..ibl_toolkit.images import is_rgbd
from ..ibl_toolkit.panorama_set import read_set, write_set
from . import conversion, progress, solving
from .reporting import Reporting, possible

SAMPLE_SET = Path(__file__).parents[1] / "sample_scenes" / "hotel_room.json"


class _Opening(Reporting, ImportHelper):
    """An operator that opens a file: the one that was dropped, else the one chosen in a File Browser."""

    filepath: bpy.props.StringProperty(
        name="File", description="The file to open", subtype="FILE_PATH", options={"SKIP_SAVE", "HIDDEN"}
    )

    def invoke(self, context, event):
        """Open what was dropped, or ask."""
        return self.execute(context) if self.filepath else super().invoke(context, event)


class PANORAMA_OT_load_image(_Opening, bpy.types.Operator):
    """Open an HDR panorama (OpenEXR or Radiance .hdr, twice as wide as high). Picks and shapes stay"""

    bl_idname = "panorama.load_image"
    bl_label = "Open Panorama"

    filter_glob: bpy.props.StringProperty(default="*.exr;*.hdr", options={"HIDDEN"})

    def work(self, context):
        """Check and load the file."""
        return open_image(context, self.filepath)


class PANORAMA_OT_load_rgbd(_Opening, bpy.types.Operator):
    """Open a panorama with depth (.exr, as "Write RGB-D" makes it): calibrated, its depth as a surface"""

    bl_idname = "panorama.load_rgbd"
    bl_label = "Open RGB-D Panorama"

    filename_ext = ".exr"
    filter_glob: bpy.props.StringProperty(default="*.exr", options={"HIDDEN"})

    def work(self, context):
        """Make the place of the file."""
        return open_rgbd(context, self.filepath)


class PANORAMA_OT_drop_image(_Opening, bpy.types.Operator):
    """Open a panorama that was dropped into the window: with its depth and calibration where it has them"""

    bl_idname = "panorama.drop_image"
    bl_label = "Open as HDR Panorama"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    filter_glob: bpy.props.StringProperty(default="*.exr;*.hdr", options={"HIDDEN"})

    def work(self, context):
        """Open it as what its header says."""
        return (open_rgbd if is_rgbd(self.filepath) else open_image)(context, self.filepath)


class PANORAMA_OT_import_set(_Opening, bpy.types.Operator):
    """Read a panorama set (.json): image, picks and shapes. They replace those of this scene"""

    bl_idname = "panorama.import_set"
    bl_label = "Import Set"

    filename_ext = ".json"
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})

    def work(self, context):
        """Read the file and its image, then replace the scene's set."""
        return open_set(context, read_set(self.filepath))


class PANORAMA_OT_load_sample(Reporting, bpy.types.Operator):
    """Open the hotel room that ships with Blender: image, picks and shapes. They replace those of this
    scene"""

    bl_idname = "panorama.load_sample"
    bl_label = "Load Sample Room"

    def work(self, context):
        """Replace the scene's set by the sample's."""
        sample = read_set(SAMPLE_SET)
        return open_set(context, replace(sample, image=shipped_panorama(sample.image.name)))


class PANORAMA_OT_export_set(Reporting, ExportHelper, bpy.types.Operator):
    """Write image, picks and shapes of this scene to a panorama set (.json), as the command line reads it"""

    bl_idname = "panorama.export_set"
    bl_label = "Export Set"
    bl_options = {"REGISTER"}

    filename_ext = ".json"
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        """A set needs an image."""
        return possible(cls, progress.image_missing(context.scene))

    def work(self, context):
        """Write the file."""
        write_set(conversion.set_from_state(context.scene.panorama_set), self.filepath)
        return f"Wrote {self.filepath}"


class PANORAMA_OT_append_objects(Reporting, ImportHelper, bpy.types.Operator):
    """Append objects, lights and cameras of a .blend file's first scene; what has no role there is new"""

    bl_idname = "panorama.append_objects"
    bl_label = "Append Objects"

    filename_ext = ".blend"
    filter_glob: bpy.props.StringProperty(default="*.blend", options={"HIDDEN"})

    def invoke(self, context, event):
        """Begin with the file that the set names."""
        self.filepath = bpy.path.abspath(context.scene.panorama_set.objects_path)
        return super().invoke(context, event)

    def work(self, context):
        """Append, remember the file, and look through its camera where the scene has none."""
        scene = context.scene
        appended = append_objects(scene, self.filepath)
        scene.panorama_set.objects_path = self.filepath
        scene.camera = scene.camera or appended.active_camera
        return f"{len(appended.objects)} objects, {len(appended.cameras)} of them cameras"


def open_image(context, path) -> str:
    """Check and load a panorama; picks and shapes stay. Returns the line to report."""
    state = context.scene.panorama_set
    image = solving.load_panorama(path)
    state.image, state.image_path = image, str(path)
    state.calibration_is_old = state.result.is_solved
    show_in_image_editors(context, image)
    depth = "; its depth is opened by Open RGB-D Panorama" if is_rgbd(path) else ""
    return f"{image.name}: {image.size[0]} × {image.size[1]} pixels{depth}"


def open_rgbd(context, path) -> str:
    """Make the place of an RGB-D file; picks and shapes of the scene go, since the file needs none."""
    loaded = load_rgbd(context.scene, path)
    take_calibrated(context.scene, loaded.place, path, loaded.camera_height)
    show_in_image_editors(context, loaded.place.image)
    faces, error = len(loaded.surface.mesh.faces), 100 * loaded.surface.median_error
    return f"{faces} faces, half of them within {error:.2g} % of the depth"


def take_calibrated(scene, place, path, camera_height):
    """Take a place that came calibrated: picks and shapes go, and what was told of an earlier calibration."""
    state = scene.panorama_set
    state.picks.clear()
    state.shapes.clear()
    state.image, state.image_path = place.image, str(path)
    for field in state.result.bl_rna.properties:
        state.result.property_unset(field.identifier)
    state.result.camera_height, state.result.is_solved = camera_height, True
    up = place.origin.matrix_world.col[2]
    state.result.tilt_deg = math.degrees(math.acos(max(-1, min(up.z, 1))))
    state.problem = ""
    state.calibration_is_old, state.maps_are_old = False, True


def open_set(context, panorama_set) -> str:
    """Load a set's image, then replace the scene's set by it."""
    image = solving.load_panorama(panorama_set.image)
    state = context.scene.panorama_set
    conversion.state_from_set(state, panorama_set)
    state.image = image
    show_in_image_editors(context, image)
    return f"{image.name} with {len(state.picks)} picks and {len(state.shapes)} shapes"


def show_in_image_editors(context, image):
    """Show the panorama in the open Image Editors of the windows on this scene, where points are picked."""
    for window in context.window_manager.windows:
        for area in window.screen.areas if window.scene == context.scene else ():
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image


classes = (
    PANORAMA_OT_load_image,
    PANORAMA_OT_load_rgbd,
    PANORAMA_OT_drop_image,
    PANORAMA_OT_load_sample,
    PANORAMA_OT_import_set,
    PANORAMA_OT_export_set,
    PANORAMA_OT_append_objects,
)
