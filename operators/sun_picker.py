"""Operators that make lamps of the panorama sun lights of the artist's own."""

import bpy
import numpy as np

from ..cycles_integration import blender_images, maps
from ..cycles_integration.picked_sun import put_sun
from ..cycles_integration.place import place_of
from ..ibl_toolkit.light.clipping import find_clipping
from ..ibl_toolkit.light.picked_lamp import lamp_at, strongest_lamps
from . import progress
from .canvas import canvas_of
from .probes import select_alone
from .reporting import Reporting, possible

WIDTH = 2048
"""Lamps are looked for on a map of at most this width [px]."""


def map_for_lamps(place):
    """The place's panorama (H, W, 3) in the size in which lamps are looked for."""
    return np.maximum(maps.shrink(blender_images.array_from_image(place.image), WIDTH), 0)


class _SunOfLamp(Reporting):
    """An operator that puts a sun where a lamp of the calibrated panorama is."""

    @classmethod
    def poll(cls, context):
        """The calibration says where the lamp is."""
        return possible(cls, progress.calibration_missing(context.scene))

    def put(self, context, lamps_of):
        """Put suns of the lamps that ``lamps_of`` finds on the map, the strongest first -> what to report."""
        place = place_of(context.scene)
        image = map_for_lamps(place)
        lamps = lamps_of(image)
        suns = [put_sun(context.scene, place, lamp) for lamp in lamps]
        select_alone(context, suns[0].light)
        clipping = find_clipping(image)
        if clipping.is_clipped and any(clipping.mask.ravel()[lamp.pixels].any() for lamp in lamps):
            self.report({"WARNING"}, "The capture may have clipped this lamp: it was brighter then (step 5)")
        sigma = context.scene.panorama_set.result.uncertainty_tilt_deg
        known_to = f" ± {sigma:.2f}°" if sigma else ""  # a file with depth does not tell
        line = _described(suns[0], lamps[0], known_to)
        return line if len(suns) == 1 else f"{len(suns)} suns, the strongest: {line}"


def _described(sun, lamp, known_to):
    return (
        f"{sun.light.name}: elevation {sun.elevation_deg:.1f}°{known_to}, azimuth "
        f"{sun.azimuth_deg:.1f}° from +x towards +y, {np.degrees(2 * lamp.radius):.2g}° across, strength "
        f"{sun.light.data.energy:.3g}{'' if sun.is_new else ' (brought up to date)'}"
    )


class PANORAMA_OT_add_sun(_SunOfLamp, bpy.types.Operator):
    """Add a sun light with direction, size, colour and strength of the panorama's strongest lamp, or of
    several, or bring those added before up to date. They shine beside the panorama's own light"""

    bl_idname = "panorama.add_sun"
    bl_label = "Add Sun of the Panorama"

    count: bpy.props.IntProperty(
        name="Lamps",
        description="Number of lamps, the strongest first, that become suns; fewer where fewer stand out",
        default=1,
        min=1,
        soft_max=8,
    )

    def work(self, context):
        """Find the lamps that give the most light."""
        return self.put(context, lambda image: strongest_lamps(image, self.count))


class PANORAMA_OT_pick_sun(_SunOfLamp, bpy.types.Operator):
    """Click a bright lamp of the panorama, in the 3D View or an Image Editor: adds a sun light with its
    direction, size, colour and strength, or brings the one picked before up to date"""

    bl_idname = "panorama.pick_sun"
    bl_label = "Pick Sun"
    bl_options = {"REGISTER", "UNDO", "DEPENDS_ON_CURSOR"}
    bl_cursor_pending = "EYEDROPPER"

    uv: bpy.props.FloatVectorProperty(
        name="Point",
        description="Point of the lamp: share of the image's width from the left, of its height from the top",
        size=2,
        min=0,
        max=1,
        precision=4,
    )

    def invoke(self, context, event):
        """Take the point under the mouse."""
        area, region = context.area, context.region
        canvas = canvas_of(context, area, region)
        uv = canvas.uv_at((event.mouse_x - region.x, event.mouse_y - region.y)) if canvas else None
        if uv is None:
            self.report({"ERROR"}, "Point at a lamp in the 3D View, or on the panorama in an Image Editor")
            return {"CANCELLED"}
        self.uv = uv
        return self.execute(context)

    def work(self, context):
        """Find the lamp there."""
        return self.put(context, lambda image: (lamp_at(image, np.array(self.uv)),))


classes = (PANORAMA_OT_add_sun, PANORAMA_OT_pick_sun)
