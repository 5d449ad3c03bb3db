"""One lamp of a map: the region with the most light, and the one under a click."""

import importlib.util
import pathlib

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.picked_lamp import lamp_at, strongest_lamps

WIDTH, HEIGHT = 256, 128
SPEC = importlib.util.find_spec("bpy")
SHIPPED = list(pathlib.Path(SPEC.origin).parent.glob("*/datafiles/studiolights/world")) if SPEC else []


def disc(image, uv, radius_deg, radiance):
    """Paint a round lamp; returns the unit vector to its middle."""
    middle = equirectangular.direction_from_uv(uv)
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT)
    image[directions @ middle > np.cos(np.radians(radius_deg))] = radiance
    return middle


@pytest.fixture
def image():
    return np.full((HEIGHT, WIDTH, 3), 0.01, np.float32)


def test_the_region_with_the_most_light_not_the_brightest_pixel(image):
    image[40, 40] = 500  # half of the other's light
    wide = disc(image, (0.75, 0.25), 5, 20)
    found = strongest_lamps(image)[0]
    assert found.direction @ wide > np.cos(np.radians(0.5))
    assert found.radius == pytest.approx(np.radians(5), rel=0.1)


def test_several_lamps_the_strongest_first(image):
    middles = [disc(image, uv, 4, radiance) for uv, radiance in (((0.2, 0.3), 20), ((0.75, 0.25), 50))]
    found = strongest_lamps(image, 3)
    assert [lamp.direction @ middle > 0.9999 for lamp, middle in zip(found, middles[::-1], strict=True)] == [
        1,
        1,
    ]
    assert len(strongest_lamps(image)) == 1


@pytest.mark.parametrize("lamp_uv", [(0.75, 0.25), (0.0, 0.4), (0.3, 0.02)])  # plain, on the seam, at a pole
def test_the_lamp_under_a_click(image, lamp_uv):
    disc(image, (0.5, 0.7), 8, 100)  # more light elsewhere
    wanted = disc(image, lamp_uv, 4, 50)
    found = lamp_at(image, np.array(lamp_uv))
    assert found.direction @ wanted > np.cos(np.radians(0.5))
    colour = image.reshape(-1, 3)[found.pixels]
    assert colour.min() == 50


def test_a_sun_comes_without_its_glow(image):
    glow_uv, sun_uv = (0.74, 0.26), (0.75, 0.25)
    disc(image, glow_uv, 12, 2)
    sun = disc(image, sun_uv, 1.5, 400)
    for found in (strongest_lamps(image)[0], lamp_at(image, np.array([0.72, 0.25]))):
        assert found.direction @ sun > np.cos(np.radians(0.2))
        assert found.radius == pytest.approx(np.radians(1.5), rel=0.15)
        assert image.reshape(-1, 3)[found.pixels].min() == 400


def test_a_hot_pixel_in_a_lamp_is_not_its_core(image):
    lamp = disc(image, (0.75, 0.25), 6, 20)
    image[30, 192] = 500
    found = strongest_lamps(image)[0]
    assert found.direction @ lamp > np.cos(np.radians(1))
    assert found.radius == pytest.approx(np.radians(6), rel=0.1)


def test_beside_a_lamp_is_none(image):
    disc(image, (0.75, 0.25), 4, 50)
    with pytest.raises(ValueError, match=r"no lamp at u 0.700, v 0.250: the nearest is at u 0.750, v 0.250"):
        lamp_at(image, np.array([0.7, 0.25]))


def test_nothing_stands_out_of_an_even_map(image):
    for find in (strongest_lamps, lambda even: lamp_at(even, np.array([0.5, 0.5]))):
        with pytest.raises(ValueError, match="no lamp stands out"):
            find(image)


@pytest.mark.parametrize(
    ("name", "across_deg"),
    [("city", 0.77), ("sunrise", 0.81), ("interior", 0.70), ("sunset", 33.0), ("forest", 25.0)],
)
def test_suns_of_blenders_own_panoramas(name, across_deg):
    """As docs/methods/light.md says."""
    if not SHIPPED:
        pytest.skip("no bpy, which brings the panoramas")
    (found,) = strongest_lamps(np.maximum(read_panorama(SHIPPED[0] / f"{name}.exr"), 0))
    assert np.degrees(2 * found.radius) == pytest.approx(across_deg, rel=0.02)
