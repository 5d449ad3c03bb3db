"""Lamps on the surfaces of a room light as the map does that they were taken from: E in closed form."""

import numpy as np
import pytest
import small_scenes
from box_room import (
    HEIGHT,
    HIGH,
    LAMP,
    LAMP_RADIANCE,
    LAMP_SIZE,
    LOW,
    TURNS,
    WALL_RADIANCE,
    WIDTH,
    add_surface,
    box_points,
    box_room,
    lamp_map,
    on_ceiling,
    prepare,
)
from mathutils import Vector

from expanded_panoramas.ibl_toolkit import equirectangular

SIGMAS = 4.5  # of the mean of 64 pixels, in three channels
PLAIN_NOISE = 0.02  # relative, of the mean of 512 samples
LAMP_SHAPE = 0.0075  # relative irradiance: outlines follow pixels of 2 cm
NEAR = 0.04  # relative, 5 cm before a lamp of 40 cm that is 20 pixels wide


def irradiance(image, point, normal):
    """E (3,) in closed form, direct, of the map on the box room's walls, at a point of the panorama frame.

    A pixel sends M·cosθ_wall·dA·cosθ/r², where dA = z²dω/cosθ_seen.
    """
    points, normals = box_points()
    solid_angles = equirectangular.row_solid_angles(WIDTH, HEIGHT)[:, None]
    squared = (points**2).sum(axis=2)
    area = solid_angles * squared / (-(points * normals).sum(axis=2) / np.sqrt(squared))
    to_wall = points - point
    distance = np.linalg.norm(to_wall, axis=2)
    cosines = np.maximum(to_wall @ normal, 0) * np.maximum(-(to_wall * normals).sum(axis=2), 0) / distance**2
    return np.einsum("ij,ijk->k", area * cosines / distance**2, image)


def lit_plane(bpy, scene, here, point, normal=(0, 0, 1), size=0.04):
    """A small white diffuse square at a point of the panorama frame, which fills the camera's view."""
    frame = here.origin.matrix_world
    point, normal = frame @ Vector(point), frame.to_3x3() @ Vector(normal)
    matte = small_scenes.material(small_scenes.DIFFUSE)
    plane = small_scenes.add_plane(scene, matte, 2 * size, point, normal)
    camera = small_scenes.add_camera(scene, point + 0.02 * normal, point, width=size)
    return plane, camera


def rendered_irradiance(bpy, scene, here, folder, point, samples, normal=(0, 0, 1)):
    """E (3,) at a point by a render, and the error of its mean."""
    plane, camera = lit_plane(bpy, scene, here, point, normal)
    picture = small_scenes.render(scene, folder / "lit.exr", (8, 8), samples).reshape(-1, 3)
    for thing in (plane, camera):
        bpy.data.objects.remove(thing)
    return np.pi * picture.mean(axis=0), np.pi * picture.std(axis=0) / 8


def assert_lit(found, expected, tolerance):
    """A rendered (E, its error) is what it should be."""
    values, errors = found
    assert (np.abs(values - expected) < SIGMAS * errors + tolerance * expected).all(), values / expected
    assert (errors < tolerance * expected).all(), errors / expected


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_direct_light_is_the_maps(fresh_blend, tmp_path, turn):
    """Below the lamp and beside it; the plain map's light is the same, with far more noise."""
    image = lamp_map()
    scene, here = box_room(fresh_blend, tmp_path, image, turn)
    below, beside = (1.0, -0.3, -0.5), (-1.2, 1.0, 0.2)
    for most, samples, point, tolerance in (
        (0, 512, below, PLAIN_NOISE),
        (None, 64, below, LAMP_SHAPE),
        (None, 64, beside, LAMP_SHAPE),
    ):
        assert prepare(scene, most).at_depth.count == (most is None)
        found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, samples)
        assert_lit(found, irradiance(image, point, (0, 0, 1)), tolerance)


def bent_lamp():
    """A strip over the edge of ceiling and wall."""
    image, (points, _) = lamp_map(), box_points()
    image[:] = WALL_RADIANCE
    image[(np.abs(points[..., 1]) < 0.3) & (points[..., 0] > 1.6) & (points[..., 2] > 0.8)] = 40
    return image


def hot_pixel():
    image = np.full((HEIGHT, WIDTH, 3), WALL_RADIANCE, np.float32)
    image[70, 300] = 2e4
    return image


@pytest.mark.parametrize(
    ("make", "least"),
    [
        (bent_lamp, 2),
        (hot_pixel, 1),
        (lambda: lamp_map(((-1.5, 0.0), 0.3, (40, 60, 80)), ((0.0, 0.0), 0.3, (30, 30, 30))), 2),
    ],
    ids=["bent", "hot pixel", "on the seam and at the zenith"],
)
def test_lamps_of_other_shapes_light_as_the_map(fresh_blend, tmp_path, make, least):
    image = make()
    scene, here = box_room(fresh_blend, tmp_path, image)
    assert prepare(scene).at_depth.count >= least
    for point, normal in (((0.2, 0.5, -0.8), (0, 0, 1)), ((-0.5, -0.8, 0.0), (0.6, 0, 0.8))):
        found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, 64, normal)
        assert_lit(found, irradiance(image, point, normal), 2 * LAMP_SHAPE)


def test_a_plane_nearer_to_a_lamp_than_its_size(fresh_blend, tmp_path):
    """5 cm before a lamp of 40 cm, at its middle and at its rim."""
    image = lamp_map()
    scene, here = box_room(fresh_blend, tmp_path, image)
    prepare(scene)
    for x in (LAMP[0], LAMP[0] + LAMP_SIZE / 2):
        point = (x, LAMP[1], HIGH[2] - 0.05)
        found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, 64)
        assert_lit(found, irradiance(image, point, (0, 0, 1)), NEAR)


def test_a_lamp_half_hidden_by_a_real_board(fresh_blend, tmp_path):
    """The half that the panorama saw shines, from behind the board's edge; the board shades it."""
    image, (points, _) = lamp_map(), box_points()
    with np.errstate(divide="ignore", invalid="ignore"):
        on_board = points * (0.9 / points[..., 2:])
    hidden = (points[..., 2] > 0.9) & (on_board[..., 0] > 0.2) & (on_board[..., 0] < 0.75)
    image[hidden & (np.abs(on_board[..., 1]) < 1.2)] = WALL_RADIANCE
    scene, here = box_room(fresh_blend, tmp_path, image)
    add_surface(
        fresh_blend, scene, here, [(0.2, -1.2, 0.9), (0.75, -1.2, 0.9), (0.75, 1.2, 0.9), (0.2, 1.2, 0.9)]
    )
    assert prepare(scene).at_depth.count == 1
    (lamp,) = here.lights.objects
    corners = np.array([vertex.co for vertex in lamp.data.vertices])
    assert np.allclose(corners[:, 2], HIGH[2], atol=0.01)
    assert corners[:, 0].min() == pytest.approx(LAMP[0], abs=0.03)
    sees, shaded = (1.5, -0.3, -0.2), (-1.0, -0.3, -0.2)
    found = rendered_irradiance(fresh_blend, scene, here, tmp_path, sees, 64)
    assert_lit(found, irradiance(image, sees, (0, 0, 1)), 2 * LAMP_SHAPE)
    found = rendered_irradiance(fresh_blend, scene, here, tmp_path, shaded, 64)
    assert found[0] == pytest.approx(np.pi * WALL_RADIANCE, rel=0.01)


def test_where_depth_is_missing_the_lamp_shines_from_infinity(fresh_blend, tmp_path):
    """Half of the ceiling is not rebuilt; each lamp lights once, from where it is known to be."""
    far = (-1.0, 0.3)
    image = lamp_map((LAMP, LAMP_SIZE, LAMP_RADIANCE), (far, LAMP_SIZE, LAMP_RADIANCE))
    scene, here = box_room(fresh_blend, tmp_path, image, without=HIGH[2])
    (x, y, z), (_, low, _) = HIGH, LOW
    add_surface(fresh_blend, scene, here, [(0, low, z), (x, low, z), (x, y, z), (0, y, z)])
    prepared = prepare(scene, 8)
    assert prepared.at_depth.count == 1
    assert prepared.at_infinity.count  # for another method: these suns do not shine here
    assert prepared.coverage < 0.95
    point = np.array([0.8, 0.0, -0.5])
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    points, _ = box_points()
    is_far = on_ceiling(points, far)
    weights = np.where(is_far, np.maximum(directions[..., 2], 0), 0)
    weights *= equirectangular.row_solid_angles(WIDTH, HEIGHT)[:, None]
    at_infinity = np.einsum("ij,ijk->k", weights, image - WALL_RADIANCE)
    expected = irradiance(np.where(is_far[..., None], WALL_RADIANCE, image), point, (0, 0, 1)) + at_infinity
    found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, 256)
    assert_lit(found, expected, 2 * LAMP_SHAPE)
