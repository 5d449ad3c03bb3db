"""Lamps at infinity as discs: irradiance and direction kept, quiet maps told apart."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.discs import (
    LEAST_SHARE,
    MOST,
    WIDEST,
    split_into_discs,
)
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance

WIDTH, HEIGHT = 512, 256
ENERGY = 1e-5  # relative, float32 maps
DIRECTION = np.radians(0.2)


def lamp(elevation_deg, azimuth_deg, radius_deg):
    """Pixels of a round lamp, and the unit vector to its middle."""
    elevation, azimuth = np.radians(elevation_deg), np.radians(azimuth_deg)
    middle = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT)
    return directions @ middle > np.cos(np.radians(radius_deg)), middle


def map_with(*lamps, radiance=200.0):
    image = np.full((HEIGHT, WIDTH, 3), 0.01, np.float32)
    for pixels, _ in lamps:
        image[pixels] = radiance
    return image


@pytest.mark.parametrize(
    ("elevation", "azimuth", "radius"), [(30, 40, 3), (10, 180, 6), (88, 0, 5), (-50, 90, 2)]
)
def test_a_round_lamp_is_one_disc(elevation, azimuth, radius):
    pixels, middle = lamp(elevation, azimuth, radius)
    found = split_into_discs(map_with((pixels, middle)))
    (disc,) = found.discs
    assert np.arccos(disc.direction @ middle) < DIRECTION
    assert np.degrees(disc.radius) == pytest.approx(radius, rel=0.12)
    assert found.helps


def test_discs_and_quiet_map_hold_the_map():
    lamps = lamp(30, 40, 4), lamp(60, -120, 2), lamp(-20, 179, 3)
    image = map_with(*lamps)
    image[100:104, 200:260] = 50  # a tube
    found = split_into_discs(image)
    carried = np.zeros(image.shape[:2], bool)
    for disc in found.discs:
        assert not carried.ravel()[disc.pixels].any()  # no pixel in two discs
        carried.ravel()[disc.pixels] = True
    together = irradiance(image, carried) + irradiance(found.quiet)
    assert together == pytest.approx(irradiance(image), rel=ENERGY)
    assert found.share == pytest.approx((irradiance(image, carried) / irradiance(image))[0], rel=ENERGY)


def test_irradiance_on_planes_is_kept():
    image = map_with(lamp(50, 40, 4), lamp(65, -120, 6), lamp(40, 179, 3))
    image[40:60, 100:140] = 30
    found = split_into_discs(image)
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT)
    quiet_directions = equirectangular.pixel_directions(*found.quiet.shape[1::-1])

    def on_plane(picture, directions, normal):
        return irradiance((picture * np.maximum(directions @ normal, 0)[..., None]).astype(np.float32))

    for normal in ([0, 0, 1], [0.3, 0.2, 0.93]):
        normal = np.array(normal) / np.linalg.norm(normal)
        expected = on_plane(image, directions, normal)
        quiet = on_plane(found.quiet, quiet_directions, normal)
        suns = sum(disc.irradiance * max(disc.direction @ normal, 0) for disc in found.discs)
        assert suns + quiet == pytest.approx(expected, rel=2e-3)


def test_a_long_lamp_is_cut_and_a_wide_one_too():
    image = map_with()
    image[100:104, 100:300] = 100
    tube = split_into_discs(image)
    assert len(tube.discs) > 2
    wide = split_into_discs(map_with(lamp(40, 0, 35)))
    assert all(disc.radius <= WIDEST + np.pi / HEIGHT for disc in (*tube.discs, *wide.discs))


@pytest.mark.parametrize("radiance", [0.3, 1.0])
def test_an_overcast_sky_is_left_alone(radiance):
    image = np.full((HEIGHT, WIDTH, 3), 0.05, np.float32)
    image[: HEIGHT // 2] = radiance
    found = split_into_discs(image)
    assert found.discs == ()
    assert not found.helps


def test_a_sun_in_a_bright_sky_does_not_help_enough():
    """Half of the light is the sky's, which needs aiming at no less than before."""
    image = map_with(lamp(50, 30, 1), radiance=7e3)
    image[: HEIGHT // 2] += 1
    found = split_into_discs(image)
    assert 0.2 < found.share < 0.8
    assert not found.helps


def test_one_hot_pixel_is_a_disc_of_about_its_size():
    image = map_with()
    image[70, 300] = 1e6
    found = split_into_discs(image)
    assert len(found.discs) == 1
    assert np.pi / HEIGHT / 3 < found.discs[0].radius < 2 * np.pi / HEIGHT
    assert found.helps


def test_at_most_so_many_the_strongest():
    lamps = [lamp(30, azimuth, 2) for azimuth in range(0, 360, 9)]
    image = map_with(*lamps)
    image[lamps[3][0]] *= 2
    assert len(split_into_discs(image).discs) <= MOST
    (one,) = split_into_discs(image, 1).discs
    assert one.direction @ lamps[3][1] > 0.999
    assert split_into_discs(image, 0).discs == ()


def test_a_weak_lamp_stays_in_the_quiet_map():
    image = map_with(lamp(30, 40, 6))
    image[60, 10] = 200
    found = split_into_discs(image)
    assert all(image.ravel()[3 * disc.pixels].sum() > LEAST_SHARE for disc in found.discs)
    assert not any(60 * WIDTH + 10 in disc.pixels for disc in found.discs)
