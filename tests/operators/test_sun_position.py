"""The sun of a place and time as a light: where it shines from, how north turns it, and what is refused."""

import numpy as np
import panoramas
import pytest
from mathutils import Matrix, Vector

from expanded_panoramas.ibl_toolkit import equirectangular

GOLDEN = {"latitude": 39.742476, "longitude": -105.1786}
MOMENT = {"year": 2003, "month": 10, "day": 17, "hour": 12, "minute": 30, "utc_offset": -7}
AZIMUTH_DEG, ALTITUDE_DEG = 194.34024, 90 - 50.11162 - 0.0163
"""By NREL, for 30 s later (an eighth of a degree), without refraction."""
NEAR_DEG = 0.15


def add(bpy, **change):
    return bpy.ops.panorama.add_sun_by_time(**{**GOLDEN, **MOMENT, **change})


def suns(bpy):
    return [thing for thing in bpy.context.scene.objects if thing.type == "LIGHT"]


def shines_from(bpy):
    bpy.context.view_layer.update()
    (sun,) = suns(bpy)
    return np.array(sun.matrix_world.to_3x3() @ Vector((0, 0, 1)))


def wanted(turn_deg=0.0):
    """The direction to the sun, its azimuth less what north is turned counter-clockwise from +y."""
    azimuth, altitude = np.radians([AZIMUTH_DEG - turn_deg, ALTITUDE_DEG])
    level = np.cos(altitude)
    return level * np.sin(azimuth), level * np.cos(azimuth), np.sin(altitude)


def off_deg(one, other):
    return np.degrees(np.arccos(np.clip(np.dot(one, other), -1, 1)))


def test_it_shines_from_where_the_sun_stood(fresh_blend):
    bpy = fresh_blend
    assert add(bpy) == {"FINISHED"}
    assert off_deg(shines_from(bpy), wanted()) < NEAR_DEG
    (sun,) = suns(bpy)
    assert np.degrees(sun.data.angle) == pytest.approx(0.533)
    assert bpy.context.active_object == sun


def test_north_turns_it(fresh_blend):
    """With north at −x and so west at −y, the sun, a little west of south, stands at +x and a little −y."""
    bpy = fresh_blend
    add(bpy, north=90)
    assert off_deg(shines_from(bpy), wanted(90)) < NEAR_DEG
    x, y, _ = shines_from(bpy)
    assert x > 0.7
    assert -0.3 < y < -0.1


@pytest.mark.parametrize("turn_deg", [0, 50])
def test_the_heading_of_the_panorama_follows_the_calibration(fresh_blend, tmp_path, turn_deg):
    """The panorama's middle looks along +x of the world, or so much to the left, and that is the east."""
    bpy = fresh_blend
    path = panoramas.write_panorama(tmp_path / "map.exr", np.full((8, 16, 3), 0.5, np.float32))
    turn = np.array(Matrix.Rotation(np.radians(turn_deg), 3, "Z"))
    panoramas.room_place(bpy, path, panorama_from_world=turn.T)
    bpy.context.view_layer.update()
    add(bpy, north_from="PANORAMA", heading=90)
    assert off_deg(shines_from(bpy), wanted(turn_deg)) < NEAR_DEG
    origin = bpy.context.scene.panorama_place.origin.matrix_world.translation
    from_origin = (suns(bpy)[0].location - origin).normalized()
    assert off_deg(from_origin, shines_from(bpy)) < 0.1


LAMP_UV, WIDTH = (0.3, 0.5 - ALTITUDE_DEG / 180), 256
"""In the map of a level panorama: as high as the sun was."""


@pytest.fixture
def sunny(fresh_blend, tmp_path):
    """A place turned by 50° whose panorama shows a lamp at LAMP_UV."""
    image = np.full((WIDTH // 2, WIDTH, 3), 0.01, np.float32)
    cosines = equirectangular.pixel_directions(WIDTH, WIDTH // 2) @ equirectangular.direction_from_uv(LAMP_UV)
    image[cosines > np.cos(np.radians(2))] = 100
    path = panoramas.write_panorama(tmp_path / "map.exr", image)
    turn = np.array(Matrix.Rotation(np.radians(50), 3, "Z"))
    _, place = panoramas.room_place(fresh_blend, path, panorama_from_world=turn.T)
    fresh_blend.context.view_layer.update()
    return place


def test_the_panoramas_sun_tells_north(fresh_blend, sunny):
    """The lamp is 0.2 turns left of the panorama's middle, so the middle looks 72° further to the right."""
    bpy = fresh_blend
    add(bpy, north_from="LAMP")
    lamp = sunny.origin.matrix_world.to_3x3() @ Vector(equirectangular.direction_from_uv(LAMP_UV))
    assert off_deg(shines_from(bpy), lamp) < 0.5
    kept = dict(suns(bpy)[0]["panorama_sun_by_time"])
    assert kept["north_from"] == "PANORAMA"
    assert kept["heading"] == pytest.approx((AZIMUTH_DEG + 0.2 * 360) % 360, abs=0.5)
    before = shines_from(bpy)
    add(bpy, north_from="PANORAMA", heading=kept["heading"])
    assert off_deg(shines_from(bpy), before) < 0.01


def test_a_lamp_that_is_not_as_high_as_the_sun(fresh_blend, sunny):
    reports, line = work(fresh_blend, north_from="LAMP")
    assert reports == []
    assert "° the panorama's middle" in line
    ((kind, text),) = work(fresh_blend, north_from="LAMP", hour=15)[0]
    assert kind == {"WARNING"}
    assert text.startswith("The panorama's strongest lamp stands at an altitude of 39.9°, the sun at 18.7°")


def test_a_heading_needs_a_panorama(fresh_blend):
    with pytest.raises(RuntimeError, match="has no panorama: calibrate one first"):
        add(fresh_blend, north_from="PANORAMA")
    assert not suns(fresh_blend)


def test_the_one_that_stands_is_turned_and_keeps_its_strength(fresh_blend):
    bpy = fresh_blend
    add(bpy)
    before = shines_from(bpy)
    suns(bpy)[0].data.energy = 7
    add(bpy, hour=15)
    (sun,) = suns(bpy)
    assert sun.data.energy == 7
    an_eighth_turn = 2 * np.degrees(np.arcsin(np.cos(np.radians(9.3)) * np.sin(np.radians(22.5))))
    assert off_deg(before, shines_from(bpy)) == pytest.approx(an_eighth_turn, abs=0.05)  # declination −9.3°
    assert dict(sun["panorama_sun_by_time"])["hour"] == 15


def test_it_can_be_undone(fresh_blend):
    bpy = fresh_blend
    bpy.ops.ed.undo_push(message="before")
    add(bpy)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert not suns(bpy)


def work(bpy, **change):
    """Reports, and the line of the operator: of its work, without Blender around it."""
    from types import SimpleNamespace

    from expanded_panoramas.operators.sun_position import PANORAMA_OT_add_sun_by_time as operator

    given = {**GOLDEN, **MOMENT, "method": "psa2020", "north_from": "WORLD", "north": 0.0, **change}
    reports, stand_in = [], SimpleNamespace(**given, as_keywords=lambda: given)
    stand_in.report = lambda *report: reports.append(report)
    stand_in.time = lambda: operator.time(stand_in)
    stand_in.find_heading = lambda *arguments: operator.find_heading(stand_in, *arguments)
    stand_in.north_in_world = lambda scene: operator.north_in_world(stand_in, scene)
    return reports, operator.work(stand_in, bpy.context)


def test_it_reports_the_altitude(fresh_blend):
    reports, line = work(fresh_blend)
    assert reports == []
    assert "altitude 39.9" in line
    assert "azimuth 194.1" in line  # half a minute before the published one


def test_it_warns_when_the_sun_has_set(fresh_blend):
    reports, line = work(fresh_blend, hour=20)
    ((kind, text),) = reports
    assert kind == {"WARNING"}
    assert text.endswith("° below the horizon")
    assert "altitude -" in line
    assert shines_from(fresh_blend)[2] < 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"latitude": 90.5}, "latitude 90.5: must be a number from −90 to 90"),
        ({"longitude": -200.0}, "longitude -200: must be a number from −180 to 180"),
        ({"month": 2, "day": 30}, "2003-02-30: there is no such day"),
        ({"latitude": float("nan")}, "latitude nan"),
    ],
)
def test_bad_input_changes_nothing(fresh_blend, change, message):
    with pytest.raises(RuntimeError, match=message):
        add(fresh_blend, **change)
    assert not suns(fresh_blend)
