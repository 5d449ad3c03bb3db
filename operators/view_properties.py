"""How a scene's 3D views show its panorama; saved in the .blend, beside the set."""

import bpy
from bpy.props import BoolProperty, FloatProperty, PointerProperty

from . import canvas


def _shown_otherwise(view, context):
    canvas.redraw(context)


class PanoramaView(bpy.types.PropertyGroup):
    """What the 3D views draw of the panorama, in solid, material preview and wireframe mode."""

    show_background: BoolProperty(
        name="Panorama Background",
        description="Show the panorama behind the scene in 3D views; renders are not affected",
        default=True,
        update=_shown_otherwise,
    )
    exposure: FloatProperty(
        name="Exposure",
        description="Brightness of the shown panorama [EV]: +1 doubles it. Renders stay as they are",
        default=0,
        soft_min=-8,
        soft_max=8,
        step=10,
        precision=2,
        update=_shown_otherwise,
    )
    opacity: FloatProperty(
        name="Opacity",
        description="Share of the panorama in the mix of wireframe mode: 0 hides it, 1 shows it in full",
        subtype="FACTOR",
        default=0.5,
        min=0,
        max=1,
        update=_shown_otherwise,
    )
    show_calibration: BoolProperty(
        name="Calibration",
        description="Draw horizon, vertical planes and picks over the panorama",
        default=True,
        update=_shown_otherwise,
    )


def register():
    """Give every scene its view settings."""
    bpy.utils.register_class(PanoramaView)
    bpy.types.Scene.panorama_view = PointerProperty(
        type=PanoramaView, description="How 3D views show this scene's panorama"
    )


def unregister():
    """Take them back."""
    del bpy.types.Scene.panorama_view
    bpy.utils.unregister_class(PanoramaView)
