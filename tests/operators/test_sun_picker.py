"""A lamp of the panorama as a sun of the artist's own, through the calibration."""

import numpy as np
import panoramas
import pytest
from mathutils import Vector

from expanded_panoramas.ibl_toolkit import equirectangular

WIDTH, HEIGHT = 256, 128
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""panorama_from_world: the camera stood a quarter turn off."""
SUN_UV, LAMP_UV = (0.7, 0.2), (0.2, 0.6)


def lamp(image, uv, radius_deg, colour):
    middle = equirectangular.direction_from_uv(uv)
    image[equirectangular.pixel_directions(WIDTH, HEIGHT) @ middle > np.cos(np.radians(radius_deg))] = colour


@pytest.fixture
def place(fresh_blend, tmp_path):
    """A turned room under a map with a sun of 3° and a dimmer lamp of 5°."""
    image = np.full((HEIGHT, WIDTH, 3), 0.002, np.float32)
    lamp(image, SUN_UV, 3, (100, 80, 50))
    lamp(image, LAMP_UV, 5, (10, 10, 10))
    path = panoramas.write_panorama(tmp_path / "map.exr", image)
    scene, here = panoramas.room_place(fresh_blend, path, panorama_from_world=TURN)
    scene.panorama_set.image, scene.panorama_set.image_path = here.image, str(path)
    scene.panorama_set.result.is_solved = True
    fresh_blend.context.view_layer.update()
    return here


def suns(bpy):
    return [thing for thing in bpy.context.scene.objects if thing.type == "LIGHT"]


def towards(thing, bpy):
    bpy.context.view_layer.update()
    return thing.matrix_world.to_3x3() @ Vector((0, 0, 1))


def test_the_strongest_lamp(fresh_blend, place):
    bpy = fresh_blend
    assert bpy.ops.panorama.add_sun() == {"FINISHED"}
    (sun,) = suns(bpy)
    wanted = TURN.T @ equirectangular.direction_from_uv(SUN_UV)
    assert np.degrees(np.arccos(np.dot(towards(sun, bpy), wanted))) < 0.3
    assert np.degrees(sun.data.angle) == pytest.approx(6, rel=0.1)
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(3)))
    assert np.array(sun.data.color) * sun.data.energy == pytest.approx(
        np.array([100, 80, 50]) * solid_angle, rel=0.1
    )
    origin = place.origin.matrix_world.translation
    along = (sun.matrix_world.translation - origin).normalized()
    assert along.dot(towards(sun, bpy)) == pytest.approx(1)
    assert sun.name not in place.suns.objects
    assert bpy.context.active_object == sun


def test_the_lamp_under_the_cursor_is_added_once(fresh_blend, place):
    bpy = fresh_blend
    bpy.ops.panorama.add_sun()
    bpy.ops.panorama.pick_sun(uv=LAMP_UV)
    assert len(suns(bpy)) == 2
    picked = bpy.context.active_object
    wanted = TURN.T @ equirectangular.direction_from_uv(LAMP_UV)
    assert np.degrees(np.arccos(np.dot(towards(picked, bpy), wanted))) < 0.3
    bpy.ops.panorama.pick_sun(uv=np.add(LAMP_UV, 0.005))
    bpy.ops.panorama.add_sun()
    assert len(suns(bpy)) == 2


def test_several_lamps_as_suns(fresh_blend, place):
    """Two stand out of the map; each becomes one sun, whose strengths are as their light is."""
    bpy = fresh_blend
    bpy.ops.panorama.add_sun(count=5)
    assert len(suns(bpy)) == 2
    for uv, radiance, radius in ((SUN_UV, 100, 3), (LAMP_UV, 10, 5)):
        wanted = TURN.T @ equirectangular.direction_from_uv(uv)
        (sun,) = [sun for sun in suns(bpy) if np.dot(towards(sun, bpy), wanted) > np.cos(np.radians(0.3))]
        solid_angle = 2 * np.pi * (1 - np.cos(np.radians(radius)))
        assert sun.data.energy == pytest.approx(radiance * solid_angle, rel=0.1)
    assert bpy.context.active_object.data.energy == max(sun.data.energy for sun in suns(bpy))
    bpy.ops.panorama.add_sun(count=5)
    assert len(suns(bpy)) == 2


def test_it_follows_another_calibration_when_asked_again(fresh_blend, place):
    bpy = fresh_blend
    bpy.ops.panorama.add_sun()
    place.origin.rotation_euler.z += 1.0
    bpy.context.view_layer.update()
    before = towards(suns(bpy)[0], bpy).copy()
    bpy.ops.panorama.add_sun()
    (sun,) = suns(bpy)
    turned = np.degrees(before.xy.angle_signed(towards(sun, bpy).xy))
    assert abs(turned) == pytest.approx(np.degrees(1.0), abs=0.1)


def test_where_there_is_no_lamp(fresh_blend, place):
    bpy = fresh_blend
    with pytest.raises(RuntimeError, match=r"no lamp at u 0.500, v 0.500: the nearest is at"):
        bpy.ops.panorama.pick_sun(uv=(0.5, 0.5))
    assert not suns(bpy)


def test_it_reports_angles_with_the_uncertainty_of_the_tilt(fresh_blend, place):
    """Its row of the map says the elevation, (½ − 0.2)·180° = 54°; the quarter turn leaves it."""
    from types import SimpleNamespace

    from expanded_panoramas.ibl_toolkit.light.picked_lamp import strongest_lamps
    from expanded_panoramas.operators import sun_picker

    fresh_blend.context.scene.panorama_set.result.uncertainty_tilt_deg = 0.25
    reports = []
    line = sun_picker._SunOfLamp.put(
        SimpleNamespace(report=lambda *report: reports.append(report)), fresh_blend.context, strongest_lamps
    )
    assert "elevation 54" in line or "elevation 53.9" in line
    assert "± 0.25°" in line
    azimuth = float(line.split("azimuth ")[1].split("°")[0])
    wanted = TURN.T @ equirectangular.direction_from_uv(SUN_UV)
    assert azimuth == pytest.approx(np.degrees(np.arctan2(wanted[1], wanted[0])) % 360, abs=0.3)
    assert "clipped" in reports[0][1]  # one radiance all over: it may be
