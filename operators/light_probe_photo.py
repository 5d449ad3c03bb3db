"""What the operators on one photograph of a probe ball share: which camera, marker and ball it shows."""

import math
from dataclasses import dataclass

import bpy
from bpy_extras.io_utils import ImportHelper
from mathutils import Matrix

from ..ibl_toolkit.mobile.probe import (
    DICTIONARY,
    MarkerPose,
    Photo,
    PhotoCamera,
    PlacedBall,
    dictionary_names,
    find_marker,
    place_ball,
    read_photo,
)
from .reporting import Reporting

LENSES = (
    ("FOCAL", "Focal Length", "The photograph's focal length in 35 mm terms, as its EXIF data tell it"),
    ("FOV", "Field of View", "The angle that the width of the photograph covers"),
    ("CAMERA", "Scene Camera", "Lens, sensor and shift of the scene's active camera"),
)
LENS_FIELDS = {"FOCAL": ("focal",), "FOV": ("fov",), "CAMERA": ()}
PLACES = (
    ("OUTLINE", "By Its Outline", "The largest round outline in the photograph is taken for the ball"),
    ("MARKER", "Beside the Marker", "The ball lies where you measured it, beside the marker: more accurate"),
)
PICTURES = "*.exr;*.hdr;*.png;*.jpg;*.jpeg;*.tif;*.tiff"
BLENDER_FROM_PHOTO = Matrix(((1, 0, 0), (0, -1, 0), (0, 0, -1)))
"""From the frame of a photograph's camera (x right, y down, z forward) to that of a camera in Blender."""


@dataclass(frozen=True)
class Probe:
    """A photograph, its camera, the marker in it or None, and the ball."""

    photo: Photo
    camera: PhotoCamera
    pose: MarkerPose | None
    placed: PlacedBall

    @property
    def warnings(self) -> list[str]:
        """What is doubtful about marker and ball."""
        return [*(self.pose.warnings if self.pose else ()), *self.placed.warnings]


class OfProbePhoto(Reporting, ImportHelper):
    """An operator on the photograph of a probe ball.

    wants_size: whether the ball's diameter counts, even where its outline is looked for.
    """

    wants_size = False

    filter_glob: bpy.props.StringProperty(default=PICTURES, options={"HIDDEN"})
    lens: bpy.props.EnumProperty(
        name="Camera", description="What says how wide the photograph looks", items=LENSES
    )
    focal: bpy.props.FloatProperty(
        name="Focal Length",
        description="Of the photograph in 35 mm terms, by its diagonal: a phone's main camera has about 26. "
        "A wrong one turns lights [mm]",
        default=26,
        min=1,
        soft_min=8,
        soft_max=300,
    )
    fov: bpy.props.FloatProperty(
        name="Field of View",
        description="Angle that the photograph's width covers; a wrong one turns lights",
        subtype="ANGLE",
        default=math.radians(60),
        min=math.radians(0.5),
        max=math.radians(175),
    )
    has_marker: bpy.props.BoolProperty(
        name="Marker",
        description="An ArUco marker lies flat on the floor or a table: its middle is the world's origin, "
        "its right side +X, its upper side +Y, and up is +Z. Without one, the photograph is taken to be made "
        "by the scene's active camera",
    )
    marker_size: bpy.props.FloatProperty(
        name="Marker Size",
        description="Side of the marker's black square",
        default=0.1,
        min=0.001,
        soft_max=1,
        unit="LENGTH",
        precision=4,
    )
    dictionary: bpy.props.EnumProperty(
        name="Dictionary",
        description="Kind of marker, as it was chosen when it was printed",
        items=[(n, n.replace("_", " "), f"OpenCV's dictionary DICT_{n}") for n in dictionary_names()],
        default=DICTIONARY,
    )
    marker_id: bpy.props.IntProperty(
        name="Marker Number",
        description="Which of several markers is meant: the number that it encodes; -1 for the only one",
        default=-1,
        min=-1,
        soft_max=49,
    )
    ball_diameter: bpy.props.FloatProperty(
        name="Ball Diameter",
        description="Width of the ball; with it and the marker, the ball's place is known",
        default=0.1,
        min=0.001,
        soft_max=1,
        unit="LENGTH",
        precision=4,
    )
    ball_from: bpy.props.EnumProperty(
        name="Ball", description="What says where the ball is in the photograph", items=PLACES
    )
    ball_place: bpy.props.FloatVectorProperty(
        name="Place",
        description="Of the ball's middle from the marker's, to the right and up as the marker is read",
        size=2,
        default=(0.12, 0),
        subtype="TRANSLATION",
        unit="LENGTH",
        precision=4,
    )
    ball_above: bpy.props.FloatProperty(
        name="Above",
        description="How high the ball's lowest point is over the marker's plane; 0 where it lies on it",
        unit="LENGTH",
        precision=4,
    )

    def draw_photo(self, layout):
        """Camera, marker and ball: what counts for what is chosen."""
        layout.use_property_split, layout.use_property_decorate = True, False
        groups = [("lens", *LENS_FIELDS[self.lens]), ("has_marker",)]
        if self.has_marker:
            is_placed = self.ball_from == "MARKER"
            of_place = ("ball_place", "ball_above") if is_placed else ()
            of_size = ("ball_diameter",) if is_placed or self.wants_size else ()
            groups += [("marker_size", "dictionary", "marker_id"), ("ball_from", *of_size, *of_place)]
        draw_groups(layout, self, groups)

    def read_probe(self, scene) -> Probe:
        """Read the photograph and find marker and ball in it.

        Raises ValueError or OSError for what is no photograph, or shows no marker or no ball.
        """
        photo = read_photo(bpy.path.abspath(self.filepath))
        camera = self._camera(scene, *photo.size)
        if not self.has_marker:
            return Probe(photo, camera, None, place_ball(photo, camera))
        number = None if self.marker_id < 0 else self.marker_id
        pose = find_marker(photo, camera, self.marker_size, number, self.dictionary)
        radius = self.ball_diameter / 2
        centre = (*self.ball_place, self.ball_above + radius) if self.ball_from == "MARKER" else None
        return Probe(photo, camera, pose, place_ball(photo, camera, pose=pose, radius=radius, centre=centre))

    def report_all(self, warnings):
        """Report each."""
        for warning in warnings:
            self.report({"WARNING"}, warning)

    def _camera(self, scene, width, height):
        if self.lens == "FOV":
            return PhotoCamera.from_fov(math.degrees(self.fov), width, height)
        if self.lens == "FOCAL":
            return PhotoCamera.from_35mm(self.focal, width, height)
        return camera_of_scene(scene, width, height)


def camera_of_scene(scene, width, height) -> PhotoCamera:
    """The scene's camera with a picture of so many pixels.

    Raises ValueError where there is none of perspective.
    """
    data = scene.camera.data if scene.camera is not None and scene.camera.type == "CAMERA" else None
    if data is None or data.type != "PERSP":
        raise ValueError("the scene's camera: there is none of perspective, so give the focal length instead")
    fit = data.sensor_fit
    if fit == "AUTO":
        film, side = data.sensor_width, max(width, height)
    else:
        film, side = (data.sensor_width, width) if fit == "HORIZONTAL" else (data.sensor_height, height)
    middle = width / 2 - data.shift_x * side, height / 2 + data.shift_y * side
    return PhotoCamera.from_focal(data.lens / film * side, width, height, middle)


def sentences(texts) -> list[str]:
    """Texts that begin with a capital letter."""
    return [text[0].upper() + text[1:] for text in texts]


def draw_groups(layout, owner, groups):
    """Draw properties in groups of aligned rows."""
    for names in groups:
        column = layout.column(align=True)
        for name in names:
            column.prop(owner, name)
