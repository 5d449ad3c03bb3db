"""The operator that adds the sun of a place and time."""

from datetime import datetime, timedelta, timezone

import bpy
import numpy as np

from ..cycles_integration.place import place_of
from ..cycles_integration.sun_by_time import SETTINGS, put_sun_by_time, sun_by_time
from ..ibl_toolkit.light.picked_lamp import strongest_lamps
from ..ibl_toolkit.mobile.sun_position import (
    METHODS,
    north_of,
    sun_position,
    warnings_of,
    world_direction,
)
from .probes import select_alone
from .reporting import Reporting
from .sun_picker import map_for_lamps

TIME = ("year", "month", "day", "hour", "minute")
NORTHS = (
    ("WORLD", "In the World", "An angle in the world says where north is"),
    ("PANORAMA", "By the Panorama", "The compass heading of the panorama's middle says where north is"),
    (
        "LAMP",
        "By the Panorama's Sun",
        "The panorama's strongest lamp is the sun at this time. The heading "
        "that follows is kept, for other times",
    ),
)
NORTH_FIELDS = {"WORLD": ("north",), "PANORAMA": ("heading",), "LAMP": ()}
SAME_SUN_DEG = 2.0
"""Where the panorama's sun and the computed one differ more in altitude, something is not as was said."""
FITS = {
    "psa2020": "Coefficients fitted to 2020 to 2050: within 30 arc seconds then",
    "psa2001": "Coefficients fitted to 1999 to 2015, as in the source: within 30 arc seconds then",
}


class PANORAMA_OT_add_sun_by_time(Reporting, bpy.types.Operator):
    """Add a sun light where the sun stood at a place and time, or turn the one added before. A new one has
    the sun's size; strength and colour are yours"""

    bl_idname = "panorama.add_sun_by_time"
    bl_label = "Add Sun by Time"

    latitude: bpy.props.FloatProperty(
        name="Latitude",
        description="Of the place, positive to the north [degrees]",
        soft_min=-90,
        soft_max=90,
        precision=4,
    )
    longitude: bpy.props.FloatProperty(
        name="Longitude",
        description="Of the place, positive to the east [degrees]",
        soft_min=-180,
        soft_max=180,
        precision=4,
    )
    year: bpy.props.IntProperty(
        name="Year", description="Year of the date [1 to 9999]", default=2026, min=1, max=9999
    )
    month: bpy.props.IntProperty(
        name="Month", description="Month of the date [1 to 12]", default=6, min=1, max=12
    )
    day: bpy.props.IntProperty(name="Day", description="Day of the date [1 to 31]", default=21, min=1, max=31)
    hour: bpy.props.IntProperty(
        name="Hour", description="Hour of the local time [0 to 23]", default=12, min=0, max=23
    )
    minute: bpy.props.IntProperty(
        name="Minute", description="Minute of the local time [0 to 59]", min=0, max=59
    )
    utc_offset: bpy.props.FloatProperty(
        name="UTC Offset",
        description="How far the local clock was ahead of UTC, with daylight saving time: 2 in Berlin in "
        "summer, -3 in Rio [hours]",
        min=-12,
        max=14,
        step=50,
        precision=2,
    )
    north_from: bpy.props.EnumProperty(name="North", description="What says where north is", items=NORTHS)
    north: bpy.props.FloatProperty(
        name="Angle of North",
        description="Direction of north in the world, counter-clockwise from +Y seen from above: at 0 north "
        "is +Y, at 90 it is -X [degrees]",
        soft_min=-180,
        soft_max=180,
    )
    heading: bpy.props.FloatProperty(
        name="Heading",
        description="Where the middle of the panorama's image looks, clockwise from north: 90 is east. Needs "
        "a calibration, and follows it when this is done again [degrees]",
        soft_min=0,
        soft_max=360,
    )
    method: bpy.props.EnumProperty(
        name="Method",
        description="Algorithm of the sun's position",
        items=[(name, f"{name[:3].upper()} {name[3:]}", FITS[name]) for name in METHODS],
    )

    def invoke(self, context, event):
        """Ask, beginning with what the scene's sun by time was made with, or with the time now."""
        sun = sun_by_time(context.scene)
        if sun is not None:
            for name in self.as_keywords().keys() & sun[SETTINGS].keys():
                setattr(self, name, sun[SETTINGS][name])
        elif not any(self.properties.is_property_set(name) for name in TIME):
            now = datetime.now().astimezone()
            for name in TIME:
                setattr(self, name, getattr(now, name))
            self.utc_offset = now.utcoffset().total_seconds() / 3600
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        """Place, time, north."""
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        for names in (
            ("latitude", "longitude"),
            ("year", "month", "day"),
            ("hour", "minute", "utc_offset"),
            ("north_from", *NORTH_FIELDS[self.north_from]),
            ("method",),
        ):
            column = layout.column(align=True)
            for name in names:
                column.prop(self, name)

    def work(self, context):
        """Compute where it stood, and put it there."""
        time = self.time()
        position = sun_position(time, self.latitude, self.longitude, self.method)
        if self.north_from == "LAMP":
            self.find_heading(context.scene, position)
        north_deg = self.north_in_world(context.scene)
        direction = world_direction(position.azimuth_deg, position.altitude_deg, north_deg)
        sun, is_new = put_sun_by_time(context.scene, direction, self.as_keywords())
        select_alone(context, sun)
        for warning in warnings_of(time, position):
            self.report({"WARNING"}, warning[0].upper() + warning[1:])
        heading = f", {self.heading:.2f}° the panorama's middle" if self.north_from == "PANORAMA" else ""
        return (
            f"{sun.name}: altitude {position.altitude_deg:.2f}°, azimuth {position.azimuth_deg:.2f}° "
            f"clockwise from north{heading}{'' if is_new else ' (turned)'}"
        )

    def time(self):
        """The time of the fields, with its zone. Raises ValueError for a day that the month has not."""
        parts = [getattr(self, name) for name in TIME]
        try:
            return datetime(*parts, tzinfo=timezone(timedelta(hours=self.utc_offset)))
        except ValueError as error:
            raise ValueError(f"{self.year}-{self.month:02}-{self.day:02}: there is no such day") from error

    def find_heading(self, scene, position):
        """Set the heading with which the panorama's strongest lamp has the sun's azimuth.

        Says so where they are not equally high. Raises ValueError without a place, or without a lamp.
        """
        place = place_of(scene)
        world_from_panorama = _orientation(place)
        lamp = world_from_panorama @ strongest_lamps(map_for_lamps(place))[0].direction
        north_deg = north_of(lamp, position.azimuth_deg)
        self.north_from, self.heading = "PANORAMA", (north_deg - north_of(world_from_panorama[:, 0], 0)) % 360
        altitude_deg = float(np.degrees(np.arcsin(np.clip(lamp[2], -1, 1))))
        if abs(altitude_deg - position.altitude_deg) > SAME_SUN_DEG:
            self.report(
                {"WARNING"},
                f"The panorama's strongest lamp stands at an altitude of {altitude_deg:.1f}°, the sun at "
                f"{position.altitude_deg:.1f}°: check place, time, and whether this lamp is the sun",
            )

    def north_in_world(self, scene):
        """Counter-clockwise from +Y [degrees]. Raises ValueError for a heading without a place."""
        if self.north_from == "WORLD":
            return self.north
        return north_of(_orientation(place_of(scene))[:, 0], self.heading)


def _orientation(place):
    """world_from_panorama (3, 3), as the place's origin is turned."""
    return np.array(place.origin.matrix_world.to_quaternion().to_matrix())


classes = (PANORAMA_OT_add_sun_by_time,)
