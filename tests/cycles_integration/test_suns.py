"""Suns light, and are mirrored, as the map does that they were taken from."""

from types import SimpleNamespace

import numpy as np
import panoramas
import pytest
import small_scenes

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector

WIDTH, HEIGHT = 256, 128
LAMPS = (((0.5, 0.3, 0.8), 0.10, (30, 25, 20)), ((-0.6, -0.4, 0.7), 0.06, (30, 45, 60)))
"""Direction, radius [rad] and radiance at the middle."""
TURNS = {"level": np.eye(3), "tilted": rotation_from_vector([0.3, -0.2, 1.1])}
SIGMAS = 4.5  # of the mean of 64 pixels, in three channels
CLOSED_FORM = 5e-4  # relative: the look-up between pixels
ERROR = 0.005  # relative, of the mean: else the test above sees nothing
QUIETER = 0.5  # of the plain map's noise
SAME = 2e-4  # of radiance, where both pictures show the photograph: float32 rounding of directions
ROUNDING = 1e-5  # of sums in another order
GLOSSY_MEAN = 0.01  # relative
ANGLE = 0.15  # relative, of lamps of a few pixels


def lamp_map():
    """Two lamps, brighter on one side than on the other, in a dark map with a slope."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT)
    image = 0.02 + 0.01 * directions
    for direction, radius, radiance in LAMPS:
        direction = np.array(direction) / np.linalg.norm(direction)
        pixels = directions @ direction > np.cos(radius)
        across = directions[pixels] @ np.cross(direction, (0, 0, 1)) / radius
        image[pixels] = np.array(radiance) * (1 + 0.25 * across[:, None])
    return image.astype(np.float32)


def place_of_map(bpy, folder, image=None, turn=TURNS["tilted"], name="map"):
    """The scene with a place without surfaces."""
    from expanded_panoramas.cycles_integration import place

    path = panoramas.write_panorama(folder / f"{name}.exr", lamp_map() if image is None else image)
    calibration = SimpleNamespace(world_from_panorama=turn, camera_height=1.5)
    here = place.create_place(bpy.context.scene, str(path), calibration)
    bpy.context.view_layer.update()
    return bpy.context.scene, here


def with_most(scene, here, most):
    """Make that many suns at most; what Cycles aims at the plain map with is no finer than it needs."""
    from expanded_panoramas.cycles_integration import preparation

    lights = preparation.prepare_suns(scene, here, most)
    if not lights.count:
        scene.world.cycles.sampling_method, scene.world.cycles.sample_map_resolution = "MANUAL", 2 * WIDTH
    return lights


def pictures(scene, here, folder, size, samples):
    """Of the plain map, and with suns."""
    found = []
    for most in (0, 8):
        assert bool(with_most(scene, here, most).count) == bool(most)
        found.append(small_scenes.render(scene, folder / f"{most}.exr", size, samples))
    return found


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_irradiance_on_a_plane_is_the_maps(fresh_blend, tmp_path, turn):
    """White and diffuse, its radiance is ∫ M cosθ dω / π; with suns, and without."""
    scene, here = place_of_map(fresh_blend, tmp_path, turn=turn)
    normal = np.array([0.2, -0.1, 1]) / np.linalg.norm([0.2, -0.1, 1])
    small_scenes.add_plane(scene, small_scenes.material(small_scenes.DIFFUSE), 2, normal=normal)
    small_scenes.add_camera(scene, normal, (0, 0, 0), width=1)
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    weights = np.maximum(directions @ (turn.T @ normal), 0)
    weights *= equirectangular.row_solid_angles(WIDTH, HEIGHT)[:, None] / np.pi
    expected = np.einsum("ij,ijk->k", weights, lamp_map())
    for picture in pictures(scene, here, tmp_path, (8, 8), 256):
        pixels = picture.reshape(-1, 3)
        error = pixels.std(axis=0) / np.sqrt(len(pixels))
        assert (np.abs(pixels.mean(axis=0) - expected) < SIGMAS * error + CLOSED_FORM * expected).all()
        assert (error < ERROR * expected).all()


def test_the_sky_is_the_photograph(fresh_blend, tmp_path):
    scene, here = place_of_map(fresh_blend, tmp_path)
    lamp = TURNS["tilted"] @ LAMPS[0][0]
    small_scenes.add_camera(scene, (0, 0, 0), lamp * 2, field_of_view=1.0)
    plain, with_suns = pictures(scene, here, tmp_path, (32, 32), 4)
    assert plain.max() > 30
    assert np.abs(with_suns - plain).max() < SAME


def looked_into(bpy, scene, finish):
    """A mirror or glass ball, and a camera that finds both lamps in it."""
    if finish == "mirror":
        small_scenes.add_ball(scene, small_scenes.mirror(), 1)
        small_scenes.add_camera(scene, (0, 0, 4), (0, 0, 0), width=2.1)
    else:
        glass = small_scenes.material(small_scenes.GLASS, Roughness=0.0, IOR=1.3)
        small_scenes.add_ball(scene, glass, 1)
        small_scenes.add_camera(scene, (0, 0, -4), (0, 0, 0), width=2.1)


@pytest.mark.parametrize("finish", ["mirror", "glass"])
def test_mirror_and_glass_show_the_photograph(fresh_blend, tmp_path, finish):
    """Inside the lamps, at their rims and beside them: the same at every pixel as without suns."""
    scene, here = place_of_map(fresh_blend, tmp_path)
    looked_into(fresh_blend, scene, finish)
    plain, with_suns = pictures(scene, here, tmp_path, (48, 48), 4)
    assert (plain.mean(axis=2) > 5).sum() > 7
    assert np.abs(with_suns - plain).max() < SAME * plain.max()


def test_a_mirror_shows_an_uneven_lamp_as_it_is(fresh_blend, tmp_path):
    """A bright core in a wide glow: the disc that stands for both is like neither."""
    image = np.full((HEIGHT, WIDTH, 3), 0.01, np.float32)
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT)
    for radius, radiance in ((0.2, 3), (0.06, 60)):
        image[directions[..., 2] > np.cos(radius)] = radiance
    scene, here = place_of_map(fresh_blend, tmp_path, image, TURNS["level"])
    small_scenes.add_plane(scene, small_scenes.mirror(), 2)
    small_scenes.add_camera(scene, (0.1, 0, 1), (0.1, 0, 0), width=0.1)
    scene.camera.data.type, scene.camera.data.angle = "PERSP", 0.6
    plain, with_suns = pictures(scene, here, tmp_path, (32, 32), 4)
    assert plain.max() > 50
    assert np.abs(with_suns - plain).max() < SAME * plain.max()


def test_a_rough_ball_reflects_no_more_and_no_less(fresh_blend, tmp_path):
    """What Cycles aims at and what glossy rays meet are weighed against each other, not added up."""
    scene, here = place_of_map(fresh_blend, tmp_path)
    rough = small_scenes.material(small_scenes.GLOSSY, Roughness=0.3)
    small_scenes.add_ball(scene, rough, 1)
    small_scenes.add_camera(scene, (0, 0, 4), (0, 0, 0), width=1.8)
    plain, with_suns = pictures(scene, here, tmp_path, (32, 32), 128)
    assert with_suns.mean(axis=(0, 1)) == pytest.approx(plain.mean(axis=(0, 1)), rel=GLOSSY_MEAN)


def test_suns_are_quieter_than_the_plain_map(fresh_blend, tmp_path):
    """Else they would be of no use."""
    scene, here = place_of_map(fresh_blend, tmp_path)
    small_scenes.add_plane(scene, small_scenes.material(small_scenes.DIFFUSE), 2)
    small_scenes.add_camera(scene, (0, 0, 1), (0, 0, 0), width=1)
    plain, with_suns = pictures(scene, here, tmp_path, (16, 16), 16)
    assert (with_suns.std(axis=(0, 1)) < QUIETER * plain.std(axis=(0, 1))).all()


def test_none_is_the_plain_map_again(fresh_blend, tmp_path):
    """Exactly, for the same seed, also after suns were there; and nothing of them is left."""
    from expanded_panoramas.cycles_integration import world

    scene, here = place_of_map(fresh_blend, tmp_path)
    small_scenes.add_ball(scene, small_scenes.material(small_scenes.DIFFUSE), 1)
    small_scenes.add_camera(scene, (0, 0, 4), (0, 0, 0), width=2.1)
    world.build_world(scene, here, whole_map_lights=True)
    scene.world.cycles.sampling_method, scene.world.cycles.sample_map_resolution = "MANUAL", 2 * WIDTH
    never = small_scenes.render(scene, tmp_path / "never.exr", (24, 24), 8, seed=3)
    for most in (0, 8, 0):
        with_most(scene, here, most)
        again = small_scenes.render(scene, tmp_path / "again.exr", (24, 24), 8, seed=3)
        assert np.array_equal(again, never) == (most == 0)
    assert not fresh_blend.data.lights
    assert scene.world.cycles.sampling_method != "NONE"


def test_the_map_decides_and_says_why(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration import preparation

    scene, here = place_of_map(fresh_blend, tmp_path)
    lit = preparation.prepare_suns(scene, here)
    assert lit.count == len(here.suns.objects) >= len(LAMPS)
    assert 0.8 < lit.share < 0.9
    assert lit.reason == f"{lit.count} suns with {100 * lit.share:.0f} % of the light"
    overcast = np.full((HEIGHT, WIDTH, 3), 0.1, np.float32)
    overcast[: HEIGHT // 2] = 1
    scene, here = place_of_map(fresh_blend, tmp_path, overcast, name="overcast")
    left = preparation.prepare_suns(scene, here)
    assert (left.count, len(here.suns.objects), left.share) == (0, 0, 0)
    assert "left to Cycles' own sampling" in left.reason
    sunny = overcast.copy()
    sunny[30:33, 60:63] = 1000
    scene, here = place_of_map(fresh_blend, tmp_path, sunny, name="sunny")
    assert preparation.prepare_suns(scene, here).count == 0  # half of the light is the sky's
    assert preparation.prepare_suns(scene, here, 8).count == 1
    assert preparation.prepare_suns(scene, here, 0).reason == "no lights, as asked"


def test_a_map_left_alone_renders_as_the_plain_one(fresh_blend, tmp_path):
    """For the same seed: the default costs nothing where it does not help."""
    from expanded_panoramas.cycles_integration import preparation

    overcast = np.full((HEIGHT, WIDTH, 3), 0.1, np.float32)
    overcast[: HEIGHT // 2] = 1
    scene, here = place_of_map(fresh_blend, tmp_path, overcast)
    small_scenes.add_ball(scene, small_scenes.material(small_scenes.DIFFUSE), 1)
    small_scenes.add_camera(scene, (0, 0, 4), (0, 0, 0), width=2.1)
    plain, left_alone = (
        (
            preparation.prepare_suns(scene, here, most),
            small_scenes.render(scene, tmp_path / "p.exr", (24, 24), 8),
        )
        for most in (0, None)
    )
    assert left_alone[0].count == 0
    assert np.abs(left_alone[1] - plain[1]).max() < ROUNDING


def test_no_more_than_asked_for_the_strongest(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration import preparation

    scene, here = place_of_map(fresh_blend, tmp_path)
    lights = preparation.prepare_suns(scene, here, 1)
    (sun,) = here.suns.objects
    fresh_blend.context.view_layer.update()
    strongest = TURNS["tilted"] @ LAMPS[0][0] / np.linalg.norm(LAMPS[0][0])
    assert lights.reason.startswith("1 sun with")
    assert np.array(sun.matrix_world)[:3, 2] @ strongest > np.cos(0.02)
    assert sun.data.angle == pytest.approx(2 * LAMPS[0][1], rel=ANGLE)


def test_suns_turn_with_the_origin(fresh_blend, tmp_path):
    """After the preparation, too: suns, their pictures and the World."""
    from expanded_panoramas.cycles_integration.place import set_calibration

    scene, here = place_of_map(fresh_blend, tmp_path, turn=np.eye(3))
    looked_into(fresh_blend, scene, "mirror")
    small_scenes.add_plane(scene, small_scenes.material(small_scenes.DIFFUSE), 0.4, location=(0.85, 0.85, 0))
    with_most(scene, here, 8)
    set_calibration(here, TURNS["tilted"], 1.5)
    turned = small_scenes.render(scene, tmp_path / "turned.exr", (32, 32), 8)
    with_most(scene, here, 8)
    anew = small_scenes.render(scene, tmp_path / "anew.exr", (32, 32), 8)
    assert np.abs(turned - anew).max() < SAME * anew.max()
    set_calibration(here, np.eye(3), 1.5)
    assert np.abs(small_scenes.render(scene, tmp_path / "back.exr", (32, 32), 8) - anew).max() > 1


def test_two_scenes_do_not_share_suns(fresh_blend, tmp_path):
    first, here = place_of_map(fresh_blend, tmp_path)
    with_most(first, here, 8)
    mine = set(here.suns.objects), here.sun_quiet, first.world
    fresh_blend.context.window.scene = fresh_blend.data.scenes.new("other")
    second, there = place_of_map(fresh_blend, tmp_path, turn=TURNS["level"])
    with_most(second, there, 1)
    assert (set(here.suns.objects), here.sun_quiet, first.world) == mine
    assert not set(there.suns.objects) & mine[0]
    assert there.sun_quiet != mine[1]
    assert second.world != mine[2]
    assert not set(second.objects) & mine[0]
    with_most(second, there, 0)
    assert (set(here.suns.objects), here.sun_quiet) == mine[:2]


def test_preparing_again_leaves_nothing_behind(fresh_blend, tmp_path):
    def data_blocks():
        return {
            kind: len(getattr(fresh_blend.data, kind)) for kind in ("objects", "lights", "images", "worlds")
        }

    scene, here = place_of_map(fresh_blend, tmp_path)
    with_most(scene, here, 0)
    plain = data_blocks()
    with_most(scene, here, 8)
    once = data_blocks()
    with_most(scene, here, 8)
    assert data_blocks() == once != plain
    with_most(scene, here, 0)
    assert data_blocks() == plain
