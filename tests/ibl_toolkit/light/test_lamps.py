"""Lamps of a box room come back as outlines: where they are, as large, as bright, and the rest unchanged."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.lamps import MOST, split_into_lamps
from expanded_panoramas.ibl_toolkit.light.light_map import LUMINANCE
from expanded_panoramas.ibl_toolkit.light.outline import solid_angle_of_outline

WIDTH, HEIGHT = 1024, 512
HALF_SIZE = np.array([2.0, 2.0, 1.2])  # of the box room round the panorama [m]
ENERGY = 1e-6  # relative
POSITION = 0.02  # [m]; an outline follows the edges of pixels
AREA = 0.05  # relative; a lamp's border is a row of pixels


def box_room():
    """Depth and points (H, W, 3) of the inside of a box."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    with np.errstate(divide="ignore"):
        depth = np.min(HALF_SIZE / np.abs(directions), axis=2)
    return depth, directions * depth[..., None]


def lamp_on_ceiling(points, centre, size):
    """Pixels of a rectangle on the ceiling."""
    offsets = np.abs(points[..., :2] - centre)
    return (points[..., 2] > HALF_SIZE[2] - 1e-6) & (offsets < np.array(size) / 2).all(axis=2)


def room_with_lamps(*lamps):
    depth, points = box_room()
    image = np.full((HEIGHT, WIDTH, 3), 0.2, np.float32)
    for centre, size, radiance in lamps:
        image[lamp_on_ceiling(points, centre, size)] = radiance
    return image, depth


def power(image):
    """Luminous power of a map (h, w, 3)."""
    height, width = image.shape[:2]
    return float((image @ LUMINANCE).sum(axis=1) @ equirectangular.row_solid_angles(width, height))


def area(outline):
    """Vector area (3,) of a flat polygon (k, 3) [m²], by its winding."""
    return np.cross(outline, np.roll(outline, -1, axis=0)).sum(axis=0) / 2


def normal(outline):
    """Unit normal of a polygon, by its winding."""
    return area(outline) / np.linalg.norm(area(outline))


def sent(lamp):
    """Luminous power that a lamp sends to the origin."""
    return sum(map(solid_angle_of_outline, lamp.outlines)) * (lamp.radiance @ LUMINANCE)


def test_a_lamp_is_found_where_it_is():
    image, depth = room_with_lamps(((0.8, -0.6), (0.5, 0.3), (60, 50, 40)))
    found = split_into_lamps(image, depth)
    (lamp,) = found.lamps
    (outline,) = lamp.outlines
    assert len(outline) == 4
    assert np.allclose(outline.min(axis=0), (0.55, -0.75, HALF_SIZE[2]), atol=POSITION)
    assert np.allclose(outline.max(axis=0), (1.05, -0.45, HALF_SIZE[2]), atol=POSITION)
    assert np.allclose(normal(outline), (0, 0, -1), atol=1e-3)
    assert np.allclose(lamp.radiance, (60, 50, 40), rtol=AREA)
    assert np.allclose(found.quiet, 0.2)


@pytest.mark.parametrize(
    "lamp",
    [
        ((-1.2, 0.02), (0.3, 0.4), (80, 80, 80)),  # across the seam
        ((0.0, 0.0), (0.6, 0.6), (30, 30, 30)),  # over the zenith
        ((1.98, 0.0), (0.3, 0.8), (80, 60, 40)),  # cut by a wall
    ],
)
def test_power_is_kept_and_the_lamp_stays_one(lamp):
    image, depth = room_with_lamps(lamp)
    found = split_into_lamps(image, depth)
    (one,) = found.lamps
    assert sent(one) / power(image) == pytest.approx(found.share, rel=ENERGY)
    assert sum(np.linalg.norm(area(o)) for o in one.outlines) == pytest.approx(visible_area(lamp), rel=0.15)


def visible_area(lamp):
    (x, _), (width, height), _ = lamp
    inside = min(x + width / 2, HALF_SIZE[0]) - max(x - width / 2, -HALF_SIZE[0])
    return inside * height


def test_a_region_bent_over_an_edge_becomes_flat_lamps():
    image, depth = room_with_lamps()
    _, points = box_room()
    strip = (np.abs(points[..., 1]) < 0.3) & (points[..., 0] > 1.5) & (points[..., 2] > 0.7)
    image[strip] = 50
    lamps = split_into_lamps(image, depth).lamps
    normals = np.array([normal(outline) for lamp in lamps for outline in lamp.outlines])
    assert len(lamps) == 2
    assert np.allclose(sorted(normals[:, 2]), (-1, 0), atol=0.02)
    assert np.allclose(sorted(normals[:, 0]), (-1, 0), atol=0.02)


def test_a_lamp_half_hidden_by_a_column_is_cut_at_its_edge():
    """The visible half alone shines; a bright rim that the calibration put on the column is a lamp there."""
    image, depth = room_with_lamps(((1.2, 0.0), (0.6, 0.6), (60, 60, 60)))
    _, points = box_room()
    column = points[..., 1] < 0  # half of everything, at half of its depth
    rim = column & (points[..., 1] > -0.03)
    image[column & ~rim] = 0.2
    depth = np.where(column, depth / 2, depth)
    lamps = split_into_lamps(image, depth).lamps
    assert len(lamps) == 2
    far, near = sorted((lamp.outlines[0] for lamp in lamps), key=lambda o: -o[:, 2].mean())
    assert np.allclose(far[:, 2], HALF_SIZE[2], atol=0.01)
    assert np.allclose(near[:, 2], HALF_SIZE[2] / 2, atol=0.02)
    assert far[:, 1].min() > -POSITION


def test_at_most_so_many_the_strongest():
    lamps = [((x, 0.8), (0.2, 0.2), (radiance,) * 3) for x, radiance in ((-1, 50), (0, 90), (1, 70))]
    image, depth = room_with_lamps(*lamps)
    (lamp,) = split_into_lamps(image, depth, most=1).lamps
    outline = lamp.outlines[0]
    assert (outline[:, 0].min() + outline[:, 0].max()) / 2 == pytest.approx(0, abs=POSITION)
    none = split_into_lamps(image, depth, most=0)
    assert none.lamps == ()
    assert power(none.quiet) == pytest.approx(power(image), rel=ENERGY)


def test_a_hundred_lamps_are_not_too_many():
    places = np.arange(-1.8, 1.9, 0.4)
    lamps = [((x, y), (0.08, 0.08), (90,) * 3) for x in places for y in places]
    found = split_into_lamps(*room_with_lamps(*lamps))
    assert len(found.lamps) == MOST < len(lamps)


def test_where_depth_is_missing_the_light_stays_in_the_map():
    lamps = [(place, (0.5, 0.3), (60, 50, 40)) for place in ((0.8, -0.6), (-0.8, 0.6))]
    image, depth = room_with_lamps(*lamps)
    half = depth.copy()
    half[:, WIDTH // 2 :] = np.inf
    assert len(split_into_lamps(image, half).lamps) == 1
    assert split_into_lamps(image, np.full((HEIGHT, WIDTH), np.inf)).lamps == ()


def test_one_hot_pixel_is_a_lamp_of_about_its_size():
    depth, _ = box_room()
    image = np.full((HEIGHT, WIDTH, 3), 0.2, np.float32)
    image[60, 300] = 5e4
    found = split_into_lamps(image, depth)
    (lamp,) = found.lamps
    solid_angle = sum(map(solid_angle_of_outline, lamp.outlines))
    pixel = equirectangular.row_solid_angles(WIDTH, HEIGHT)[60]
    assert pixel / 3 < solid_angle < 3 * pixel
    assert sent(lamp) == pytest.approx(5e4 * pixel, rel=1e-5)


def test_a_flat_map_is_left_alone():
    depth, _ = box_room()
    found = split_into_lamps(np.full((HEIGHT, WIDTH, 3), 0.7, np.float32), depth)
    assert (found.lamps, found.share) == ((), 0.0)
    assert found.noise == pytest.approx(1)


def test_bad_input_is_refused():
    depth, _ = box_room()
    with pytest.raises(ValueError, match="shape"):
        split_into_lamps(np.ones((HEIGHT, WIDTH, 3), np.float32), depth[1:])
    with pytest.raises(ValueError, match="black"):
        split_into_lamps(np.zeros((HEIGHT, WIDTH, 3), np.float32), depth)
