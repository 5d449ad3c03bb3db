"""Lamps of a box room come back as emitters: where they are, as large, as bright, and the rest unchanged."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.emitters import LUMINANCE, split_bright_part

WIDTH, HEIGHT = 1024, 512
HALF_SIZE = np.array([2.0, 2.0, 1.2])  # of the box room round the panorama [m]
ENERGY = 1e-6  # relative
POSITION = 0.02  # [m]
AREA = 0.05  # relative; a lamp's border is a row of pixels


def box_room():
    """Directions, depth and points (H, W, 3) of the inside of a box."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    with np.errstate(divide="ignore"):
        depth = np.min(HALF_SIZE / np.abs(directions), axis=2)
    return depth, directions * depth[..., None]


def lamp_on_ceiling(points, centre, size):
    """Pixels of a rectangle on the ceiling."""
    offsets = np.abs(points[..., :2] - centre)
    return (points[..., 2] > HALF_SIZE[2] - 1e-6) & (offsets < np.array(size) / 2).all(axis=2)


def power(image):
    """Luminous power of a map."""
    rows = equirectangular.row_solid_angles(WIDTH, HEIGHT)
    return float((image @ LUMINANCE).sum(axis=1) @ rows)


def room_with_lamps(*lamps):
    depth, points = box_room()
    image = np.full((HEIGHT, WIDTH, 3), 0.2, np.float32)
    for centre, size, radiance in lamps:
        image[lamp_on_ceiling(points, centre, size)] = radiance
    return image, depth


def test_a_lamp_is_found_where_it_is():
    image, depth = room_with_lamps(((0.8, -0.6), (0.5, 0.3), (60, 50, 40)))
    bright = split_bright_part(image, depth)
    (emitter,) = bright.emitters
    assert np.allclose(emitter.position, (0.8, -0.6, HALF_SIZE[2]), atol=POSITION)
    assert np.allclose(emitter.axes[:, 2], (0, 0, -1), atol=1e-3)
    assert np.allclose(np.sort(emitter.size), (0.3, 0.5), rtol=AREA)
    assert np.allclose(emitter.radiance, np.array((60, 50, 40)) - 0.2, rtol=1e-4)
    assert np.allclose(bright.residual, 0.2)


def test_the_axes_are_a_rotation():
    image, depth = room_with_lamps(((0.8, -0.6), (0.5, 0.3), (60, 50, 40)))
    axes = split_bright_part(image, depth).emitters[0].axes
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1)


@pytest.mark.parametrize(
    "lamp",
    [
        ((-1.2, 0.02), (0.3, 0.4), (80, 80, 80)),  # across the seam
        ((0.0, 0.0), (0.6, 0.6), (30, 30, 30)),  # over the zenith
        ((1.98, 0.0), (0.3, 0.8), (80, 60, 40)),  # cut by a wall
    ],
)
def test_power_is_kept_and_the_region_stays_one(lamp):
    image, depth = room_with_lamps(lamp)
    bright = split_bright_part(image, depth)
    taken = sum(emitter.solid_angle * (emitter.radiance @ LUMINANCE) for emitter in bright.emitters)
    assert taken + power(bright.residual) == pytest.approx(power(image), rel=ENERGY)
    assert taken / power(image) == pytest.approx(bright.share, rel=ENERGY)
    assert sum(emitter.area for emitter in bright.emitters) == pytest.approx(visible_area(lamp), rel=0.15)


def visible_area(lamp):
    (x, _), (width, height), _ = lamp
    inside = min(x + width / 2, HALF_SIZE[0]) - max(x - width / 2, -HALF_SIZE[0])
    return inside * height


def test_a_region_bent_over_an_edge_becomes_flat_parts():
    image, depth = room_with_lamps()
    _, points = box_room()
    strip = (np.abs(points[..., 1]) < 0.3) & (points[..., 0] > 1.5) & (points[..., 2] > 0.7)
    image[strip] = 50
    emitters = split_bright_part(image, depth).emitters
    normals = np.array([emitter.axes[:, 2] for emitter in emitters])
    assert len(emitters) > 1
    assert np.allclose(np.abs(normals).max(axis=1), 1, atol=0.05)
    assert (normals[:, 2] < -0.9).any()
    assert (normals[:, 0] < -0.9).any()


def test_at_most_so_many_the_strongest():
    lamps = [((x, 0.8), (0.2, 0.2), (radiance,) * 3) for x, radiance in ((-1, 50), (0, 90), (1, 70))]
    image, depth = room_with_lamps(*lamps)
    (emitter,) = split_bright_part(image, depth, most=1).emitters
    assert emitter.radiance[0] == pytest.approx(89.8, rel=1e-3)
    bright = split_bright_part(image, depth, most=0)
    assert bright.emitters == ()
    assert np.array_equal(bright.residual, image)


def test_what_lies_at_infinity_stays_in_the_map():
    image, _ = room_with_lamps(((0.8, -0.6), (0.5, 0.3), (60, 50, 40)))
    bright = split_bright_part(image, np.full((HEIGHT, WIDTH), np.inf))
    assert bright.emitters == ()


def test_one_hot_pixel_is_an_emitter_of_its_size():
    depth, _ = box_room()
    image = np.full((HEIGHT, WIDTH, 3), 0.2, np.float32)
    image[60, 300] = 5e4
    (emitter,) = split_bright_part(image, depth).emitters
    assert emitter.solid_angle == pytest.approx(equirectangular.row_solid_angles(WIDTH, HEIGHT)[60])
    assert np.isfinite(emitter.size).all()
    assert np.allclose(emitter.axes[:, 2], (0, 0, -1), atol=0.05)


def test_a_black_map_has_no_bright_part():
    depth, _ = box_room()
    bright = split_bright_part(np.zeros((HEIGHT, WIDTH, 3), np.float32), depth)
    assert (bright.emitters, bright.share) == ((), 0.0)


def test_bad_input_is_refused():
    depth, _ = box_room()
    image = np.ones((HEIGHT, WIDTH, 3), np.float32)
    with pytest.raises(ValueError, match="shape"):
        split_bright_part(image, depth[1:])
    with pytest.raises(ValueError, match="threshold is 0.5"):
        split_bright_part(image, depth, threshold=0.5)
