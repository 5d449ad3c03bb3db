"""The operator that makes sun lights of one photograph of a probe ball."""

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..cycles_integration.probe_lights import TOLD, ProbeSun, collection_of, put_probe_lights, suns_in
from ..ibl_toolkit.mobile.probe import MOST, estimate_lights
from ..ibl_toolkit.mobile.sun_position import DIAMETER_DEG
from .light_probe_photo import BLENDER_FROM_PHOTO, OfProbePhoto, draw_groups, sentences
from .probes import select_alone

KINDS = (
    ("mirror", "Mirror Ball", "A shiny ball, such as a Christmas bauble: tells direction, size and colour"),
    ("diffuse", "Matte Ball", "A ball without gloss, such as painted polystyrene: its shading tells lights"),
)


class PANORAMA_OT_lights_of_probe(OfProbePhoto, bpy.types.Operator):
    """Make sun lights of one photograph of a mirror or matte ball: direction, colour and relative strength of
    the place's strongest lights. Those made before are replaced"""

    bl_idname = "panorama.lights_of_probe"
    bl_label = "Lights from Probe Photo"

    kind: bpy.props.EnumProperty(
        name="Looks", description="What kind of ball is in the photograph", items=KINDS
    )
    count: bpy.props.IntProperty(
        name="Lights",
        description="Number of lights at most, the strongest first; each costs a device a shadow map",
        default=3,
        min=1,
        max=MOST,
    )
    strength: bpy.props.FloatProperty(
        name="Strength",
        description="Of the strongest sun; the others follow in proportion. The photograph does not tell it "
        "[W/m²]",
        default=1,
        min=0,
        soft_max=10,
    )

    def draw(self, context):
        """The ball and its photograph, and what is wanted of it."""
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        draw_groups(layout, self, [("kind",)])
        self.draw_photo(layout)
        draw_groups(layout, self, [("count", "strength")])

    def work(self, context):
        """Find the lights, then put them into the scene."""
        scene = context.scene
        if not self.has_marker and scene.camera is None:
            raise ValueError(
                "without a marker the photograph counts as the scene camera's: add a camera and aim it as "
                "the photograph was taken, or use a marker"
            )
        probe = self.read_probe(scene)
        found = estimate_lights(
            probe.photo, probe.camera, probe.placed.ball, self.kind, self.count, pose=probe.pose
        )
        warnings = sentences([*probe.warnings, *found.warnings])
        frame_from_photo, world_from_frame = _frames(scene, probe.pose)
        suns = _suns(found.lights, frame_from_photo, self.strength)
        told = {"photo": bpy.path.basename(self.filepath), "warnings": "\n".join(warnings)}
        lights = put_probe_lights(scene, suns, world_from_frame, told)
        select_alone(context, lights[0])
        self.report_all(warnings)
        count = len(lights)
        in_frame = "in the marker's frame" if probe.pose else f"as {scene.camera.name} sees them"
        uncertain = found.lights[0].uncertainty_deg
        return f"{count} light{'s' if count > 1 else ''} {in_frame}, the strongest ± {uncertain:.1f}°"


@dataclass(frozen=True)
class Told:
    """What the last photograph told a scene. lights: (name, altitude [°], strength [W/m²]) of each."""

    photo: str
    lights: list[tuple[str, float, float]]
    warnings: list[str]


def told_by_photo(scene) -> Told | None:
    """What the scene's probe lights are, and what was doubtful about them; None where there are none."""
    collection = collection_of(scene)
    if collection is None:
        return None
    lights = [(sun.name, _altitude_deg(sun), sun.data.energy) for sun in suns_in(collection)]
    return Told(collection[TOLD]["photo"], lights, collection[TOLD]["warnings"].splitlines())


def _altitude_deg(sun):
    up = sun.matrix_world.col[2]  # it shines along its −z
    return math.degrees(math.asin(max(-1, min(1, up.z / up.to_3d().length))))


def _frames(scene, pose):
    """frame_from_photo (3, 3), and world_from_frame (4, 4): of the marker's frame, or the scene camera's."""
    if pose is not None:
        return pose.marker_from_camera, Matrix.Identity(4)
    place, turn, _ = scene.camera.matrix_world.decompose()
    return np.array(BLENDER_FROM_PHOTO), Matrix.LocRotScale(place, turn, None)


def _suns(lights, frame_from_photo, strength):
    scale = strength / max(float(lights[0].irradiance.max()), 1e-30)
    return [
        ProbeSun(
            frame_from_photo @ light.direction,
            light.irradiance * scale,
            DIAMETER_DEG if np.isnan(light.diameter_deg) else min(light.diameter_deg, 180.0),
        )
        for light in lights
    ]


classes = (PANORAMA_OT_lights_of_probe,)
