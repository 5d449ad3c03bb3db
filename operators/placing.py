"""The operator that puts objects where the cursor points: on the floor of the place, or on a support."""

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Vector

from ..cycles_integration import roles, standing
from ..cycles_integration.pieces import PIECE
from ..cycles_integration.place import place_of
from ..ibl_toolkit.equirectangular import direction_from_uv
from . import progress
from .canvas import canvas_of
from .reporting import Reporting, editable, possible


class PANORAMA_OT_send_to_place(Reporting, bpy.types.Operator):
    """Stand the selected objects where the cursor points: their lowest point on the floor or on a support
    of the place, turned as they are. Meshes become synthetic. From a menu or button, click the spot next"""

    bl_idname = "panorama.send_to_place"
    bl_label = "Send to This Place"
    bl_options = {"REGISTER", "UNDO", "DEPENDS_ON_CURSOR"}
    bl_cursor_pending = "CROSSHAIR"

    location: bpy.props.FloatVectorProperty(
        name="Location",
        description="Where the middle of the objects' lowest side comes to, in the world",
        size=3,
        subtype="TRANSLATION",
        unit="LENGTH",
    )

    @classmethod
    def poll(cls, context):
        """There must be a calibrated place, and something selected."""
        reason = progress.calibration_missing(context.scene)
        if not reason and context.mode != "OBJECT":
            reason = "Only in Object Mode"
        return possible(cls, reason or ("" if context.selected_objects else "Select objects first"))

    def invoke(self, context, event):
        """Find the spot under the mouse, then send the objects there."""
        try:
            ray = ray_under(context, event)
            spot, self.carrier = standing.spot_under(context.scene, context.evaluated_depsgraph_get(), *ray)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.location = spot
        return self.execute(context)

    def work(self, context):
        """Move them as one, by one step."""
        place = place_of(context.scene)
        things, warning = sendable(place, context.selected_objects)
        low, high = standing.bounds(things, context.evaluated_depsgraph_get())
        foot = (*(low[:2] + high[:2]) / 2, low[2])
        standing.move_by(things, Vector(self.location) - Vector(foot))
        for thing in things:
            if thing.type == "MESH" and not progress.keeps_picture(thing):
                thing.panorama_role = roles.SYNTHETIC
        if warning:
            self.report({"WARNING"}, warning)
        x, y, z = self.location
        names = things[0].name if len(things) == 1 else f"{len(things)} objects"
        distance = np.hypot(x - place.origin.location.x, y - place.origin.location.y)
        carrier = f" on {self.carrier}" if getattr(self, "carrier", "") else ""
        return (
            f"{names}{carrier} at ({x:.2f}, {y:.2f}, {z:.2f}) m, {distance:.2f} m from the point of capture"
        )


def ray_under(context, event) -> tuple[Vector, Vector]:
    """Origin and direction in the world of the ray under the mouse, in a 3D View or on the flat panorama.

    Raises ValueError elsewhere.
    """
    area, region = context.area, context.region
    xy = event.mouse_x - region.x, event.mouse_y - region.y
    if area.type == "VIEW_3D" and region.type == "WINDOW":
        return (
            view3d_utils.region_2d_to_origin_3d(region, region.data, xy),
            view3d_utils.region_2d_to_vector_3d(region, region.data, xy),
        )
    canvas = canvas_of(context, area, region)
    uv = canvas.uv_at(xy) if canvas else None
    if uv is None:
        raise ValueError("point at a spot in the 3D View, or on the panorama in an Image Editor")
    matrix = place_of(context.scene).origin.matrix_world
    return matrix.translation.copy(), matrix.to_3x3() @ Vector(direction_from_uv(uv).tolist())


def sendable(place, objects) -> tuple[list, str]:
    """Those objects that may be moved, and a warning that names linked ones left where they are.

    Raises ValueError for what the place itself is made of, and where nothing is left.
    """
    for thing in objects:
        live = PIECE in thing and thing.type == "MESH" and not progress.keeps_picture(thing)
        if standing.belongs_to(place, thing) or live:
            raise ValueError(f"'{thing.name}' is part of the place: it stays where the photograph shows it")
    return editable(objects)


classes = (PANORAMA_OT_send_to_place,)
