"""The light of layers is the scene's, whatever its render settings, and its edges are clean."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import small_scenes as small  # noqa: E402
from boxed_scene import (  # noqa: E402
    DIRECTIONS,
    EMISSION,
    LEVEL,
    METRES,
    ORIGIN,
    RADIUS,
    SIDE,
    TINY,
    WALL,
    WIDTH,
    add_box,
    box_depth,
    crossings,
    surfaces,
)
from mathutils import Matrix, Vector  # noqa: E402

from expanded_panoramas.cycles_integration.layer_capture import capture_surfaces  # noqa: E402
from expanded_panoramas.cycles_integration.layer_render import LayerCapture  # noqa: E402


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"use_persistent_data": True},
        {"film_exposure": 4.0},
        {"film_exposure": 0.25},
        {"sample_clamp_direct": 0.1, "sample_clamp_indirect": 0.1},
    ],
)
def test_settings_of_the_artist_s_renders_leave_geometry_and_light_as_they_are(fresh_blend, settings):
    scene = fresh_blend.context.scene
    scene.render.engine = "CYCLES"
    glow = small.material(EMISSION, Color=(0.05, 0.05, 0.05, 1))
    add_box(scene, np.array([[-4.0] * 3, [4.0] * 3]), glow, inward=True)
    small.add_ball(scene, glow, 0.8, Vector(ORIGIN) + Vector((2, 0, 0)))
    for name, value in settings.items():
        setattr(scene.render if hasattr(scene.render, name) else scene.cycles, name, value)
    options = LayerCapture(WIDTH, samples=1, most=3)
    layers = {layer.name: layer for layer in capture_surfaces(scene, LEVEL, 0.5, options).layers}
    assert {name: np.count_nonzero(layer.mask) for name, layer in layers.items()} == {
        "surface 1": WIDTH * WIDTH // 2,
        "back of surface 1": 8,
        "surface 2": 52,
    }
    wall = crossings(np.array([[-4.0] * 3, [4.0] * 3]), 0, DIRECTIONS)[1]
    behind = layers["surface 2"]
    np.testing.assert_allclose(behind.depth[behind.mask], wall[behind.mask], atol=METRES)
    for layer in layers.values():
        np.testing.assert_allclose(layer.radiance[layer.mask], 0.05, rtol=1e-3)


def test_a_hidden_surface_lies_in_the_shadow_of_what_hides_it(fresh_blend):
    scene = fresh_blend.context.scene
    small.add_plane(scene, small.material(small.DIFFUSE), 20)
    small.add_ball(scene, small.material(small.DIFFUSE), 0.5, (2, 0, 0.6))
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size = 100, 0
    lamp.location = (0, 0, 1.5)  # where the panorama is: all it cannot see is dark
    scene.collection.objects.link(lamp)
    first, second = surfaces(scene, Matrix.Translation((0, 0, 1.5)), 0.5, TINY)
    hidden = second.mask & np.isfinite(second.depth)
    assert hidden.sum() > 12
    assert first.radiance[-8:].min() > 0.1  # the floor below
    assert second.radiance[hidden].max() < 1e-3


def test_colours_of_edges_are_not_mixed(furnished_room):
    fine = LayerCapture(WIDTH, samples=9)
    for layer in capture_surfaces(furnished_room, LEVEL, RADIUS, fine).layers:
        is_box = np.isclose(layer.depth, box_depth(DIRECTIONS), atol=METRES) | ("back" in layer.name)
        for pixels, colour in ((layer.mask & is_box, SIDE), (layer.mask & ~is_box, WALL)):
            np.testing.assert_allclose(
                layer.radiance[pixels], np.broadcast_to(colour, (pixels.sum(), 3)), rtol=1e-3
            )
