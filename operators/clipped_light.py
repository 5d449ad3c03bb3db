"""The operator that restores a lamp which the capture clipped."""

import bpy
import numpy as np

from ..cycles_integration import blender_images
from ..cycles_integration.place import place_of
from ..cycles_integration.place_digest import digest_of_image
from ..ibl_toolkit.images import write_exr
from ..ibl_toolkit.light.clipping import find_clipping, irradiance_from_shadow, restored
from . import progress
from .long_work import LongExport


def restore_light(scene, tell, path, known, value):
    """The long part: write the panorama with its lamp restored -> how many times as bright that is then."""
    tell("lights")
    place = place_of(scene)
    image = np.maximum(blender_images.array_from_image(place.image), 0)
    clipping, wanted = find_clipping(image), value
    if known == "RATIO":
        up = np.array(place.origin.matrix_world)[2, :3]
        wanted = irradiance_from_shadow(image, clipping, value, up)
    whole = restored(image, clipping, wanted)
    tell("writing")
    write_exr(path, {name: whole[..., k] for k, name in enumerate("RGB")})
    return float(whole.max() / image.max())


class PANORAMA_OT_restore_light(LongExport, bpy.types.Operator):
    """Give a lamp that the capture clipped the light it lacks, write the panorama so restored (OpenEXR) and
    use it from now on. Esc cancels"""

    bl_idname = "panorama.restore_light"
    bl_label = "Restore Clipped Light"

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

    long_part = staticmethod(restore_light)
    missing = staticmethod(progress.calibration_missing)  # since the floor must be known
    depends_on = staticmethod(digest_of_image)

    def inputs(self, context):
        """File, and what is known."""
        return {"path": self.path(), "known": self.known, "value": self.value}

    def apply(self, scene, found):
        """Open what was written."""
        place, state = place_of(scene), scene.panorama_set
        state.image = place.image = blender_images.load_radiance(self.path())
        state.image_path, state.maps_are_old = self.filepath, True
        bpy.ops.ed.undo_push(message=self.bl_label)
        return f"The clipped lamp is {found:.3g} times as bright now: prepare the light again"


classes = (PANORAMA_OT_restore_light,)
