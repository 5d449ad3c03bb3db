"""Puts the panorama behind everything that Blender has drawn in a 3D view, between its two layers.

Blender draws a 3D view in two layers: the scene, scene-linear, and over it the overlays, whose theme colour
fills what the scene leaves empty. The panorama belongs into the scene's layer: there it gets the display
transform that objects get, and wires, outlines, grid and text stay over it. Blender hands that layer to draw
callbacks before it clears it, so the callback before the scene only remembers it, and the one after paints.
"""

from __future__ import annotations

from contextlib import contextmanager

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Color, Matrix

from ...ibl_toolkit.views import View
from ...operators.canvas import calibration_of
from ...operators.tools import active_tool
from . import far_floor, shader, theme

SHOWN_IN = ("WIREFRAME", "SOLID", "MATERIAL")
"""Shading modes; in the rendered one the World shows the panorama."""
EMPTY, FILLED, ANYWHERE = "LESS_EQUAL", "GREATER", "NONE"
"""Depth tests of something at the far plane: where nothing is before it, where something is, no test."""
ROUNDING = 0.005
"""Beyond the rounding to 8 bits, and the noise, that Blender's overlays add to the theme's colour."""
_scene_layer = None
_textured = set()  # session uids of the images that were drawn: Blender made textures of them


def remember_scene_layer():
    """Before the scene: its framebuffer is the one in use."""
    global _scene_layer
    _scene_layer = gpu.state.active_framebuffer_get()


def paint():
    """After the scene, over its overlays: put the panorama behind."""
    layer = forget_scene_layer()
    context = bpy.context
    image = image_of(context.scene)
    if layer is None or image is None or not is_shown(context.scene, context.space_data):
        return
    view = view_of(context.scene, context.region, context.region_data)
    if view.runs_along_floor:  # the theme's colour is better then
        return
    texture = gpu.texture.from_image(image)
    _textured.add(image.session_uid)
    gain = 2.0**context.scene.panorama_view.exposure
    fill = _fill_of(context)
    shown = passes(context.space_data.shading, context.scene.panorama_view.opacity, covers_meshes(view))
    with _state_given_back():
        for where, blend, share in shown:
            for world, clip in _surfaces(where, context):
                gpu.state.depth_test_set(where)
                gpu.state.blend_set(blend)
                with layer.bind():
                    shader.draw(view, texture, gain, share, clip)
                _take_away(fill, share, world)


def forget_scene_layer() -> gpu.types.GPUFrameBuffer | None:
    """What was remembered, once."""
    global _scene_layer
    layer, _scene_layer = _scene_layer, None
    return layer


def free_textures():
    """Take the textures of the panoramas drawn off the graphics card. Blender frees its own by a time-out."""
    if _textured:
        for image in bpy.data.images:
            if image.session_uid in _textured:
                image.gl_free()
    _textured.clear()


def image_of(scene) -> bpy.types.Image | None:
    """The scene's panorama, if it has one that could be read."""
    image = scene.panorama_set.image or scene.panorama_place.image
    return image if image is not None and all(image.size) else None


def is_shown(scene, space) -> bool:
    """Whether a 3D view is to show the panorama behind its objects."""
    return scene.panorama_view.show_background and space.shading.type in SHOWN_IN


def view_of(scene, region, region_data) -> View:
    """The View of a 3D view's region."""
    matrices = region_data.window_matrix, region_data.view_matrix
    return View.from_matrices(*matrices, *calibration_of(scene), (region.width, region.height))


def covers_meshes(view) -> bool:
    """Whether a tool needs the picture more than the meshes that stand where it shows what they are."""
    return active_tool() is not None and view.has_floor_in_place


def passes(shading, opacity: float, covers=False) -> list[tuple[str, str, float]]:
    """How often the panorama is drawn: where, with which blending, and with which share of it.

    Wires have nothing behind them but the theme's colour, with which the panorama is mixed. Behind what X-ray
    makes translucent lies the share of it that one surface lets pass. It may also cover what is filled.
    """
    if shading.type == "WIREFRAME":
        return [(ANYWHERE, "NONE", opacity)]
    behind = [(EMPTY, "NONE", 1.0)]
    if covers:
        return [*behind, (FILLED, "NONE", 1.0)]
    if shading.type == "SOLID" and shading.show_xray and shading.xray_alpha < 1:
        behind.append((FILLED, "ADDITIVE_PREMULT", 1.0 - shading.xray_alpha))
    return behind


def _surfaces(where, context):
    """Triangles to draw on: in the world (3 n, 3) [m], None at the far plane; in clip space (3 n, 4)."""
    yield None, shader.COVER
    region_data = context.region_data
    if where == EMPTY and far_floor.is_hidden_by_grid(context.space_data, region_data):
        pixel = 2 / (region_data.window_matrix[1][1] * context.region.height)
        world = far_floor.corners(region_data.view_matrix.inverted().translation, pixel)
        yield world, np.insert(world, 3, 1, axis=1) @ np.array(region_data.perspective_matrix).T


def _fill_of(context):
    """The theme's colour (4,) in the overlays; within a clipping border it hides the scene, by its alpha."""
    themes, is_clipped = context.preferences.themes, context.region_data.use_clip_planes
    colour = theme.background_of(context.space_data, context.scene, themes, is_clipped=is_clipped)
    return *colour, float(is_clipped)


def _take_away(fill, share, world):
    """Subtract a share of the theme's colour (4,) from the overlays, which are the framebuffer in use."""
    plain = gpu.shader.from_builtin("UNIFORM_COLOR")
    gpu.state.blend_set("SUBTRACT")
    excess = Color([share * (component + ROUNDING) for component in fill[:3]])
    plain.uniform_float("color", (*excess.from_scene_linear_to_srgb(), share * fill[3]))
    with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        if world is None:
            gpu.matrix.load_identity()
            gpu.matrix.load_projection_matrix(Matrix.Identity(4))
            world = shader.COVER[:, :3]
        batch_for_shader(plain, "TRIS", {"pos": np.ascontiguousarray(world, np.float32)}).draw(plain)


@contextmanager
def _state_given_back():
    blend, test = gpu.state.blend_get(), gpu.state.depth_test_get()
    written = gpu.state.depth_mask_get()
    gpu.state.depth_mask_set(False)
    gpu.state.clip_distances_set(0)  # left by a view with a clipping border; callbacks begin without
    try:
        yield
    finally:
        gpu.state.blend_set(blend)
        gpu.state.depth_test_set(test)
        gpu.state.depth_mask_set(written)
