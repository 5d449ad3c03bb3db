"""The colour that Blender fills a 3D view with behind its objects."""

from __future__ import annotations

from mathutils import Color

PLAIN_MODES = ("WIREFRAME", "SOLID")


def background_of(space, scene, themes, *, is_clipped: bool = False) -> tuple[float, float, float]:
    """The colour behind all objects of a 3D view, linear; of several, as a gradient's, the larger components.

    A view with a clipping border (``is_clipped``) has another colour within the border.
    Source: Blender's overlay engine, whose choice this repeats.
    """
    colours = [_plain_background(space, scene, themes)]
    if is_clipped:
        colours.append(_linear(themes[0].view_3d.clipping_border_3d[:3]))
    return _largest(colours)


def _plain_background(space, scene, themes):
    shading = space.shading
    if shading.type in PLAIN_MODES and shading.background_type == "WORLD" and scene.world:
        return tuple(scene.world.color)
    if shading.type in PLAIN_MODES and shading.background_type == "VIEWPORT":
        return tuple(shading.background_color)
    gradients = themes[0].view_3d.space.gradients
    colours = [gradients.high_gradient]
    if gradients.background_type != "SINGLE_COLOR":
        colours.append(gradients.gradient)
    return _largest(_linear(colour) for colour in colours)


def _linear(colour):
    return tuple(Color(colour).from_srgb_to_scene_linear())


def _largest(colours):
    return tuple(max(components) for components in zip(*colours, strict=True))
