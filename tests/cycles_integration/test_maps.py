"""Depth, irradiance and gloss of a room against what is known in closed form."""

import numpy as np
import panoramas
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.sample_scenes import closed_room as room

DEPTH_TOLERANCE = 1e-5  # relative
AWAY_FROM_EDGES = 0.04  # [m] on the walls
IRRADIANCE_TOLERANCE = 0.02  # relative, of the mean; noise of 64 samples


def box_depth(directions, camera_height):
    """Ray distances to the inside of the closed room's shell, and how near the second plane is."""
    low, high = room.floor_corners()[0], room.floor_corners()[2]
    low, high = np.array([*low, 0.0]), np.array([*high, room.SIZE[2]])
    origin = np.array([0, 0, camera_height])
    with np.errstate(divide="ignore"):
        distances = np.maximum((low - origin) / directions, (high - origin) / directions)
    distances.sort(axis=2)
    return distances[..., 0], distances[..., 1] - distances[..., 0]


@pytest.fixture
def shell(fresh_blend, tmp_path):
    """The room without furniture, level, over a constant panorama."""
    image = panoramas.constant_panorama(tmp_path / "constant.exr", 0.7)
    scene, here = panoramas.room_place(fresh_blend, image)
    for thing in list(here.surfaces.all_objects):
        if thing.name not in ("floor", "walls"):
            fresh_blend.data.objects.remove(thing)
    return scene, here


def test_depth_of_a_box_room(shell):
    from expanded_panoramas.cycles_integration import maps

    found = maps.render_depth(*shell, 128)
    expected, to_edge = box_depth(equirectangular.pixel_directions(128, 64).astype(float), room.CAMERA_HEIGHT)
    inside = to_edge > AWAY_FROM_EDGES
    assert inside.mean() > 0.9
    assert np.abs(found.depth / expected - 1)[inside].max() < DEPTH_TOLERANCE
    assert found.coverage == pytest.approx(1)
    assert np.array_equal(
        found.is_support[inside],
        (equirectangular.pixel_directions(128, 64)[..., 2] * expected < -room.CAMERA_HEIGHT + 1e-3)[inside],
    )


def test_depth_is_infinite_where_nothing_is(fresh_blend, shell):
    from expanded_panoramas.cycles_integration import maps

    scene, here = shell
    fresh_blend.data.objects.remove(fresh_blend.data.objects["walls"])
    found = maps.render_depth(scene, here, 64)
    assert np.isinf(found.depth[:16]).all()
    assert np.isfinite(found.depth[-1]).all()
    assert 0 < found.coverage < 0.5


def test_a_place_without_surfaces_is_refused(fresh_blend, shell):
    from expanded_panoramas.cycles_integration import maps

    scene, here = shell
    for thing in list(here.surfaces.all_objects):
        fresh_blend.data.objects.remove(thing)
    with pytest.raises(ValueError, match="no surfaces"):
        maps.render_depth(scene, here, 64)


def test_irradiance_in_a_uniform_room_is_its_radiance(shell):
    """Radiance L from everywhere gives E = π·L, with other real surfaces in the light."""
    from expanded_panoramas.cycles_integration import lookup, maps, world

    scene, here = shell
    lookup.build_lookup(here)
    world.build_world(scene, here)
    irradiance = maps.render_irradiance(scene, here, 64, 64)
    assert irradiance.mean() == pytest.approx(0.7, rel=IRRADIANCE_TOLERANCE)


def test_gloss_of_a_mirror_floor_is_what_it_mirrors(shell, fresh_blend):
    """A perfectly smooth floor of reflectivity ¼ in a uniform room adds a quarter of its radiance."""
    from expanded_panoramas.cycles_integration import lookup, maps, world

    scene, here = shell
    lookup.build_lookup(here)
    world.build_world(scene, here)
    assert maps.render_gloss(scene, here, 32, 4) is None
    floor = fresh_blend.data.objects["floor"]
    floor.panorama_reflectivity, floor.panorama_roughness = 0.25, 0.0
    gloss = maps.render_gloss(scene, here, 32, 4)
    assert gloss[-1].mean() == pytest.approx(0.7 / 4, rel=0.01)
    assert gloss[0].max() < 1e-3


def test_what_no_surface_covers_lights_from_infinity(shell, fresh_blend):
    """A floor alone under a uniform sky: E = π·L, and the World's part of the map is what has no depth."""
    from expanded_panoramas.cycles_integration import blender_images, preparation

    scene, here = shell
    fresh_blend.data.objects.remove(fresh_blend.data.objects["walls"])
    preparation.prepare(scene)
    sky = blender_images.array_from_image(here.sky)
    assert np.allclose(sky[:7], 0.7)
    assert np.allclose(sky[-1], 0)
    irradiance = blender_images.array_from_image(here.irradiance)
    assert irradiance[-2:].mean() == pytest.approx(0.7, rel=IRRADIANCE_TOLERANCE)


def test_the_light_of_a_lamp_is_kept_when_it_becomes_a_light(fresh_blend, tmp_path, monkeypatch):
    """Irradiance of the room with the lamp in the map, and with the lamp taken out of it."""
    from expanded_panoramas.cycles_integration import blender_images, preparation

    monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 64)
    image = np.full((128, 256, 3), 0.3, np.float32)
    image[20:26, 60:72] = (90, 60, 30)
    scene, here = panoramas.room_place(fresh_blend, panoramas.write_panorama(tmp_path / "lamp.exr", image))
    found = []
    for most_lights in (0, None):
        prepared = preparation.prepare(scene, most_lights)
        found.append(blender_images.array_from_image(here.irradiance)[16:].mean(axis=(0, 1)))
    assert prepared.at_depth.count >= 1
    assert found[0][0] > 1.2 * found[0][2]
    assert np.allclose(found[1], found[0], rtol=0.06)  # the plain map's own noise
