"""Operators of the place's light: its maps, and its depth as a file."""

import bpy
import numpy as np

from ..cycles_integration import blender_images, maps, preparation
from ..cycles_integration.place import place_of, sort_objects
from ..cycles_integration.place_digest import digest_of_image, digest_of_place
from ..ibl_toolkit.images import RGBD, write_rgbd
from . import progress
from .long_work import LongExport, LongWork


def measure_light(scene, tell, most):
    """The long part of Prepare Light."""
    return preparation.measure(scene, most, tell)


def measure_suns(scene, tell, most):
    """The long part of Light from Infinity."""
    tell("lights")
    return preparation.measure_suns(place_of(scene), most)


def export_depth(scene, tell, path, width):
    """The long part of Write RGB-D -> what was written."""
    place = place_of(scene)
    width = min(width, place.image.size[0]) // 2 * 2
    tell("depth")
    sort_objects(scene, place)
    depth = maps.render_depth(scene, place, width)
    tell("writing")
    matrix = np.array(place.origin.matrix_world)
    image = np.ascontiguousarray(maps.shrink(blender_images.array_from_image(place.image), width))
    write_rgbd(path, RGBD(image, depth.depth, matrix[:3, :3], matrix[2, 3]))
    return f"Wrote {path}: {width} × {width // 2}, {100 * depth.coverage:.0f} % with depth"


class PANORAMA_OT_prepare(LongWork, bpy.types.Operator):
    """Make depth, lights, irradiance and materials of the place: seconds to minutes, in which you can go on
    working; Esc cancels"""

    bl_idname = "panorama.prepare"
    bl_label = "Prepare Light"

    long_part = staticmethod(measure_light)
    missing = staticmethod(progress.surfaces_missing)
    depends_on = staticmethod(digest_of_place)

    def inputs(self, context):
        """How many lights to look for."""
        return {"most": most_lights(context.scene.panorama_set.job)}

    def apply(self, scene, found):
        """Give the place its light, and keep what was spent and found."""
        spent = preparation.apply(scene, found)
        state = scene.panorama_set
        job = state.job
        job.seconds, job.coverage = sum(spent.seconds.values()), spent.coverage
        job.light_warnings = "\n".join(spent.warnings)
        job.lights_at_depth, job.lights_at_infinity = spent.at_depth.reason, spent.at_infinity.reason
        state.maps_are_old = False
        found = f"{spent.at_depth.reason}, {100 * spent.coverage:.0f} % with depth"
        return f"{found}, {job.seconds:.1f} s"


class PANORAMA_OT_light_from_infinity(LongWork, bpy.types.Operator):
    """Light the scene by the panorama as an ordinary light map: suns for its lamps where that lessens the
    noise, the rest in the World. Needs no surfaces. Esc cancels"""

    bl_idname = "panorama.light_from_infinity"
    bl_label = "Light from Infinity"

    long_part = staticmethod(measure_suns)
    missing = staticmethod(progress.calibration_missing)
    depends_on = staticmethod(digest_of_image)

    def inputs(self, context):
        """How many suns to look for."""
        return {"most": most_lights(context.scene.panorama_set.job)}

    def apply(self, scene, found):
        """Make suns and World."""
        lights = preparation.apply_suns(scene, place_of(scene), found)
        scene.panorama_set.job.lights_at_infinity = lights.reason
        return lights.reason


def most_lights(job):
    """The most lights that are to be taken out of the map; None lets the map decide."""
    return {"AUTO": None, "NONE": 0, "LIMIT": job.most_lights}[job.lights]


class PANORAMA_OT_export_depth(LongExport, bpy.types.Operator):
    """Render the distance of the real surfaces and write it with the photograph as an RGB-D panorama
    (OpenEXR, channel Z in metres). Esc cancels"""

    bl_idname = "panorama.export_depth"
    bl_label = "Write RGB-D"

    width: bpy.props.IntProperty(
        name="Width",
        description="Width of the map [pixels], at most the panorama's; its height is half of it",
        default=2048,
        min=8,
        soft_max=16384,
        step=2,
    )

    long_part = staticmethod(export_depth)
    missing = staticmethod(progress.surfaces_missing)

    def inputs(self, context):
        """File and size."""
        return {"path": self.path(), "width": self.width}

    def apply(self, scene, found):
        """The scene stays."""
        return found


classes = (PANORAMA_OT_prepare, PANORAMA_OT_light_from_infinity, PANORAMA_OT_export_depth)
