"""The preview's nodes against the numpy reference: the same picture, pixel by pixel, within 1/255."""

import bpy
import numpy as np
import pytest
import shadow_pictures

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import METHODS, STORAGES, ShadowSettings

WIDTH, MAP = 96, 128
EQUAL = 1 / 255
TIES = 4
"""Pixels at most, of WIDTH², in which a 32-bit and a 64-bit float may fall on different sides of a step."""


@pytest.fixture
def still_life(fresh_blend):
    return shadow_pictures.still_life()


def pixels(material, light, settings):
    """Of a map and the nodes that show it: their differences (WIDTH²,), the picture, places and normals."""
    made, group = shadow_pictures.preview(light, settings)
    shadow_pictures.show(material, group)
    shown, points, normals = shadow_pictures.rendered(WIDTH)
    return shadow_pictures.differences(made, shown, points, normals), shown, points, normals


@pytest.mark.parametrize("kind", ["SUN", "SPOT"])
@pytest.mark.parametrize("method", METHODS)
def test_nodes_show_what_numpy_computes(still_life, kind, method):
    light = shadow_pictures.add_light(kind)
    for storage in STORAGES:
        off, shown, *_ = pixels(still_life, light, ShadowSettings(method, MAP, storage))
        assert np.sort(off)[-1 - TIES] <= EQUAL, storage
        assert 0.03 < (shown < 0.5).mean() < 0.3


def test_windows_and_reductions_are_those_of_the_settings(still_life):
    light = shadow_pictures.add_light("AREA")
    for settings in (
        ShadowSettings("pcf", 64, "16+16", window=9),  # fills Cycles' stack
        ShadowSettings("vsm", 100, "16+16", window=9, bleeding_reduction=0.6),
        ShadowSettings("evsm", 64, "8+8", window=1, exponent=12.0, bleeding_reduction=0.0),
    ):
        off, *_ = pixels(still_life, light, settings)
        assert np.sort(off)[-1 - TIES] <= EQUAL, settings


def test_without_an_offset_lit_places_shadow_themselves(still_life):
    """Acne, as the classic set-up has it; as numpy has it too, up to ties of what lies on its own depth."""
    light = shadow_pictures.add_light("SUN")
    settings = ShadowSettings("hard", MAP, "float32", offset_factor=0, offset_units=0)
    off, shown, points, _ = pixels(still_life, light, settings)
    lit = (points[:, 2] < 1e-3) & (points[:, 0] < -0.75)  # floor before the box, towards the sun
    assert 0.25 < 1 - shown[lit].mean() < 0.75
    assert (off > EQUAL).mean() < 0.01


def test_too_large_an_offset_loosens_the_shadow_from_the_object(still_life):
    light = shadow_pictures.add_light("SUN")
    _, shown, *_ = pixels(still_life, light, ShadowSettings("hard", MAP, "16+16"))
    off, far, *_ = pixels(still_life, light, ShadowSettings("hard", MAP, "16+16", offset_units=16000))
    assert np.sort(off)[-1 - TIES] <= EQUAL
    assert (far < 0.5).sum() < 0.9 * (shown < 0.5).sum()


@pytest.mark.skipif(bpy.app.version < (5,), reason="without a display 4.5 compiles a minute (equal by hand)")
def test_eevee_shows_the_same(still_life):
    """Places are taken from Cycles: EEVEE's pass of them is off by up to a millimetre."""
    light = shadow_pictures.add_light("POINT")
    made, group = shadow_pictures.preview(light, ShadowSettings("vsm", MAP, "16+16"))
    shadow_pictures.show(still_life, group)
    _, points, normals = shadow_pictures.rendered(48)
    shown, *_ = shadow_pictures.rendered(48, "BLENDER_EEVEE")
    off = shadow_pictures.differences(made, shown, points, normals)
    assert np.sort(off)[-1 - TIES] <= EQUAL


def test_a_light_that_moved_needs_no_new_nodes(still_life):
    light, settings = shadow_pictures.add_light("SUN"), ShadowSettings("vsm", MAP)
    before = shadow_pictures.shown(light, settings)
    group = shadow_preview.build_group([before], None, "Shadow Map Preview")
    names = [node.name for node in group.nodes]
    light.rotation_euler.x += 0.3
    bpy.context.view_layer.update()
    moved = shadow_pictures.shown(light, settings, before.image)
    assert moved.image == before.image
    assert shadow_preview.fits(group, [moved])
    shadow_preview.aim_group(group, [moved])
    assert [node.name for node in group.nodes] == names
    shadow_pictures.show(still_life, group)
    off = shadow_pictures.differences(moved.made, *shadow_pictures.rendered(WIDTH))
    assert np.sort(off)[-1 - TIES] <= EQUAL


def test_a_window_too_wide_for_nodes_is_refused(still_life):
    light = shadow_pictures.add_light("SUN")
    with pytest.raises(ValueError, match="window 11 of PCF must not exceed 9"):
        shadow_pictures.preview(light, ShadowSettings("pcf", MAP, window=11))
