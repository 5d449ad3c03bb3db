"""The panorama set as it lives in a scene: what the artist said, and what the last solution answered.

It mirrors the set file, so it is saved in the .blend, undoes, and goes to a file and back (conversion.py).
"""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..cycles_integration.roles import ENVIRONMENT, ROLES, SUPPORT
from ..ibl_toolkit.panorama_set import DEFAULT_ROUGHNESS
from . import solving
from .job_properties import PanoramaJob, PanoramaResult

RECTANGLE, PARALLELS, VERTICAL, LENGTH = "RECTANGLE", "PARALLELS", "VERTICAL", "LENGTH"
PICK_KINDS = (
    (RECTANGLE, "Rectangle", "Four corners, in order, of a real rectangle: a rug, a ceiling, a window"),
    (PARALLELS, "Floor Lines", "Lines on the floor that run along one axis of the world: boards, tiles"),
    (VERTICAL, "Vertical", "Two points of a line that stands upright: a room corner, a door frame"),
    (LENGTH, "Known Length", "Two floor points whose distance is known; gives the scale instead of a height"),
)
PLANES = (
    ("FLOOR", "Floor", "It lies on the floor; the first side of the first one is the world's +x"),
    ("CEILING", "Ceiling", "It lies level above the camera"),
    ("WALL", "Wall", "It stands: two of its sides are vertical"),
)
AXES = (("X", "X", "The lines run along the world's x"), ("Y", "Y", "The lines run along the world's y"))
SHAPE_KINDS = (
    ("polygon", "Polygon", "Any outline on the floor, three points or more"),
    ("rectangle", "Rectangle", "Two points are a whole side, the third tells how far the opposite side is"),
    ("square", "Square", "Two opposite corners"),
    ("circle", "Circle", "Three points of its edge or more"),
    ("walls", "Walls", "Walls, with or without a ceiling, over a flat shape"),
    (
        "box",
        "Box",
        "Its base as a rectangle, and a point of its upper edge above the first corner, or a height",
    ),
    ("cylinder", "Cylinder", "Its base as a circle, and a point of its upper edge, or a height"),
)
REAL_ROLES = tuple(role for role in ROLES if role[0] in (SUPPORT, ENVIRONMENT))


def _picks_changed(item, context):
    item.id_data.panorama_set.calibration_is_old = True


def _shapes_changed(item, context):
    item.id_data.panorama_set.shapes_are_old = True


def _point_changed(point, context):
    point.picked = True
    is_pick = point.path_from_id().startswith("panorama_set.picks")
    (_picks_changed if is_pick else _shapes_changed)(point, context)


def _camera_height_changed(state, context):
    solving.follow_camera_height(state.id_data)


class PanoramaPoint(bpy.types.PropertyGroup):
    """A point of the image."""

    uv: FloatVectorProperty(
        name="Point",
        description="Point of the image: share of its width from the left, of its height from the top",
        size=2,
        min=0,
        max=1,
        step=0.1,
        precision=5,
        update=_point_changed,
    )
    picked: BoolProperty(options={"HIDDEN"})


class PanoramaPick(bpy.types.PropertyGroup):
    """One thing in the image that tells about the orientation or the scale."""

    kind: EnumProperty(name="Kind", description="What the points are", items=PICK_KINDS)
    plane: EnumProperty(
        name="Plane", description="Where the rectangle lies", items=PLANES, update=_picks_changed
    )
    axis: EnumProperty(
        name="Axis", description="Axis of the world that the lines follow", items=AXES, update=_picks_changed
    )
    metres: FloatProperty(
        name="Length",
        description="Distance between the two points on the floor; scales the whole place",
        min=0,
        soft_max=10,
        precision=3,
        unit="LENGTH",
        update=_picks_changed,
    )
    points: CollectionProperty(type=PanoramaPoint, description="Its points in the image, in order")


class PanoramaShape(bpy.types.PropertyGroup):
    """One shape of the real place, and how its last reconstruction went."""

    name: StringProperty(name="Name", description="Name of the shape and its object", update=_shapes_changed)
    kind: EnumProperty(name="Kind", description="What the points mean", items=SHAPE_KINDS)
    points: CollectionProperty(type=PanoramaPoint, description="Its points on the floor, in order")
    of: StringProperty(
        name="Over", description="The flat shape over which the walls stand", update=_shapes_changed
    )
    has_height: BoolProperty(
        name="Height in Metres",
        description="Give the height as a number instead of picking a point of the upper edge",
        update=_shapes_changed,
    )
    top: PointerProperty(
        type=PanoramaPoint, description="Point of its upper edge, right above its first point"
    )
    height: FloatProperty(
        name="Height",
        description="Height above the floor",
        min=0,
        soft_max=10,
        precision=3,
        unit="LENGTH",
        update=_shapes_changed,
    )
    ceiling: BoolProperty(
        name="Ceiling", description="Close the room above the walls", update=_shapes_changed
    )
    role: EnumProperty(
        name="Role",
        description="What the shape is to the composite",
        items=REAL_ROLES,
        update=_shapes_changed,
    )
    reflectivity: FloatProperty(
        name="Reflectivity",
        description="Share of the light that the real surface mirrors; new objects then show in it",
        subtype="FACTOR",
        min=0,
        max=1,
        update=_shapes_changed,
    )
    roughness: FloatProperty(
        name="Roughness",
        description="Blur of the real surface's reflections: 0 is a mirror, 1 is matte",
        subtype="FACTOR",
        min=0,
        max=1,
        default=DEFAULT_ROUGHNESS,
        update=_shapes_changed,
    )
    is_built: BoolProperty(options={"HIDDEN"})
    size: FloatVectorProperty(description="Length, width and height as built", size=3, unit="LENGTH")
    residual: FloatProperty(
        description="Largest distance between its picks and the shape as built", unit="LENGTH"
    )
    warnings: StringProperty(description="What is doubtful about the shape, a sentence per line")


class PanoramaSetState(bpy.types.PropertyGroup):
    """The scene's panorama set."""

    image_path: StringProperty(
        name="Panorama", description="The HDR panorama, OpenEXR or Radiance .hdr", subtype="FILE_PATH"
    )
    image: PointerProperty(type=bpy.types.Image, description="The panorama as Blender loaded it")
    objects_path: StringProperty(
        name="Objects", description=".blend file whose first scene holds the new objects", subtype="FILE_PATH"
    )
    picks: CollectionProperty(type=PanoramaPick, description="What was clicked to calibrate")
    active_pick: IntProperty(
        name="Active Pick", description="Number of the pick selected in the list, from 0"
    )
    camera_height: FloatProperty(
        name="Camera Height",
        description="Height of the lens above the floor; scales the whole place. 0: not known",
        min=0,
        soft_max=3,
        step=1,
        precision=3,
        unit="LENGTH",
        update=_camera_height_changed,
    )
    shapes: CollectionProperty(type=PanoramaShape, description="What stands in the real place")
    active_shape: IntProperty(
        name="Active Shape", description="Number of the shape selected in the list, from 0"
    )
    result: PointerProperty(type=PanoramaResult, description="What the last calibration found")
    job: PointerProperty(type=PanoramaJob, description="How light and pictures are made")
    calibration_is_old: BoolProperty(description="Whether picks or image changed since the calibration")
    shapes_are_old: BoolProperty(description="Whether shapes changed since they were built")
    maps_are_old: BoolProperty(description="Whether the place changed since its light was prepared")
    problem: StringProperty(description="Why the last change of the camera height could not be followed")


classes = (PanoramaPoint, PanoramaPick, PanoramaShape, PanoramaResult, PanoramaJob, PanoramaSetState)


def register():
    """Give every scene its panorama set."""
    for cls in classes:
        bpy.utils.register_class(cls)
    bpy.types.Scene.panorama_set = PointerProperty(
        type=PanoramaSetState, description="What the artist said of this scene's panorama"
    )


def unregister():
    """Take it back."""
    del bpy.types.Scene.panorama_set
    for cls in reversed(classes):
        bpy.utils.unregister_class(cls)
