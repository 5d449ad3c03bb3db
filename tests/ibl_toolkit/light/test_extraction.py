"""Lights and residual hold the map's light between them, by every method; the default knows when to stop."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.choice import MOST_LIGHTS
from expanded_panoramas.ibl_toolkit.light.extraction import METHODS, extract_lights
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance

ENERGY = 1e-6  # relative
DIRECTION = 0.01  # [rad]
POSITION = 0.02  # [m]
SIZE = 128, 64
LAMPS = ((1, 0.2, 0.5), (-0.5, 1, 0.7), (0.1, -1, 0.9), (-1, 0, 0.3))  # one of them across the seam


def room(lamps=LAMPS, radiance=300.0, radius=0.1, size=SIZE):
    """A dim map with round lamps -> image, unit vectors to them."""
    rng = np.random.default_rng(3)
    directions = equirectangular.pixel_directions(*size)
    image = rng.uniform(0.1, 0.3, (*size[::-1], 3)).astype(np.float32)
    towards = np.array(lamps) / np.linalg.norm(lamps, axis=1, keepdims=True)
    for number, lamp in enumerate(towards):
        image[directions @ lamp > np.cos(radius)] = radiance / (1 + number) * np.array([1, 0.8, 0.6])
    return image, towards


def sky(width=128):
    """Overcast: the zenith three times as bright as the horizon, the ground dark."""
    up = equirectangular.pixel_directions(width, width // 2)[..., 2:]
    return (np.where(up > 0, 1 + 2 * up, 0.2) * np.ones(3)).astype(np.float32)


def assert_closed(image, found):
    whole = irradiance(image)
    both = found.samples.irradiance.sum(axis=0) + irradiance(found.residual)
    assert np.allclose(both, whole, rtol=ENERGY)
    covered = found.samples.partition >= 0
    assert (found.residual[covered] == 0).all()
    assert np.array_equal(found.residual[~covered], image[~covered])
    assert found.share == pytest.approx(1 - irradiance(found.residual) @ LUMA / (whole @ LUMA), abs=1e-6)


LUMA = np.array([0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("count", [None, 1, 7])
def test_lights_and_residual_are_the_whole_map(method, count):
    image, _ = room()
    found = extract_lights(image, method, count)
    assert_closed(image, found)
    if method == "importance" and count is None:
        assert 40 < len(found.samples) <= 64  # what falls on one pixel is one
    else:
        assert len(found.samples) == (count or (4 if method == "hybrid" else 64))
    assert found.method == method
    if method != "hybrid":
        assert found.threshold is None
        assert found.share == pytest.approx(1)
    assert (np.diff(found.samples.luminance) <= 0).all()


def test_each_lamp_becomes_one_light_where_it_is():
    image, towards = room()
    found = extract_lights(image)
    assert len(found.samples) == len(towards)
    assert (np.arccos(np.clip((found.samples.directions * towards).sum(axis=1), -1, 1)) < DIRECTION).all()
    for number, light in enumerate(found.samples.irradiance):
        assert np.allclose(light / light[0], (1, 0.8, 0.6), atol=1e-3), number
    disc = 2 * np.pi * (1 - np.cos(0.1))
    assert np.allclose(found.samples.solid_angles, disc, rtol=0.15)  # of pixels
    assert found.reason == "the brightest 1 % of the sphere hold 87 % of the light: 4 lights"
    assert found.warnings != ()  # flat lamps look clipped


def test_a_long_lamp_becomes_a_row_of_lights():
    image = np.full((64, 128, 3), 0.01, np.float32)
    image[28:30, 20:90] = 50
    found = extract_lights(image)
    assert 4 < len(found.samples) <= MOST_LIGHTS
    assert_closed(image, found)


@pytest.mark.parametrize("image", [sky(), np.full((64, 128, 3), 0.7, np.float32)], ids=["overcast", "flat"])
def test_a_map_without_a_bright_part_is_left_alone(image):
    found = extract_lights(image)
    assert len(found.samples) == 0
    assert np.array_equal(found.residual, image)
    assert "left alone" in found.reason
    assert found.share == 0
    assert extract_lights(image, depth=np.ones((64, 128))).positions.shape == (0, 3)


def test_what_is_asked_for_is_done_on_such_a_map_too():
    assert len(extract_lights(sky(), count=5).samples) == 5
    by_threshold = extract_lights(sky(), threshold=0.4)
    assert by_threshold.threshold == pytest.approx(0.4, abs=0.01)
    assert len(by_threshold.samples) > 1
    assert by_threshold.share > 0.35
    assert_closed(sky(), by_threshold)


def test_a_bright_part_with_fewer_pixels_gives_fewer_lights():
    image, _ = room(radius=0.05)
    found = extract_lights(image, count=500)
    assert len(found.samples) == np.count_nonzero(found.samples.partition >= 0) < 100
    assert found.reason.endswith(f": {len(found.samples)} lights, for it has no room for 500")
    assert extract_lights(image, count=3).reason.endswith("3 lights, as asked")


def test_no_lights_may_be_asked_for():
    image, _ = room()
    found = extract_lights(image, count=0)
    assert len(found.samples) == 0
    assert found.reason.endswith("no lights, as asked")


def test_lamps_at_depth_have_positions_and_a_small_share_is_enough():
    image, towards = room(radiance=15.0)
    depth = np.full((64, 128), 2.5)
    assert len(extract_lights(image).samples) == 0
    found = extract_lights(image, depth=depth)
    assert len(found.samples) == 4
    assert np.allclose(found.positions, 2.5 * towards, atol=POSITION + 2.5 * 0.1**2 / 4)


def test_a_depth_that_the_bright_part_lacks_does_not_count():
    image, towards = room(radiance=15.0)
    depth = np.full((64, 128), 2.5)
    depth[(equirectangular.pixel_directions(*SIZE) @ towards.T).max(axis=2) > 0.9] = np.inf
    assert len(extract_lights(image, depth=depth).samples) == 0


def test_a_lamp_without_depth_has_no_position():
    image, towards = room()
    depth = np.full((64, 128), 2.5)
    depth[equirectangular.pixel_directions(*SIZE) @ towards[1] > 0.9] = np.inf
    found = extract_lights(image, depth=depth)
    assert np.isnan(found.positions).any(axis=1).tolist() == [False, True, False, False]
    assert "1 of 4 lights have no depth: they have a direction, but no position" in found.warnings


def test_a_lamp_half_without_depth_is_where_the_other_half_is():
    image, _ = room(lamps=[(1, 0, 0)])
    depth = np.full((64, 128), 2.0)
    depth[:, 64:] = np.inf
    depth[:, 64] = 2.0  # a column more than half
    (position,) = extract_lights(image, depth=depth).positions
    assert np.linalg.norm(position) == pytest.approx(2, abs=POSITION)
    assert position[1] > 0.02


def test_one_hot_pixel_becomes_one_light_and_is_told():
    image = sky()
    image[20, 64] = 1e5
    found = extract_lights(image)
    assert len(found.samples) == 1
    pixel = equirectangular.uv_from_pixel([64, 20], *SIZE)
    assert found.samples.directions[0] @ equirectangular.direction_from_uv(pixel) > np.cos(DIRECTION)
    assert any("pixel (64, 20) holds" in text and "hot pixel" in text for text in found.warnings)
    assert_closed(image, found)
    image[19:22, 63:66] += 2000  # a lens spreads the light of a lamp
    assert not any("hot pixel" in text for text in extract_lights(image).warnings)


@pytest.mark.parametrize(("row", "column"), [(0, 0), (0, 127), (63, 64), (30, 0)])
def test_a_hot_pixel_at_seam_and_poles(row, column):
    image = sky()
    image[row, column] = 1e7
    found = extract_lights(image)
    assert any(f"pixel ({column}, {row}) holds" in text for text in found.warnings)
    assert_closed(image, found)


def test_a_clipped_sun_is_told():
    image = sky()
    image[20:22, 64:67] = 900
    assert any("looks clipped: 6 pixels" in text for text in extract_lights(image).warnings)


def test_few_lights_for_a_wide_bright_sky_are_told():
    found = extract_lights(sky(), count=2, threshold=0.7)
    assert any("wider than 30°" in text for text in found.warnings)


def test_one_light_for_two_lamps_stands_between_them():
    image, towards = room(lamps=[(1, 0.4, 0), (1, -0.4, 0)])
    (direction,) = extract_lights(image, count=1).samples.directions
    weights = np.array([1, 0.5])  # of their radiance
    assert direction @ (weights @ towards) / np.linalg.norm(weights @ towards) > np.cos(DIRECTION)


def test_a_very_bright_lamp_leaves_the_others_in_the_residual():
    image, towards = room(radiance=30.0)
    directions = equirectangular.pixel_directions(*SIZE)
    image[directions @ (0, 0.6, -0.8) > np.cos(0.1)] = 1e4
    lamps = (directions @ towards.T).max(axis=2) > np.cos(0.09)
    assert extract_lights(image).residual[lamps].max() == 30  # but for the one pixel that the rule adds
    assert extract_lights(image, threshold=0.9915).residual[lamps].max() == 0


def test_many_pixels_are_sampled_by_penrose_tiles():
    image, towards = room(size=(512, 256), radius=0.3)
    found = extract_lights(image, count=4)
    assert np.count_nonzero(found.samples.partition >= 0) > 2000
    assert_closed(image, found)
    assert (np.arccos(np.clip((found.samples.directions * towards).sum(axis=1), -1, 1)) < DIRECTION).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"method": "random"}, "method is 'random': must be one of hybrid, median-cut"),
        ({"method": "penrose", "threshold": 0.5}, "only the method hybrid splits"),
        ({"method": "penrose", "count": 0}, "count is 0"),
        ({"count": -1}, "count is -1"),
        ({"threshold": 1.2}, "share is 1.2"),
        ({"depth": np.ones((4, 8))}, r"depth has shape \(4, 8\); expected the light map's \(64, 128\)"),
        ({"depth": np.zeros((64, 128))}, "depth has 8192 values that are NaN or not above 0"),
    ],
)
def test_what_makes_no_sense_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        extract_lights(room()[0], **changes)
