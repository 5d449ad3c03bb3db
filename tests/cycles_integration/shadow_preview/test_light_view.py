"""Maps of Blender lights: where they look from, and what they hold."""

import bpy
import numpy as np
import pytest
import shadow_pictures
from mathutils import Vector

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import suggested_settings


def made(light, method):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    (one,) = shadow_preview.shadow_maps_of([light], depsgraph, suggested_settings(3.0, 64, method=method))
    return one


def test_a_sun_shines_along_its_axis_and_a_lamp_from_its_place(fresh_blend):
    shadow_pictures.still_life()
    sun, lamp = (shadow_pictures.add_light(kind) for kind in ("SUN", "AREA"))
    lamp.scale = (2, 3, 4)
    bpy.context.view_layer.update()
    along = made(sun, "hard").camera.axes[2]
    np.testing.assert_allclose(-along, Vector(shadow_pictures.SUN).normalized(), atol=1e-6)
    assert made(lamp, "hard").camera.perspective
    np.testing.assert_allclose(made(lamp, "hard").camera.eye, shadow_pictures.LAMP, atol=1e-6)


@pytest.mark.parametrize("kind", ["SUN", "POINT"])
def test_maps_of_moments_hold_real_floors(fresh_blend, kind):
    """And reach to them, which those of depths have no need to do, nor read what is broken there."""
    shadow_pictures.still_life()
    light, floor = shadow_pictures.add_light(kind), bpy.data.objects["plane"]
    floor.panorama_role, floor.location.z = "SUPPORT", -0.2
    bpy.context.view_layer.update()
    hard, soft = (made(light, method) for method in ("hard", "vsm"))
    assert soft.camera.far > 1.05 * hard.camera.far
    filled = [(one.texels[..., 0] < 255).mean() for one in (hard, soft)]  # the high byte of the depth
    assert filled[1] > 1.5 * filled[0]
    floor.data.vertices[0].co.x = float("nan")
    floor.data.update()
    bpy.context.view_layer.update()
    np.testing.assert_array_equal(made(light, "hard").texels, hard.texels)
    with pytest.raises(ValueError, match="'plane' has vertices whose places are not finite"):
        made(light, "vsm")
