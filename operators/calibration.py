"""Operators that solve: the calibration, and the shapes."""

import bpy

from ..cycles_integration import roles
from ..cycles_integration.pieces import PIECE, kept_pieces
from . import progress, solving
from .reporting import Reporting, editable, possible


class PANORAMA_OT_calibrate(Reporting, bpy.types.Operator):
    """Find orientation and scale from the picks; picture, origin and built shapes move along"""

    bl_idname = "panorama.calibrate"
    bl_label = "Calibrate"

    @classmethod
    def poll(cls, context):
        """Picks and scale must be complete."""
        return possible(cls, progress.picks_missing(context.scene))

    def work(self, context):
        """Solve, and say how well."""
        found = solving.calibrate_scene(context.scene)
        for warning in found.warnings:
            self.report({"WARNING"}, warning)
        return f"Tilt {found.tilt_deg:.2f}° ± {found.uncertainty_tilt_deg:.2f}°"


class PANORAMA_OT_build(Reporting, bpy.types.Operator):
    """Build the shapes as meshes with their roles, or bring those built before up to date"""

    bl_idname = "panorama.build"
    bl_label = "Build Shapes"

    @classmethod
    def poll(cls, context):
        """Calibration and shapes must be complete."""
        return possible(cls, progress.shapes_missing(context.scene))

    def work(self, context):
        """Calibrate and rebuild."""
        solving.build_scene(context.scene)
        for shape in context.scene.panorama_set.shapes:
            for warning in shape.warnings.splitlines():
                self.report({"WARNING"}, f"{shape.name}: {warning}")
        kept = len(kept_pieces(context.scene.panorama_place))
        stayed = f"; {kept} that keep their picture stay as they are" if kept else ""
        return f"Built {len(context.scene.panorama_set.shapes)} shapes{stayed}"


class PANORAMA_OT_set_role(Reporting, bpy.types.Operator):
    """Say what the selected meshes are to the composite"""

    bl_idname = "panorama.set_role"
    bl_label = "Set Role"

    role: bpy.props.EnumProperty(
        name="Role", description="What the selected meshes are to the composite", items=roles.ROLES
    )

    @classmethod
    def poll(cls, context):
        """Something must be selected."""
        return possible(cls, progress.selection_missing(context))

    def work(self, context):
        """Set the role of all selected meshes, and of the shapes behind them."""
        meshes, warning = editable(progress.selected_meshes(context))
        state = context.scene.panorama_set
        shapes = {shape.name: shape for shape in state.shapes if shape.is_built}
        behind = [shapes[mesh[PIECE]] for mesh in meshes if mesh.get(PIECE) in shapes]
        if behind and self.role == roles.SYNTHETIC:
            raise ValueError(f"'{behind[0].name}' is a shape of the real place, so it cannot be synthetic")
        for shape in behind:
            shape.role = self.role
        for mesh in meshes:
            mesh.panorama_role = self.role
        state.maps_are_old = True
        if warning:
            self.report({"WARNING"}, warning)
        return f"{len(meshes)} objects: {self.role.title()}"


classes = (PANORAMA_OT_calibrate, PANORAMA_OT_build, PANORAMA_OT_set_role)
