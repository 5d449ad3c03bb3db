"""The operator that restores a lamp which the capture clipped."""

import bpy
import numpy as np
from bpy_extras.io_utils import ExportHelper

from ..cycles_integration import blender_images
from ..cycles_integration.place import place_of
from ..ibl_toolkit.images import write_exr
from ..ibl_toolkit.light.clipping import find_clipping, irradiance_from_shadow, restored
from . import progress
from .reporting import Reporting, possible


class PANORAMA_OT_restore_light(Reporting, ExportHelper, bpy.types.Operator):
    """Give a lamp that the capture clipped the light it lacks, write the panorama so restored (OpenEXR) and
    use it from now on"""

    bl_idname = "panorama.restore_light"
    bl_label = "Restore Clipped Light"

    filename_ext = ".exr"
    filter_glob: bpy.props.StringProperty(default="*.exr", options={"HIDDEN"})
    known: bpy.props.EnumProperty(
        name="Known",
        description="What is known of the lamp",
        items=(
            ("RATIO", "Lit over Shadow", "How many times as bright the floor is in the light as out of it"),
            ("IRRADIANCE", "Irradiance", "What the lamp brings to a surface that faces it [radiance × sr]"),
        ),
    )
    value: bpy.props.FloatProperty(
        name="Value", description="The ratio, or the irradiance [radiance × sr]", default=5.0, min=0.0
    )

    @classmethod
    def poll(cls, context):
        """There must be a calibrated panorama, since the floor must be known."""
        return possible(cls, progress.calibration_missing(context.scene))

    def work(self, context):
        """Restore, write, and open what was written."""
        place = place_of(context.scene)
        image = np.maximum(blender_images.array_from_image(place.image), 0)
        clipping, wanted = find_clipping(image), self.value
        if self.known == "RATIO":
            up = np.array(place.origin.matrix_world)[2, :3]
            wanted = irradiance_from_shadow(image, clipping, self.value, up)
        whole = restored(image, clipping, wanted)
        write_exr(self.filepath, {name: whole[..., k] for k, name in enumerate("RGB")})
        state = context.scene.panorama_set
        state.image = place.image = blender_images.load_radiance(self.filepath)
        state.image_path, state.maps_are_old = self.filepath, True
        factor = float(whole.max() / image.max())
        return f"The clipped lamp is {factor:.3g} times as bright now: prepare the light again"


classes = (PANORAMA_OT_restore_light,)
