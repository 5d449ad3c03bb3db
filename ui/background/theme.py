"""The colour that Blender fills a 3D view with behind its objects."""

from __future__ import annotations

from mathutils import Color

PLAIN_MODES = ("WIREFRAME", "SOLID")


def background_of(space, scene, themes) -> tuple[float, float, float]:
    """The colour behind all objects of a 3D view, linear; of a gradient the larger of each component.

    Source: Blender's overlay engine, whose choice this repeats.
    """
    shading = space.shading
    if shading.type in PLAIN_MODES and shading.background_type == "WORLD" and scene.world:
        return tuple(scene.world.color)
    if shading.type in PLAIN_MODES and shading.background_type == "VIEWPORT":
        return tuple(shading.background_color)
    gradients = themes[0].view_3d.space.gradients
    colours = [gradients.high_gradient]
    if gradients.background_type != "SINGLE_COLOR":
        colours.append(gradients.gradient)
    return tuple(max(c) for c in zip(*(Color(c).from_srgb_to_scene_linear() for c in colours), strict=True))
