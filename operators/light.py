"""Operators of the place's light: its maps, and its depth as a file."""

import bpy
import numpy as np
from bpy_extras.io_utils import ExportHelper

from ..cycles_integration import blender_images, maps
from ..cycles_integration.place import place_of, sort_objects
from ..cycles_integration.preparation import prepare, prepare_suns
from ..ibl_toolkit.images import RGBD, write_rgbd
from . import progress
from .reporting import Reporting, possible


class PANORAMA_OT_prepare(Reporting, bpy.types.Operator):
    """Make depth, lights, irradiance and materials of the place; Blender waits meanwhile, maybe minutes"""

    bl_idname = "panorama.prepare"
    bl_label = "Prepare Light"

    @classmethod
    def poll(cls, context):
        """There must be surfaces."""
        return possible(cls, progress.surfaces_missing(context.scene))

    def work(self, context):
        """Prepare, and keep what it spent and found."""
        state = context.scene.panorama_set
        job = state.job
        spent = prepare(context.scene, most_lights(job))
        job.seconds, job.coverage = sum(spent.seconds.values()), spent.coverage
        job.light_warnings = "\n".join(spent.warnings)
        job.lights_at_depth, job.lights_at_infinity = spent.at_depth.reason, spent.at_infinity.reason
        state.maps_are_old = False
        found = f"{spent.at_depth.reason}, {100 * spent.coverage:.0f} % with depth"
        return f"{found}, {job.seconds:.1f} s"


class PANORAMA_OT_light_from_infinity(Reporting, bpy.types.Operator):
    """Light the scene by the panorama as an ordinary light map: suns for its lamps where that lessens the
    noise, the rest in the World. Needs no surfaces"""

    bl_idname = "panorama.light_from_infinity"
    bl_label = "Light from Infinity"

    @classmethod
    def poll(cls, context):
        """There must be a calibrated panorama."""
        return possible(cls, progress.calibration_missing(context.scene))

    def work(self, context):
        """Make suns and World."""
        job = context.scene.panorama_set.job
        found = prepare_suns(context.scene, place_of(context.scene), most_lights(job))
        job.lights_at_infinity = found.reason
        return found.reason


def most_lights(job):
    """The most lights that are to be taken out of the map; None lets the map decide."""
    return {"AUTO": None, "NONE": 0, "LIMIT": job.most_lights}[job.lights]


class PANORAMA_OT_export_depth(Reporting, ExportHelper, bpy.types.Operator):
    """Render the distance of the real surfaces and write it with the photograph as an RGB-D panorama
    (OpenEXR, channel Z in metres)"""

    bl_idname = "panorama.export_depth"
    bl_label = "Write RGB-D"

    filename_ext = ".exr"
    filter_glob: bpy.props.StringProperty(default="*.exr", options={"HIDDEN"})
    width: bpy.props.IntProperty(
        name="Width",
        description="Width of the map [pixels], at most the panorama's; its height is half of it",
        default=2048,
        min=8,
        soft_max=16384,
        step=2,
    )

    @classmethod
    def poll(cls, context):
        """There must be surfaces."""
        return possible(cls, progress.surfaces_missing(context.scene))

    def work(self, context):
        """Render and write."""
        place = place_of(context.scene)
        width = min(self.width, place.image.size[0]) // 2 * 2
        sort_objects(context.scene, place)
        depth = maps.render_depth(context.scene, place, width)
        matrix = np.array(place.origin.matrix_world)
        image = np.ascontiguousarray(maps.shrink(blender_images.array_from_image(place.image), width))
        write_rgbd(self.filepath, RGBD(image, depth.depth, matrix[:3, :3], matrix[2, 3]))
        return f"Wrote {self.filepath}: {width} × {width // 2}, {100 * depth.coverage:.0f} % with depth"


classes = (PANORAMA_OT_prepare, PANORAMA_OT_light_from_infinity, PANORAMA_OT_export_depth)
