"""Outlines cover the pixels they were drawn round: anywhere on the sphere, of any shape, on tilted planes."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.light.flat_parts import Part, flat_parts, surface_normals
from expanded_panoramas.ibl_toolkit.light.outline import LIFT, outlines_of_part, solid_angle_of_outline

WIDTH, HEIGHT = 512, 256
PIXEL = np.pi / HEIGHT  # [rad]
AREA = 0.05  # relative, of regions of a few hundred pixels
ROUGH_AREA = 0.3  # of a few pixels
EXACT = 1e-6


def axes_of(direction):
    """Two unit vectors across a direction, and itself."""
    direction = np.array(direction, float) / np.linalg.norm(direction)
    side = np.cross((0, 0, 1) if abs(direction[2]) < 0.9 else (1, 0, 0), direction)
    side /= np.linalg.norm(side)
    return side, np.cross(direction, side), direction


def part_of(mask, normal=None, distance=2.0):
    """The part of a mask of pixels that lie in the plane through the middle, of a normal or facing it."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).reshape(-1, 3).astype(float)
    pixels = np.flatnonzero(mask)
    middle = directions[pixels].mean(axis=0)
    middle /= np.linalg.norm(middle)
    normal = -middle if normal is None else np.array(normal) / np.linalg.norm(normal)
    depth = distance * (middle @ normal) / (directions[pixels] @ normal)
    solid_angles = np.repeat(equirectangular.row_solid_angles(WIDTH, HEIGHT), WIDTH)[pixels]
    points = directions[pixels] * depth[:, None]
    return Part(pixels, points, np.tile(normal, (len(pixels), 1)), solid_angles)


def tangent(direction):
    """Positions (H, W) of the pixels on the plane before a direction at distance 1, two axes; inf behind."""
    side, up, middle = axes_of(direction)
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    ahead = directions @ middle
    with np.errstate(divide="ignore", invalid="ignore"):
        return tuple(np.where(ahead > 0.1, directions @ axis / ahead, np.inf) for axis in (side, up))


def disc(direction, radius=0.15):
    x, y = tangent(direction)
    return np.hypot(x, y) < radius


def l_shape(direction, size=0.4):
    x, y = tangent(direction)
    square = (np.abs(x) < size / 2) & (np.abs(y) < size / 2)
    return square & ~((x > -size / 8) & (y > -size / 8))


def solid_angle(outlines):
    return sum(map(solid_angle_of_outline, outlines))


def turns(outline, normal):
    """Area of a polygon about a normal: positive where counter-clockwise."""
    return np.cross(outline, np.roll(outline, -1, axis=0)).sum(axis=0) @ normal / 2


PLACES = {
    "ahead": (1, 0, 0),
    "on the seam": (-1, 0.001, 0),
    "zenith": (0, 0, 1),
    "nadir": (0.02, 0.03, -1),
    "beside a pole": (0.2, 0, 1),
    "slanting": (0.6, -0.7, 0.4),
}


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("shape", [disc, l_shape])
def test_area_is_kept(place, shape):
    mask = shape(place)
    part = part_of(mask)
    (outline,) = outlines_of_part(part, WIDTH, HEIGHT)
    assert solid_angle_of_outline(outline) == pytest.approx(part.solid_angles.sum(), rel=AREA)
    _, normal = part.plane()
    assert turns(outline, normal) > 0  # counter-clockwise as seen from the origin
    assert len(outline) < 40


def test_a_concave_part_stays_concave():
    """The notch of an L is not filled: the middle of what is missing lies outside of the outline."""
    part = part_of(l_shape((1, 0, 0)))
    (outline,) = outlines_of_part(part, WIDTH, HEIGHT)
    side, up, middle = axes_of((1, 0, 0))
    position = np.stack([outline @ side, outline @ up], axis=1) / (outline @ middle)[:, None]
    notch, corner = np.array([0.12, 0.12]), np.array([-0.12, -0.12])
    assert winding(position, notch) == 0
    assert abs(winding(position, corner)) == 1


def winding(polygon, point):
    """How many times a polygon (k, 2) runs round a point."""
    angles = np.arctan2(*(polygon - point).T[::-1])
    steps = np.diff(angles, append=angles[0])
    return round(float(((steps + np.pi) % (2 * np.pi) - np.pi).sum() / (2 * np.pi)))


@pytest.mark.parametrize("normal", [(-1, 0.8, 0), (-0.5, 0, -1), (-1, -0.3, 0.4)])
def test_outlines_lie_in_the_plane_a_little_before_it(normal):
    part = part_of(disc((1, 0, 0)), normal)
    (outline,) = outlines_of_part(part, WIDTH, HEIGHT)
    middle, found = part.plane()
    assert np.allclose(found, np.array(normal) / np.linalg.norm(normal), atol=EXACT)
    assert np.allclose(outline @ found, (middle @ found) * (1 - LIFT), atol=EXACT)
    assert solid_angle_of_outline(outline) == pytest.approx(part.solid_angles.sum(), rel=AREA)


@pytest.mark.parametrize("row", [0, 1, HEIGHT // 3, HEIGHT // 2, HEIGHT - 1])
def test_one_pixel(row):
    """An outline of about its size and place, at a pole, where pixels are needles, too."""
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask[row, 100] = True
    part = part_of(mask)
    outlines = outlines_of_part(part, WIDTH, HEIGHT)
    assert outlines
    middle = np.mean(np.concatenate(outlines), axis=0)
    towards = part.points[0] / np.linalg.norm(part.points[0])
    assert middle @ towards > np.cos(PIXEL) * np.linalg.norm(middle)
    if 1 < row < HEIGHT - 1:
        assert solid_angle(outlines) == pytest.approx(part.solid_angles.sum(), rel=ROUGH_AREA)
    else:
        assert 0.2 < solid_angle(outlines) / part.solid_angles.sum() < 5


def test_two_pieces_of_one_plane_have_an_outline_each():
    """And what is negligible beside them has none."""
    mask = disc((1, 0.3, 0), 0.12) | disc((1, -0.3, 0), 0.12) | disc((1, 0, 0.35), 1.2 * PIXEL)
    part = part_of(mask, normal=(-1, 0, 0))
    outlines = outlines_of_part(part, WIDTH, HEIGHT)
    assert len(outlines) == 2
    assert solid_angle(outlines) == pytest.approx(part.solid_angles.sum(), rel=AREA)


def test_solid_angles():
    """A square at distance 1, by 4·asin(a²/(a²+1)) for half side a; a cap, by 2π(1 − cos r)."""
    for half in (0.1, 1.0, 5.0):
        square = np.array([(1, -half, -half), (1, half, -half), (1, half, half), (1, -half, half)])
        expected = 4 * np.arcsin(half**2 / (half**2 + 1))
        assert solid_angle_of_outline(square) == pytest.approx(expected)
        assert solid_angle_of_outline(square[::-1] * 7) == pytest.approx(expected)
    angles = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    circle = np.stack(
        [np.full(1000, np.cos(0.7)), *(np.sin(0.7) * np.array([np.cos(angles), np.sin(angles)]))], 1
    )
    assert solid_angle_of_outline(circle) == pytest.approx(2 * np.pi * (1 - np.cos(0.7)), rel=1e-4)


def box_samples(mask, half_sizes=(2.0, 2.0, 1.2)):
    """The part of pixels on the inside of a box."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    with np.errstate(divide="ignore"):
        points = directions * np.min(np.array(half_sizes) / np.abs(directions), axis=2)[..., None]
    normals = surface_normals(points).reshape(-1, 3)
    solid_angles = np.repeat(equirectangular.row_solid_angles(WIDTH, HEIGHT), WIDTH)
    pixels = np.flatnonzero(mask)
    return Part(pixels, points.reshape(-1, 3)[pixels], normals[pixels], solid_angles[pixels])


def test_a_region_in_a_corner_of_three_walls_becomes_three_parts():
    samples = box_samples(disc((2, 2, 1.2), 0.25))
    parts = flat_parts(samples)
    assert sorted(np.concatenate([part.pixels for part in parts]).tolist()) == samples.pixels.tolist()
    large = [part for part in parts if part.solid_angles.sum() > 0.05 * samples.solid_angles.sum()]
    normals = np.array([part.plane()[1] for part in large])
    assert len(large) == 3
    assert np.allclose(np.sort(np.abs(normals), axis=1), (0, 0, 1), atol=0.05)


def test_a_long_tube_is_cut_and_a_small_square_is_not():
    def strip(length):
        directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
        at_ceiling = directions * (1.2 / np.maximum(directions[..., 2:], 1e-9))
        return (np.abs(at_ceiling[..., 0]) < 0.1) & (np.abs(at_ceiling[..., 1] - 0.5) < length / 2)

    assert len(flat_parts(box_samples(strip(0.3)))) == 1
    parts = flat_parts(box_samples(strip(2.8)))
    assert len(parts) > 1
    assert all(np.ptp(part.points[:, 1]) < 1.3 * np.linalg.norm(part.plane()[0]) for part in parts)


def test_surface_normals_at_an_edge_belong_to_one_of_its_walls():
    """Never to the mean of two: the neighbour at the nearer distance decides."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    points = directions * np.min(np.array((2, 2, 1.2)) / np.abs(directions), axis=2)[..., None]
    normals = surface_normals(points)[2:-2]
    assert (np.sum(normals * points[2:-2], axis=2) < 0).all()  # towards the origin
    straight = np.abs(normals).max(axis=2) > 0.98
    assert straight.mean() > 0.97
