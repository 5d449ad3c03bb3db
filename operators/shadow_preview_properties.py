"""What a scene's shadow preview is made with; saved in the .blend."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..cycles_integration.shadow_preview import MOST_LIGHTS
from ..ibl_toolkit.mobile.shadow_maps.settings import LARGEST, SMALLEST, STRONGEST
from . import shadow_watch
from .shadow_watch import settings_changed

METHODS = (
    ("hard", "Hard", "One comparison: aliased edges, the classic set-up of cards without shaders. Cheapest"),
    (
        "pcf",
        "PCF",
        "Percentage-closer filtering: the mean of (window + 1)² comparisons. Soft, costly if wide",
    ),
    ("vsm", "VSM", "Variance shadow map: blurred once, soft at the cost of one look-up; light may bleed in"),
    (
        "evsm",
        "EVSM",
        "Exponential variance shadow map: as VSM, with little light bleeding in the same memory",
    ),
)
STORAGES = (
    ("float32", "32 Bit Floats", "4 bytes a number: desktops, newer phones"),
    ("8+8", "8 + 8 Bits", "1 byte a number: depths in 256 steps"),
    (
        "16+16",
        "16 + 16 Bits, Packed",
        "2 bytes a number, packed into RGBA8 and unpacked before it is filtered",
    ),
)


def _is_light(owner, thing):
    return thing.type == "LIGHT"


def _is_another(preview, thing):
    return thing.type == "LIGHT" and thing not in [row.light for row in preview.lights]


def _row_changed(row, context):
    shadow_watch.light_changed(row.id_data.panorama_shadow_preview, context)


def _added(preview, context):
    """The field is a way into the list, and empty again."""
    light = preview.another
    if light is None:
        return
    if _is_another(preview, light) and len(preview.lights) < MOST_LIGHTS:
        preview.lights.add().light = light
    preview.another = None


def _window_changed(preview, context):
    if preview.window % 2 == 0:
        preview.window += 1  # comes back here
    else:
        settings_changed(preview, context)


class PanoramaShadowLight(bpy.types.PropertyGroup):
    """One of the lights of a preview."""

    light: PointerProperty(
        type=bpy.types.Object,
        name="Light",
        description="Light whose shadow is shown. A sun shines in parallel, every other one from its middle; "
        "sizes are left out, as devices do",
        poll=_is_light,
        update=_row_changed,
    )


class PanoramaShadowSwitchedOff(bpy.types.PropertyGroup):
    """A light whose own shadow a preview has switched off."""

    light: PointerProperty(type=bpy.types.Light, description="The light's data")


class PanoramaShadowPreview(bpy.types.PropertyGroup):
    """How a small device would draw the shadows of some lights, shown by a node group in materials."""

    lights: CollectionProperty(
        type=PanoramaShadowLight,
        description="Lights whose shadows are shown. Of several, surfaces lose the share of those that do "
        "not reach them",
    )
    another: PointerProperty(
        type=bpy.types.Object,
        name="Add",
        description="Choose a light to add it to the list, which holds 4 at most. Surfaces lose the share "
        "of those that do not reach them: strengths, distances and slants count",
        poll=_is_another,
        update=_added,
    )
    method: EnumProperty(
        name="Method",
        description="How the map is tested: aliasing, softness, light bleeding and cost come from it",
        items=METHODS,
        default="evsm",
        update=settings_changed,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Width and height of the map: twice as many show finer edges and take four times the "
        "memory [texels]",
        default=1024,
        min=SMALLEST,
        soft_min=64,
        soft_max=2048,
        max=LARGEST,
        update=settings_changed,
    )
    storage: EnumProperty(
        name="Storage",
        description="How a texel holds its numbers: fewer bits take less memory and show steps of depth",
        items=STORAGES,
        default="16+16",
        update=settings_changed,
    )
    window: IntProperty(
        name="Window",
        description="Width of the filter, odd: the wider, the softer the edges. PCF can have 9 at most, 5 "
        "with two lights, 3 with more [texels]",
        default=3,
        min=1,
        soft_max=15,
        max=63,
        step=2,
        update=_window_changed,
    )
    offset_by_itself: BoolProperty(
        name="Settings by Themselves",
        description="Take what was measured as best: the least offset that keeps the method and window free "
        "of acne, and the bleeding reduction and exponent of method and storage",
        default=True,
        update=settings_changed,
    )
    offset_factor: FloatProperty(
        name="Slope Offset",
        description="Moves surfaces away from the light by this times their slope in the map, as "
        "glPolygonOffset does; the classic set-up has 1.9. Too little: acne; too much: shadows come off "
        "their objects [depth per texel]",
        default=1.9,
        soft_min=0,
        soft_max=10,
        min=-100,
        max=100,
        update=settings_changed,
    )
    offset_units: FloatProperty(
        name="Constant Offset",
        description="Moves all surfaces away from the light by so many steps of the storage; the classic "
        "set-up has 4. Too little: acne; too much: shadows come off their objects [steps of depth]",
        default=4.0,
        soft_min=0,
        soft_max=100,
        min=-1e7,
        max=1e7,
        update=settings_changed,
    )
    bleeding_reduction: FloatProperty(
        name="Bleeding Reduction",
        description="Light below this share counts as none: takes away light that bleeds into shadows and "
        "narrows their edges. VSM and EVSM [0 to 0.95]",
        default=0.15,
        min=0,
        max=0.95,
        update=settings_changed,
    )
    exponent: FloatProperty(
        name="Exponent",
        description="How strongly EVSM sets depths apart: more lets less light bleed, but shows the steps "
        "of few bits; 20 suits 8 bits [no unit]",
        default=40.0,
        min=0.1,
        max=STRONGEST,
        update=settings_changed,
    )
    darkness: FloatProperty(
        name="Darkness",
        description="Share of the surface's light that full shadow takes away: 1 is black [0 to 1]",
        subtype="FACTOR",
        default=1.0,
        min=0,
        max=1,
        update=shadow_watch.looks_changed,
    )
    replaces_own: BoolProperty(
        name="Instead of Its Own",
        description="Switch the lights' own shadows off while the preview is there, so none is seen twice",
        default=True,
        update=shadow_watch.looks_changed,
    )
    keep_current: BoolProperty(
        name="Keep Current",
        description="Make the maps anew when lights, objects or settings change, and at each frame. Takes a "
        "tenth of a second to some seconds for each light, by resolution",
        default=True,
        update=settings_changed,
    )
    switched_off: CollectionProperty(
        type=PanoramaShadowSwitchedOff,
        description="The lights whose own shadow this preview has switched off",
    )
    group: PointerProperty(type=bpy.types.NodeTree, description="The node group that tests the maps")
    composite_group: PointerProperty(
        type=bpy.types.NodeTree, description="The group that tests them on pictures"
    )
    problem: StringProperty(description="What the maps cannot show, or why they could not be made")


GROUPS = (PanoramaShadowLight, PanoramaShadowSwitchedOff, PanoramaShadowPreview)


def register():
    """Give every scene its preview."""
    for cls in GROUPS:
        bpy.utils.register_class(cls)
    bpy.types.Scene.panorama_shadow_preview = PointerProperty(
        type=PanoramaShadowPreview, description="Shadows of the scene as a small device has them"
    )
    shadow_watch.register()


def unregister():
    """Take them back."""
    shadow_watch.unregister()
    del bpy.types.Scene.panorama_shadow_preview
    for cls in reversed(GROUPS):
        bpy.utils.unregister_class(cls)
