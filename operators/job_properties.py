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

    is_solved: BoolProperty(description="Whether the scene has a calibration")
    camera_height: FloatProperty(
        description="Height of the lens above the floor by the last calibration", unit="LENGTH"
    )
    tilt_deg: FloatProperty(description="Angle between the image's vertical and the world's [degrees]")
    residual_deg: FloatProperty(
        description="Mean angle by which the picks had to be corrected [degrees]: small where they agree"
    )
    uncertainty_tilt_deg: FloatProperty(description="Standard deviation of the tilt [degrees]")
    uncertainty_scale_percent: FloatProperty(description="Standard deviation of all lengths [%]")
    condition: FloatProperty(
        description="Ratio of the uncertainties of the tilt's two directions: 1 is best [ratio]"
    )
    warnings: StringProperty(description="What is doubtful about the calibration, a sentence per line")


class PanoramaJob(bpy.types.PropertyGroup):
    """How maps and pictures are to be made, and what the last preparation spent and found."""

    lights: EnumProperty(
        name="Lamps", description="How many lamps of the photograph become lights", items=LIGHTS
    )
    most_lights: IntProperty(
        name="Count",
        description="Number of lamps that become lights, at most; the strongest come first",
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
    seed: IntProperty(
        name="Seed", description="Number that the noise depends on: another one gives other noise", min=0
    )
    denoise: BoolProperty(
        name="Denoise",
        description="Smooth the noise of new objects and shadows; fine texture on them suffers",
    )
    seconds: FloatProperty(description="Time that the last preparation took [seconds]")
    coverage: FloatProperty(description="Share of the sphere around the panorama that has depth, 0 to 1")
    lights_at_depth: StringProperty(description="How many lamps became lights on the surfaces, and why")
    light_warnings: StringProperty(description="What is suspicious in the light, a sentence per line")
    lights_at_infinity: StringProperty(description="How many lamps became suns, and why")
