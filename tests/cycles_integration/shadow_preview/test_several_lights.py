"""What nodes leave of several lights together, against numpy's `remaining_light`; how strong lights are."""

import bpy
import numpy as np
import pytest
import shadow_pictures
import small_scenes

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.cycles_integration.shadow_preview import COMPOSITOR, group
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import ShadowSettings, remaining_light

WIDTH, MAP, TIES, EQUAL = 64, 96, 4, 1 / 255
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@pytest.fixture
def lights(fresh_blend):
    """An orange sun and, from another side, a blue lamp of a like strength, over a still life."""
    shadow_pictures.still_life()
    sun, lamp = shadow_pictures.add_light("SUN"), shadow_pictures.add_light("POINT")
    sun.data.color, sun.data.energy = (1, 0.6, 0.2), 2.0
    lamp.data.color, lamp.data.energy, lamp.location = (0.3, 0.5, 1), 300.0, (1.1, -1.3, 2.0)
    bpy.context.view_layer.update()
    return sun, lamp


def remaining(shown, points, normals, weights=None):
    """What numpy says, of strengths per channel or, with weights, of their weighted sums; 0 of the world."""
    strengths = np.array([one.strength for one in shown])
    if weights is not None:
        strengths = np.repeat(strengths @ weights[:, None], 3, axis=1)
    points, normals = points.astype(np.float64), normals.astype(np.float64)
    left = remaining_light([one.made for one in shown], strengths, points, normals)
    return left * (np.linalg.norm(normals, axis=1) > 0.5)[:, None]


@pytest.mark.parametrize("method", ["hard", "evsm"])
def test_a_sun_and_a_lamp_leave_what_numpy_says(lights, method):
    (material,) = bpy.data.materials
    shown = [shadow_pictures.shown(light, ShadowSettings(method, MAP)) for light in lights]
    made = shadow_preview.build_group(shown, None, "Shadow Map Preview")
    shadow_pictures.show(material, made, "Shaded")
    left, points, normals = shadow_pictures.rendered(WIDTH, channels="RGB")
    off = np.abs(left - remaining(shown, points, normals)).max(axis=1)
    assert np.sort(off)[-1 - TIES] <= EQUAL
    for channel in (0, 2):  # one of two lights is hidden: its share is gone, most of it in its own colour
        partly = (left[:, channel] > 0.1) & (left[:, channel] < 0.9)
        assert 0.01 < partly.mean() < 0.5
    assert (left[:, 0] - left[:, 2]).min() < -0.4 < 0.4 < (left[:, 0] - left[:, 2]).max()
    shadow_pictures.show(material, made)
    grey, *_ = shadow_pictures.rendered(WIDTH)
    off = np.abs(grey - remaining(shown, points, normals, LUMINANCE)[:, 0])
    assert np.sort(off)[-1 - TIES] <= EQUAL


def test_four_lights_fit_into_the_stack_of_cycles(lights):
    """A shader that does not is black; PCF's widest window takes most of it."""
    settings = ShadowSettings("pcf", 64, "16+16", window=3)
    four = [*lights, shadow_pictures.add_light("SPOT"), shadow_pictures.add_light("AREA")]
    shown = [shadow_pictures.shown(light, settings) for light in four]
    made = shadow_preview.build_group(shown, None, "Shadow Map Preview")
    shadow_pictures.show(bpy.data.materials[0], made, "Shaded")
    left, points, normals = shadow_pictures.rendered(WIDTH, channels="RGB")
    assert np.sort(np.abs(left - remaining(shown, points, normals)).max(axis=1))[-1 - TIES] <= EQUAL
    wide = [shadow_pictures.shown(light, ShadowSettings("pcf", 64, window=7)) for light in lights]
    with pytest.raises(ValueError, match="window 7 of PCF must not exceed 5 texels in nodes for 2 lights"):
        shadow_preview.build_group(wide, None, "Shadow Map Preview")


def test_what_no_light_reaches_stays(lights):
    """As `remaining_light` has it: there is no light that a shadow could take."""
    lights[0].rotation_euler = (3.0, 0.2, 0)
    lights[1].location = (0.1, 0.2, -3.0)
    bpy.context.view_layer.update()
    shown = [shadow_pictures.shown(light, ShadowSettings("hard", MAP)) for light in lights]
    shadow_pictures.show(bpy.data.materials[0], shadow_preview.build_group(shown, None, "Shadow Map Preview"))
    left, points, normals = shadow_pictures.rendered(WIDTH)
    off = np.abs(left - remaining(shown, points, normals, LUMINANCE)[:, 0])
    assert np.sort(off)[-1 - TIES] <= EQUAL
    assert (left == 1).mean() > 0.5


def test_strengths_that_changed_need_no_new_nodes(lights):
    settings = ShadowSettings("hard", MAP)
    shown = [shadow_pictures.shown(light, settings) for light in lights]
    made = shadow_preview.build_group(shown, None, "Shadow Map Preview")
    lights[0].data.energy = 0
    bpy.context.view_layer.update()
    shown = [
        shadow_pictures.shown(light, settings, one.image) for light, one in zip(lights, shown, strict=True)
    ]
    assert shadow_preview.fits(made, shown)
    assert not shadow_preview.fits(made, shown[:1])
    assert not shadow_preview.fits(made, shown[::-1])
    shadow_preview.aim_group(made, shown)
    shadow_pictures.show(bpy.data.materials[0], made)
    left, points, normals = shadow_pictures.rendered(WIDTH)
    off = np.abs(left - remaining(shown, points, normals, LUMINANCE)[:, 0])
    assert np.sort(off)[-1 - TIES] <= EQUAL


@pytest.mark.parametrize("kind", [group.SHADER, COMPOSITOR])
def test_groups_of_other_versions_are_built_anew(lights, kind):
    """Whatever their key and their sockets are; what materials link stays linked."""
    one = shadow_pictures.shown(lights[0], ShadowSettings("hard", MAP))
    made = shadow_preview.build_group([one], None, "Shadow Map Preview", kind)
    assert shadow_preview.fits(made, [one])
    sockets = [(item.name, item.in_out, item.socket_type) for item in made.interface.items_tree]
    for key in (7, "ShadowSettings(method='hard')", None):
        made[group.KEY] = key if key is not None else {}
        assert not shadow_preview.fits(made, [one])
    for name, side in (("Visibility", "OUTPUT"), ("Darkness", "INPUT")):
        made.interface.remove(next(item for item in made.interface.items_tree if item.name == name))
        made.interface.new_socket(f"Old {name}", in_out=side, socket_type="NodeSocketFloat")
    assert shadow_preview.build_group([one], made, "", kind) == made
    assert shadow_preview.fits(made, [one])
    now = [(item.name, item.in_out, item.socket_type) for item in made.interface.items_tree]
    assert sorted(now) == sorted(sockets)
    for node in list(made.nodes):
        if node.type == "GROUP":
            node.node_tree = None
    assert not shadow_preview.fits(made, [one])


@pytest.mark.parametrize(
    ("kind", "looks"),
    [
        ("SUN", {"energy": 3.0}),
        ("SUN", {"energy": 300.0, "angle": 0.1, "normalize": False}),
        ("POINT", {"energy": 80.0, "exposure": 1.0, "use_temperature": True, "temperature": 3000.0}),
        ("SPOT", {"energy": 500.0, "shadow_soft_size": 0.2, "normalize": False}),
        ("AREA", {"energy": 30.0, "size": 0.2}),
        ("AREA", {"energy": 900.0, "shape": "ELLIPSE", "size": 0.2, "size_y": 0.1, "normalize": False}),
    ],
)
def test_strengths_are_those_of_cycles(fresh_blend, kind, looks):
    """A white surface straight below the light: its radiance times π is its irradiance."""
    scene = bpy.context.scene
    small_scenes.add_plane(scene, small_scenes.material(small_scenes.DIFFUSE), 1.0)
    small_scenes.add_camera(scene, (0, -0.5, 2), (0, 0, 0), width=0.02)
    light = shadow_pictures.add_light(kind)
    light.location, light.rotation_euler, light.scale = (0, 0, 3), (0, 0, 0), (1.5, 1, 1)
    for name, value in looks.items():
        setattr(light.data, name, value)
    bpy.context.view_layer.update()
    found, *_ = shadow_pictures.rendered(4, channels="RGB", samples=64)
    distance = 1.0 if kind == "SUN" else 3.0
    expected = shadow_preview.strength_of(light, bpy.context.evaluated_depsgraph_get()) / distance**2
    np.testing.assert_allclose(np.pi * found.mean(axis=0), expected, rtol=0.01)


def test_the_strongest_come_first(fresh_blend):
    """By what arrives where the things are: a lamp near them counts more than one far off."""
    shadow_pictures.still_life()
    sun, near, far, none = (shadow_pictures.add_light(kind) for kind in ("SUN", "POINT", "POINT", "POINT"))
    sun.data.energy, near.data.energy, far.data.energy, none.data.energy = 1.0, 100.0, 300.0, -9.0
    near.location, far.location = (0, 0, 2), (0, 0, 9)
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert shadow_preview.strongest_first([none, far, sun, near], depsgraph) == [near, sun, far, none]
