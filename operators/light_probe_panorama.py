"""The operator that unwraps the photograph of a mirror ball into the scene's panorama."""

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..cycles_integration.pieces import update_pieces
from ..cycles_integration.place import create_place
from ..ibl_toolkit.mobile.probe import natural_width, unwrap, write_unwrapped
from .light_probe_photo import OfProbePhoto, draw_groups, sentences
from .set_files import open_image, take_calibrated

LEAST_WIDTH = 16
"""Of the panorama [px]."""


@dataclass(frozen=True, eq=False)
class _Calibration:
    world_from_panorama: np.ndarray
    camera_height: float


class PANORAMA_OT_panorama_of_ball(OfProbePhoto, bpy.types.Operator):
    """Unwrap the photograph of a mirror ball into a panorama, written beside the photograph as
    NAME_panorama.exr, and open it. With a marker it is calibrated too: picks, shapes and surfaces go"""

    bl_idname = "panorama.panorama_of_ball"
    bl_label = "Panorama from Mirror Ball"
    wants_size = True

    width: bpy.props.IntProperty(
        name="Width",
        description="Width of the panorama [pixels]; 0: as fine as the photograph. Its height is half of it",
        min=0,
        soft_max=4096,
        step=2,
    )
    surroundings: bpy.props.FloatProperty(
        name="Room",
        description="How far the walls are from the ball, for the right perspective of what is near; 0: far "
        "away. Needs the ball's diameter, so a marker",
        min=0,
        soft_max=20,
        unit="LENGTH",
    )

    def draw(self, context):
        """The ball and its photograph, and the panorama."""
        self.draw_photo(self.layout)
        draw_groups(self.layout, self, [("width", "surroundings") if self.has_marker else ("width",)])

    def work(self, context):
        """Unwrap, write, open; with a marker, calibrate."""
        probe = self.read_probe(context.scene)
        height = None if probe.pose is None else _height(probe)
        width = (self.width or natural_width(probe.camera, probe.placed.ball)) // 2 * 2
        turn = None if probe.pose is None else probe.pose.marker_from_camera
        far = self.surroundings if probe.pose is not None and self.surroundings else np.inf
        found = unwrap(probe.photo, probe.camera, probe.placed.ball, max(width, LEAST_WIDTH), turn, far)
        path = panorama_path(bpy.path.abspath(self.filepath))
        write_unwrapped(found, path)
        line = open_image(context, path)
        context.scene.panorama_set.image.reload()  # the same file may be open with what it held before
        if height is not None:
            _calibrate(context.scene, path, height)
        self.report_all(sentences(probe.warnings))
        return f"{line}, black where the ball hides the room: {1 - found.known.mean():.1%}"


def panorama_path(photo) -> Path:
    """Where the panorama of a photograph is written."""
    return Path(photo).with_name(f"{Path(photo).stem}_panorama.exr")


def _height(probe):
    """Of the ball's centre over the marker's plane [m]. Raises ValueError where it is below."""
    pose, ball = probe.pose, probe.placed.ball
    height = float((pose.marker_from_camera @ (ball.centre - pose.origin))[2])
    if height <= 0:
        raise ValueError(
            f"the ball's middle comes out {-height:.3g} m below the marker: check diameter and marker size"
        )
    return height


def _calibrate(scene, path, height):
    """The marker's frame is the world's, moved below the ball; what was built of another place goes."""
    place = create_place(scene, str(path), _Calibration(np.eye(3), height))
    update_pieces(place, [])
    take_calibrated(scene, place, path, height)


classes = (PANORAMA_OT_panorama_of_ball,)
