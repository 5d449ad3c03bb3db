"""Operators on the picture that meshes show: keep it, let it go, write it as a UV layer."""

import bpy

from ..cycles_integration import picture_coordinates
from ..cycles_integration.place import place_of
from . import progress
from .reporting import Reporting, possible


class _OnSelection(Reporting):
    """An operator on the selected meshes of a calibrated scene."""

    @classmethod
    def poll(cls, context):
        """There must be a calibration, and something selected."""
        reason = progress.calibration_missing(context.scene) or progress.selection_missing(context)
        return possible(cls, reason)


class PANORAMA_OT_store_coordinates(_OnSelection, bpy.types.Operator):
    """Keep on the selected meshes the part of the picture that they show now, however they are then moved,
    bent or duplicated"""

    bl_idname = "panorama.store_coordinates"
    bl_label = "Keep Picture"

    def work(self, context):
        """Store positions per vertex."""
        meshes = progress.selected_meshes(context)
        picture_coordinates.store_positions(place_of(context.scene), meshes)
        return f"{len(meshes)} objects keep their picture"


class PANORAMA_OT_clear_coordinates(_OnSelection, bpy.types.Operator):
    """Let the selected meshes show again what lies behind them as seen from the panorama's origin"""

    bl_idname = "panorama.clear_coordinates"
    bl_label = "Release Picture"

    def work(self, context):
        """Clear positions per vertex."""
        count = picture_coordinates.clear_positions(progress.selected_meshes(context))
        return f"{count} objects show the picture behind them again"


class PANORAMA_OT_write_uv(_OnSelection, bpy.types.Operator):
    """Write the picture that the selected meshes show as the UV layer 'Panorama UV', for other programs.
    Faces are divided where the error needs it"""

    bl_idname = "panorama.write_uv"
    bl_label = "Write UV Layer"

    divide: bpy.props.BoolProperty(
        name="Divide Faces",
        description="Replace the mesh by triangles small enough for the error; its other layers are lost",
        default=True,
    )
    max_error_px: bpy.props.FloatProperty(
        name="Largest Error",
        description="How far off the layer may be, in pixels of the panorama",
        default=1,
        min=0.05,
        soft_max=10,
    )

    def work(self, context):
        """Write the layer on each mesh."""
        place = place_of(context.scene)
        limit = self.max_error_px if self.divide else None
        meshes = progress.selected_meshes(context)
        worst = picture_coordinates.write_uv(place, meshes, limit)
        return f"UV layer on {len(meshes)} objects, at most {worst:.2f} pixels off"


classes = (PANORAMA_OT_store_coordinates, PANORAMA_OT_clear_coordinates, PANORAMA_OT_write_uv)
