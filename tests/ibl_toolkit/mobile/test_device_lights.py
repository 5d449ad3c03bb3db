"""A panorama's light for a phone: directions, strengths and ambient light of maps whose light is known."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.mobile.device_lights import MOST_LIGHTS, device_lights, floor_irradiance

WIDTH = 128
SKY = np.array([0.2, 0.3, 0.5])
POINTS = np.array([[-0.5, -0.5, 0], [0.5, 0.5, 1.0]])
TURN = np.array([[0.0, 0.6, 0.8], [-1, 0, 0], [0, -0.8, 0.6]])  # world from panorama
WARM, COOL = (9.0, 7.0, 4.0), (1.0, 1.5, 2.0)


def panorama(*lamps, sky=SKY):
    """A map of one colour with discs of 4° radius: (direction in the panorama, irradiance)."""
    ways = equirectangular.pixel_directions(WIDTH, WIDTH // 2)
    angles = equirectangular.row_solid_angles(WIDTH, WIDTH // 2)
    image = np.broadcast_to(sky, ways.shape).astype(np.float32)
    for direction, irradiance in lamps:
        unit = np.array(direction) / np.linalg.norm(direction)
        disc = ways @ unit > np.cos(np.radians(4))
        size = (disc * angles[:, None] * (ways @ unit)).sum()
        image[disc] += np.array(irradiance, np.float32) / size
    return image


def towards(light):
    return -light.camera.axes[2]


def on_floor(found):
    """What lights and ambient light bring to an upward floor, (3,)."""
    suns = (np.array(one.strength) * max(towards(one)[2], 0) for one in found.lights)
    return sum(suns, np.array(found.ambient))


def test_suns_stand_where_the_map_has_them_and_are_as_strong():
    directions = [(1.0, 0.5, 1.2), (-1.0, 0.3, 0.8)]
    found = device_lights(panorama((directions[0], WARM), (directions[1], COOL)), POINTS)
    assert len(found.lights) == 2
    for light, direction, irradiance in zip(found.lights, directions, (WARM, COOL), strict=True):
        unit = np.array(direction) / np.linalg.norm(direction)
        assert np.degrees(np.arccos(towards(light) @ unit)) < 1  # a pixel is 2.8° wide
        np.testing.assert_allclose(light.strength, irradiance, rtol=0.03)
        assert not light.camera.perspective
    np.testing.assert_allclose(found.ambient, np.pi * SKY, rtol=0.03)
    assert found.shares[0] > 0.5 > found.shares[1]
    assert found.warnings == ()


def test_a_floor_has_the_light_of_the_map_in_any_pose():
    rng = np.random.default_rng(3)
    image = panorama(((0.3, -0.5, 0.8), WARM), ((-0.2, 0.9, 0.1), COOL), sky=(0.1, 0.1, 0.1))
    image *= rng.uniform(0.5, 1.5, image.shape).astype(np.float32)
    for turn in (np.eye(3), TURN):
        rows = image, equirectangular.pixel_directions(WIDTH, WIDTH // 2)
        angles = equirectangular.row_solid_angles(WIDTH, WIDTH // 2)
        truth = sum(  # by a sum of its own, over all pixels
            np.maximum(way @ turn[2], 0) @ row.astype(float) * angle
            for row, way, angle in zip(*rows, angles, strict=True)
        )
        found = device_lights(image, POINTS, world_from_panorama=turn)
        np.testing.assert_allclose(on_floor(found), truth, rtol=1e-4)
        np.testing.assert_allclose(floor_irradiance(image, turn[2]), truth, rtol=1e-6)
        np.testing.assert_allclose(found.ambient_down, floor_irradiance(image, -turn[2]), rtol=1e-6)


def test_the_ambient_light_is_what_the_map_has_beside_its_lamps():
    """Within a few per cent, though it is measured at the floor, not at the lamps' pixels."""
    lamp = (0.5, 0.2, 0.6)
    found = device_lights(panorama((lamp, WARM)), POINTS)
    np.testing.assert_allclose(found.ambient, floor_irradiance(panorama()), rtol=0.03)


def test_directions_turn_with_the_panorama():
    image = panorama(((1.0, 0.5, 1.2), WARM))
    level = device_lights(image, POINTS)
    turned = device_lights(image, POINTS, world_from_panorama=TURN)
    np.testing.assert_allclose(towards(turned.lights[0]), TURN @ towards(level.lights[0]), atol=1e-6)


def test_lamps_are_where_their_surface_is():
    lamp, sky = (0.0, 0.6, 0.8), (-0.8, 0.0, 0.6)
    origin = np.array([2.0, 0, 1.5])
    found = device_lights(
        panorama((lamp, WARM), (sky, COOL)),
        POINTS,
        origin=origin,
        reach=lambda directions: np.where(directions[:, 1] > 0.3, 2.0, np.inf),
    )
    bulb, sun = found.lights
    assert bulb.camera.perspective
    assert not sun.camera.perspective
    np.testing.assert_allclose(bulb.camera.eye, origin + 2 * np.array(lamp), atol=0.02)
    np.testing.assert_allclose(np.array(bulb.strength) / 2**2, WARM, rtol=0.03)


def test_lamps_near_each_other_are_one_and_there_are_no_more_than_asked():
    near = [((1.0, 0.05 * k, 1.0), WARM) for k in (-1, 1)]
    ring = [((np.cos(k), np.sin(k), 0.7), WARM) for k in range(6)]
    assert len(device_lights(panorama(*near), POINTS).lights) == 1
    assert len(device_lights(panorama(*ring), POINTS).lights) == 6
    few = device_lights(panorama(*ring), POINTS, most=2)
    assert len(few.lights) <= 2
    np.testing.assert_allclose(on_floor(few), floor_irradiance(panorama(*ring)), rtol=0.02)


def test_what_lights_no_floor_is_left_out():
    below, faint = ((0.5, 0.0, -0.8), WARM), ((-0.5, 0.4, 0.8), (0.002, 0.002, 0.002))
    found = device_lights(panorama(((0, 1.0, 1), WARM), below, faint), POINTS)
    assert len(found.lights) == 1
    with pytest.raises(ValueError, match="no light stands out above the panorama's horizon"):
        device_lights(panorama(below, sky=(0, 0, 0)), POINTS)


def test_faint_shadows_are_said():
    found = device_lights(panorama(((0, 1.0, 1), (0.1, 0.1, 0.1))), POINTS)
    assert found.warnings[0].endswith("% of the floor's light: their shadows are faint")
    assert sum(found.shares) < 0.2


@pytest.mark.parametrize("most", [0, MOST_LIGHTS + 1])
def test_too_few_and_many_lights_are_refused(most):
    with pytest.raises(ValueError, match="must be 1 to 8"):
        device_lights(panorama(), POINTS, most)
