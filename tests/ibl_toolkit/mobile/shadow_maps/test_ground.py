"""Shadows of new things on a floor that throws none: the floor is in the map of moments all the same."""

import numpy as np
import pytest
from shadow_errors import rms
from shadow_scenes import Ball, Box, Lamp, Scene, Sun

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import (
    LightCamera,
    reaching,
    shadow_map,
    suggested_settings,
    visibility,
)

SCENE = Scene((Box((-0.6, -0.3, 0), (-0.1, 0.2, 0.9)), Ball((0.7, 0.2, 0.6), 0.3)))
SUN, LAMP = Sun((0.5, -0.6, 0.9), 2.0, 64), Lamp((1.0, -1.2, 2.5), 0.05, 64)
SIDE, PENUMBRA = 160, 0.035
TABLE = np.array([[0.2, 0.5, 0.4], [0.9, 0.5, 0.4], [0.2, 1.2, 0.4]])


def parts():
    """What throws shadows, and the floor, each as points and triangles."""
    points, triangles = SCENE.mesh()
    return (points[4:], triangles[2:] - 4), (points[:4], triangles[:2])


def shadow(light, method, ground, filled=True):
    casters, _ = parts()
    settings = suggested_settings(3.0, 512, "16+16", PENUMBRA, method)
    if isinstance(light, Sun):
        camera = LightCamera.of_sun(light.direction, casters[0])
    else:
        camera = LightCamera.of_lamp(light.position, casters[0])
    camera = reaching(camera.with_border(settings), *ground)
    return visibility(shadow_map(*casters, camera, settings, ground if filled else None), *SCENE.floor(SIDE))


@pytest.mark.parametrize("light", [SUN, LAMP], ids=["sun", "lamp"])
@pytest.mark.parametrize("method", ["vsm", "evsm"])
def test_soft_edges_lie_where_they_should(method, light):
    truth = SCENE.lit(*SCENE.floor(SIDE), light)
    with_floor, without = (rms(shadow(light, method, parts()[1], filled), truth) for filled in (True, False))
    assert with_floor < 0.05
    assert without > 1.2 * with_floor


def test_ground_throws_no_shadow_on_other_ground():
    points, triangles = parts()[1]
    two = np.concatenate([points, TABLE]), np.concatenate([triangles, [[4, 5, 6]]])
    np.testing.assert_array_equal(shadow(SUN, "evsm", two), shadow(SUN, "evsm", parts()[1]))


def test_depths_reach_no_farther_than_twice_their_range():
    casters, (points, triangles) = parts()
    camera = LightCamera.of_sun((0.0, 0, 1), casters[0])
    thickness = camera.far - camera.near
    for below, times in ((-0.1, 1.0), (0.5, 1.55), (5.0, 1.0)):  # 5 m below is beyond reach
        reached = reaching(camera, points - [0, 0, below], triangles)
        assert reached.far - reached.near == pytest.approx(times * thickness, rel=0.05)


def test_without_ground_all_is_as_it_was():
    nothing = np.empty((0, 3)), np.empty((0, 3), np.int64)
    np.testing.assert_array_equal(shadow(SUN, "evsm", nothing), shadow(SUN, "evsm", nothing, filled=False))


def test_ground_that_is_not_finite_or_has_no_such_points_is_refused():
    casters, (points, triangles) = parts()
    camera, settings = LightCamera.of_sun(SUN.direction, casters[0]), suggested_settings(3.0, 64)
    for ground, reason in (((points * np.nan, triangles), "finite"), ((points[:3], triangles), "only 3")):
        with pytest.raises(ValueError, match=reason):
            shadow_map(*casters, camera, settings, ground)


@pytest.mark.parametrize("lowest", [0.0, -1.5], ids=["too far", "beyond the border"])
@pytest.mark.parametrize("method", ["vsm", "evsm"])
def test_sloping_ground_is_lit_where_it_ends_in_the_map(method, lowest):
    _, ground = parts()
    settings = suggested_settings(3.0, 64, "16+16", 0.3, method)
    camera = LightCamera.of_sun(SUN.direction, np.array([[-0.5, -0.5, lowest], [0.5, 0.5, 0.5]]))
    made = shadow_map(
        np.empty((0, 3)), np.empty((0, 3), np.int64), reaching(camera, *ground), settings, ground
    )
    assert visibility(made, *SCENE.floor(SIDE)).min() > 0.999
