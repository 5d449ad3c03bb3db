"""What the last solution answered, and how maps and pictures are to be made."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..cycles_integration.methods import CATCHER, METHODS

LIGHTS = (
    ("AUTO", "Automatic", "The bright lamps of the photograph become lights, where that lessens the noise"),
    ("NONE", "None", "The photograph lights as it shows; small lamps then leave noise"),
    ("LIMIT", "At Most", "Only so many lamps, the strongest, become lights"),
)


class PanoramaResult(bpy.types.PropertyGroup):
    """What the last calibration found; uncertainties are one σ for half a pixel of click error."""

    is_solved: BoolProperty()
    camera_height: FloatProperty()
    tilt_deg: FloatProperty()
    residual_deg: FloatProperty()
    uncertainty_tilt_deg: FloatProperty()
    uncertainty_scale_percent: FloatProperty()
    condition: FloatProperty()
    warnings: StringProperty()


class PanoramaJob(bpy.types.PropertyGroup):
    """How maps and pictures are to be made, and what the last preparation spent and found."""

    lights: EnumProperty(
        name="Lamps", description="How many lamps of the photograph become lights", items=LIGHTS
    )
    most_lights: IntProperty(
        name="Count",
        description="At most so many lights, the strongest first",
        min=1,
        soft_max=100,
        default=8,
    )
    method: EnumProperty(
        name="Method",
        description="How new objects are put into the photograph",
        items=METHODS,
        default=CATCHER,
    )
    samples: IntProperty(
        name="Samples",
        description="Paths per pixel: twice as many take twice the time and leave 0.7 of the noise",
        min=1,
        soft_max=4096,
        default=64,
    )
    seed: IntProperty(name="Seed", description="Another number gives other noise", min=0)
    denoise: BoolProperty(
        name="Denoise",
        description="Smooth the noise of new objects and shadows; fine texture on them suffers",
    )
    seconds: FloatProperty()
    coverage: FloatProperty()
    lights_at_depth: StringProperty()
    light_warnings: StringProperty()
    lights_at_infinity: StringProperty()
