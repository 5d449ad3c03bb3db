"""Lamps of a room: seen and mirrored as the photograph, without white dots, and leaving nothing behind."""

import numpy as np
import pytest
import small_scenes
from box_room import HEIGHT, HIGH, LAMP, TURNS, WIDTH, box_room, lamp_map, prepare
from mathutils import Vector

MIRRORED, RIM_PIXELS = 0.005, 0.03  # of the brightest radiance; share of pixels that may differ more
GLOSSY_MEAN = 0.02  # relative; the plain picture's mean has a noise of 0.5 %
WHITE_DOT = 10  # times the median of its neighbours
BESIDE, BELOW = (0.0, 1.1, 0.2), (0.0, 0.01, -0.8)
"""Places of the camera, from a ball near the lamp [m]."""


def pictures(bpy, scene, folder, material, size, samples, eye=BESIDE):
    """Of a ball near the lamp, plain and with lamps; ``eye`` is the camera's place from the ball."""
    ball = small_scenes.add_ball(scene, material, 0.2, (LAMP[0], LAMP[1] - 0.3, 1.0))
    small_scenes.add_camera(scene, ball.location + Vector(eye), ball.location, width=0.36)
    found = []
    for most in (0, None):
        prepare(scene, most)
        found.append(small_scenes.render(scene, folder / "ball.exr", size, samples))
    return found


@pytest.mark.parametrize("finish", ["mirror", "glass"])
def test_mirror_and_glass_show_the_photograph(fresh_blend, tmp_path, finish):
    """But for pixels at the lamp's rim: it stands a little before the ceiling, with straight edges."""
    scene, _ = box_room(fresh_blend, tmp_path, lamp_map(slope=0.3))
    glass = small_scenes.material(small_scenes.GLASS, Roughness=0.0, IOR=1.3)
    material = small_scenes.mirror() if finish == "mirror" else glass
    eye = BESIDE if finish == "mirror" else BELOW
    plain, with_lamps = pictures(fresh_blend, scene, tmp_path, material, (48, 48), 4, eye)
    assert (plain.max(axis=2) > 30).sum() > 5
    differs = np.abs(with_lamps - plain).max(axis=2) > MIRRORED * plain.max()
    assert differs.mean() < RIM_PIXELS
    assert with_lamps.mean() == pytest.approx(plain.mean(), rel=0.005)


def test_a_rough_ball_reflects_no_more_and_no_less(fresh_blend, tmp_path):
    """What Cycles aims at and what glossy rays meet are weighed against each other, not added up."""
    scene, _ = box_room(fresh_blend, tmp_path, lamp_map((LAMP, 0.8, (15, 12, 10))))
    rough = small_scenes.material(small_scenes.GLOSSY, Roughness=0.4)
    plain, with_lamps = pictures(fresh_blend, scene, tmp_path, rough, (24, 24), 256)
    assert with_lamps.mean(axis=(0, 1)) == pytest.approx(plain.mean(axis=(0, 1)), rel=GLOSSY_MEAN)


def white_dots(picture):
    """How many pixels are far above the median of those around them."""
    grey = picture.mean(axis=2)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(grey, 1, mode="edge"), (3, 3))
    return int((grey > WHITE_DOT * np.median(around, axis=(2, 3))).sum())


def test_no_white_dots(fresh_blend, tmp_path):
    """A lamp of 10 cm at 16 samples: the plain map has dots."""
    scene, _ = box_room(fresh_blend, tmp_path, lamp_map((LAMP, 0.1, (900, 750, 600))))
    small_scenes.add_plane(scene, small_scenes.material(small_scenes.DIFFUSE), 3, (0, 0, 0.5))
    small_scenes.add_camera(scene, (-1.5, -1.5, 2), (0, 0, 0.5), field_of_view=1.0)
    dots = []
    for most in (0, None):
        prepare(scene, most)
        dots.append(white_dots(small_scenes.render(scene, tmp_path / "dots.exr", (48, 36), 16)))
    assert dots[0] > 3
    assert dots[1] == 0


def test_none_is_the_plain_map_again(fresh_blend, tmp_path):
    """Exactly, for the same seed, also after lamps were there; and nothing of them is left."""
    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    matte = small_scenes.material(small_scenes.DIFFUSE)
    small_scenes.add_ball(scene, matte, 0.2, (0.5, 0, 1))
    small_scenes.add_camera(scene, (0.5, -1, 1), (0.5, 0, 1), width=0.5)
    found = []
    for most in (0, None, 0):
        prepared = prepare(scene, most)
        found.append(small_scenes.render(scene, tmp_path / "again.exr", (24, 24), 8))
    assert np.array_equal(found[0], found[2])
    assert not np.array_equal(found[0], found[1])
    assert (prepared.at_depth.count, prepared.at_depth.reason) == (0, "no lights, as asked")
    assert not here.lights.objects
    assert here.residual is None


def test_lamps_are_not_in_the_depth_map(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration import maps

    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene, 0)
    before = maps.render_depth(scene, here, 128).depth
    prepare(scene)
    assert here.lights.objects
    assert np.array_equal(maps.render_depth(scene, here, 128).depth, before)


def test_lamps_turn_with_the_origin(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration.place import set_calibration

    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene)
    (lamp,) = here.lights.objects
    set_calibration(here, TURNS["tilted"], 2.0)
    fresh_blend.context.view_layer.update()
    middle = np.mean([lamp.matrix_world @ vertex.co for vertex in lamp.data.vertices], axis=0)
    assert middle == pytest.approx(TURNS["tilted"] @ (*LAMP, HIGH[2]) + (0, 0, 2.0), abs=0.03)


def test_lamps_are_neither_real_nor_new_objects(fresh_blend, tmp_path):
    """The artist's roles, and the sorting by them, leave them where they are."""
    from expanded_panoramas.cycles_integration import roles
    from expanded_panoramas.cycles_integration.place import sort_objects

    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene)
    (lamp,) = here.lights.objects
    material = lamp.data.materials[0]
    assert lamp not in roles.real_objects(scene)
    assert all(lamp not in roles.with_role(scene, role) for role, *_ in roles.ROLES)
    assert len(roles.real_objects(scene)) == 6
    sort_objects(scene, here)
    assert lamp.users_collection == (here.lights,)
    prepare(scene)
    (lamp,) = here.lights.objects
    assert lamp.users_collection == (here.lights,)
    assert lamp.data.materials[0].name == f"Panorama Lamp 0 ({scene.name})"
    assert material not in list(fresh_blend.data.materials)


def test_preparing_again_leaves_nothing_behind(fresh_blend, tmp_path):
    kinds = (
        "objects",
        "meshes",
        "materials",
        "lights",
        "images",
        "worlds",
        "node_groups",
        "cameras",
        "scenes",
    )

    def data_blocks():
        return {kind: len(getattr(fresh_blend.data, kind)) for kind in kinds}

    scene, _ = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene, 0)
    plain = data_blocks()
    prepare(scene)
    once = data_blocks()
    prepare(scene)
    assert data_blocks() == once != plain
    prepare(scene, 0)
    assert data_blocks() == plain


def test_no_more_than_asked_for_and_why(fresh_blend, tmp_path):
    image = lamp_map((LAMP, 0.3, (20, 20, 20)), ((-1.0, 0.3), 0.3, (60, 60, 60)))
    scene, here = box_room(fresh_blend, tmp_path, image)
    assert prepare(scene).at_depth.count == 2
    one = prepare(scene, 1).at_depth
    (lamp,) = here.lights.objects
    assert one.reason == f"1 lamp with {100 * one.share:.0f} % of the light"
    assert np.mean([vertex.co.x for vertex in lamp.data.vertices]) == pytest.approx(-1.0, abs=0.03)


def test_a_flat_map_is_left_alone(fresh_blend, tmp_path):
    scene, here = box_room(fresh_blend, tmp_path, np.full((HEIGHT, WIDTH, 3), 0.7, np.float32))
    prepared = prepare(scene)
    assert prepared.at_depth.count == len(here.lights.objects) == 0
    assert prepared.at_depth.reason == "no surface stands out of this map: left alone"


def test_two_scenes_do_not_share_lamps(fresh_blend, tmp_path):
    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene)
    mine = set(here.lights.objects), {o.data.materials[0] for o in here.lights.objects}, here.residual
    fresh_blend.context.window.scene = fresh_blend.data.scenes.new("other")
    other, there = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(other)
    assert len(there.lights.objects) == 1
    assert not set(there.lights.objects) & mine[0]
    assert not {o.data.materials[0] for o in there.lights.objects} & mine[1]
    assert there.residual != mine[2]
    prepare(other, 0)
    assert (set(here.lights.objects), here.residual) == (mine[0], mine[2])
