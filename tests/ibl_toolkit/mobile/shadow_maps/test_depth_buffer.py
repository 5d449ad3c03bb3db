"""Depth from the light: cameras, bias matrix, polygon offset, what is cut away."""

from dataclasses import replace

import numpy as np
import pytest
from shadow_scenes import Ball, Box, Scene

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import LightCamera
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.depth_buffer import depth_buffer

SCENE = Scene((Box((-0.6, -0.3, 0), (-0.1, 0.2, 0.9)), Ball((0.7, 0.2, 0.6), 0.3, rings=16)))
SLOPED = np.array([[-1.0, -1, 1], [1, -1, 3], [1, 1, 3], [-1, 1, 1]]), np.array([[0, 1, 2], [0, 2, 3]])
ABOVE = LightCamera(np.array([0, 0, 4.0]), np.diag([1.0, -1, -1]), False, 1.0, 1.0, 0.0, 4.0)
LAMP = LightCamera.of_lamp((1.5, -1.0, 3.0), SCENE.mesh()[0])


@pytest.mark.parametrize("camera", [LightCamera.of_sun((0.5, -0.6, 0.9), SCENE.mesh()[0]), LAMP])
def test_matrices_agree_with_axes_and_fit_the_scene(camera):
    points, _ = SCENE.mesh()
    clip = np.c_[points, np.ones(len(points))] @ (camera.clip_from_light @ camera.light_from_world).T
    ndc = clip[:, :3] / clip[:, 3:]
    np.testing.assert_allclose(camera.texture(points), ndc * 0.5 + 0.5, atol=1e-12)
    assert (np.abs(ndc) <= 1).all()
    assert (ndc[:, :2].max(axis=0) > 0.85).all()
    assert (ndc[:, :2].min(axis=0) < -0.85).all()
    along = (points - camera.eye) @ camera.axes[2]
    expected = (along - camera.near) / (camera.far - camera.near)
    np.testing.assert_allclose(camera.linear_depth(camera.texture(points)[:, 2]), expected, atol=1e-9)


def test_texture_grows_to_the_right_upward_and_away_from_the_light():
    sun = LightCamera.of_sun((0, -1, 0), np.array([[-1.0, -1, -1], [1, 1, 1]]))
    s, t, r = (sun.texture(np.eye(3)) - sun.texture(-np.eye(3))).T
    assert s[0] > 0.9
    assert t[2] > 0.9
    assert r[1] > 0.9
    assert np.abs([s[1], s[2], t[0], t[1], r[0], r[2]]).max() < 1e-12


@pytest.mark.parametrize("camera", [LightCamera.of_sun((0.5, -0.6, 0.9), SCENE.mesh()[0]), LAMP])
def test_the_floor_alone_is_seen_at_its_own_depth(camera):
    points, triangles = SCENE.mesh()
    depth = depth_buffer(points, triangles[:2], camera, 64, 0, 0, None)
    places, _ = SCENE.floor(50)
    texture = camera.texture(places)
    column, row = (texture[:, :2] * 64).astype(int).T
    centre = (np.stack([column, row], axis=1) + 0.5) / 64
    # The floor's depth is linear over the map: from a place to its texel's middle by the plane's slope.
    slope = np.linalg.lstsq(np.c_[texture[:, :2], np.ones(len(texture))], texture[:, 2], rcond=None)[0]
    expected = texture[:, 2] + (centre - texture[:, :2]) @ slope[:2]
    seen = depth[row, column] < 1  # at the floor's border a texel's middle may miss it
    assert seen.mean() > 0.95
    np.testing.assert_allclose(depth[row, column][seen], expected[seen], atol=1e-9)


def test_the_nearest_of_several_is_seen_whatever_their_order():
    points, triangles = SCENE.mesh()
    one = depth_buffer(points, triangles, LAMP, 128, 0, 0, None)
    other = depth_buffer(points, triangles[::-1], LAMP, 128, 0, 0, None)
    np.testing.assert_array_equal(one, other)
    assert (one <= depth_buffer(points, triangles[:2], LAMP, 128, 0, 0, None)).all()


def test_polygon_offset_is_slope_times_factor_plus_steps_times_units():
    plain = depth_buffer(*SLOPED, ABOVE, 8, 0, 0, 1 / 255)
    slope = plain[0, 0] - plain[0, 1]  # 2 m in 8 texels, of 4 m: 1/16
    assert slope == pytest.approx(1 / 16)
    moved = depth_buffer(*SLOPED, ABOVE, 8, 1.9, 4, 1 / 255)
    np.testing.assert_allclose(moved - plain, 1.9 / 16 + 4 / 255)


def test_a_floats_step_is_that_of_its_exponent():
    plain = depth_buffer(*SLOPED, ABOVE, 8, 0, 0, None)
    moved = depth_buffer(*SLOPED, ABOVE, 8, 0, 1024, None)
    np.testing.assert_allclose(
        moved - plain, 1024 * 2.0**-24, rtol=1e-6
    )  # the farthest is at 0.75 = 2⁻¹ · 1.5


def test_what_is_out_of_range_is_cut_away():
    middle = replace(ABOVE, near=1.5, far=2.5)  # of depths from 1 to 3 m
    depth = depth_buffer(*SLOPED, middle, 8, 0, 0, None)
    assert (depth[:, 2:6] < 1).all()
    assert (depth[:, [0, 1, 6, 7]] == 1).all()


def test_a_floor_that_passes_beside_a_lamp_is_cut_there():
    lamp = LightCamera(
        np.array([0, 0, 1.0]), np.array([[0, -1.0, 0], [0, 0, 1], [1, 0, 0]]), True, 1, 1, 0.1, 4
    )
    points, triangles = np.array([[-9.0, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]), SLOPED[1]
    depth = depth_buffer(points, triangles, lamp, 16, 0, 0, None)
    assert (depth[8:] == 1).all()  # above the horizon
    expected = 1 / (1 - (np.arange(16) + 0.5) / 8)  # where the floor is on each row [m]
    seen = expected[:6]
    linear = lamp.linear_depth(depth[:6, 8])
    np.testing.assert_allclose(linear, (seen - 0.1) / 3.9, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: LightCamera.of_sun((0, 0, 1), np.empty((0, 3))), "empty"),
        (lambda: LightCamera.of_sun((0, 0, 0), SLOPED[0]), "direction"),
        (lambda: LightCamera.of_sun((0, 0, np.nan), SLOPED[0]), "direction"),
        (lambda: LightCamera.of_sun((0, 0, 1), SLOPED[0] * np.inf), "finite"),
        (lambda: LightCamera.of_lamp((0, 0, 2.0), SLOPED[0]), "lamp's position"),
        (lambda: replace(ABOVE, far=0.0), "range of depths"),
        (lambda: replace(ABOVE, perspective=True), "above 0"),
        (lambda: replace(ABOVE, half_width=0), "half sizes"),
        (lambda: replace(ABOVE, axes=np.ones((3, 3))), "rotation"),
    ],
)
def test_refuses(make, words):
    with pytest.raises(ValueError, match=words):
        make()
