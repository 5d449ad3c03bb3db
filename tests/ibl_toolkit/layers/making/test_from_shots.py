"""RGB-D shots of a known room: what one does not see the next fills in."""

import json

import numpy as np
import pytest
from box_layers import directions
from box_with_object import room_with_box, shot_of_room

from expanded_panoramas.ibl_toolkit.images import RGBD, write_exr, write_rgbd
from expanded_panoramas.ibl_toolkit.layers.making.check import check_layers
from expanded_panoramas.ibl_toolkit.layers.making.from_shots import layers_from_shots
from expanded_panoramas.ibl_toolkit.layers.making.shots import is_shots_file, read_shots
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.metrics import psnr

WIDTH, RADIUS = 256, 0.5
BESIDE = (2.4, 1.5, 0.3)
"""From here the wall behind the box is seen, which hides it from (0, 0, 0)."""
TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def write_shot(path, eye, rays):
    distance, colours = shot_of_room(np.array(eye), rays)
    channels = {name: colours[..., k].astype(np.float32) for k, name in enumerate("RGB")}
    write_exr(path, {**channels, "Z": distance.astype(np.float32)})


def listed(tmp_path, *shots):
    path = tmp_path / "shots.json"
    path.write_text(json.dumps({"version": 1, "shots": shots}))
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Shots: the whole room from the origin; all and a part of it from beside."""
    folder = tmp_path_factory.mktemp("shots")
    rays = directions("equirectangular", WIDTH)
    write_shot(folder / "first.exr", (0, 0, 0), rays)
    write_shot(folder / "beside.exr", BESIDE, rays)
    write_shot(
        folder / "part.exr", BESIDE, Pinhole.looking_at(BESIDE, (3, -0.3, -0.5), 100, 160, 120).directions()
    )
    return folder


FIRST = {"image": "first.exr", "origin": [0, 0, 0]}
OTHERS = {
    "panorama": {"image": "beside.exr", "origin": BESIDE},
    "perspective": {"image": "part.exr", "origin": BESIDE, "look_at": [3, -0.3, -0.5], "fov_deg": 100},
}


def hidden_part(panorama, room):
    """Of the pixels that the box hides those whose background is known, and how far their depth is off."""
    back = panorama.layers[0]
    hidden = back.mask & room.hit
    return back, hidden, np.abs(back.depth / room.behind_depth - 1)[hidden]


@pytest.fixture(scope="module")
def alone(folder):
    """Layers of the first shot."""
    return layers_from_shots(read_shots(listed(folder, FIRST)), WIDTH, RADIUS)


@pytest.mark.parametrize("other", OTHERS)
def test_the_second_shot_fills_what_the_first_cannot_see(folder, alone, other):
    room = room_with_box("equirectangular", WIDTH)
    both = layers_from_shots(read_shots(listed(folder, FIRST, OTHERS[other])), WIDTH, RADIUS)
    back, hidden, off = hidden_part(both, room)
    assert check_layers(both).uncovered == 0
    assert np.median(off) < 5e-3
    # Alone the colours of the strip are continued from its rim; now they are those that were seen.
    first_back, guessed, _ = hidden_part(alone, room)
    assert np.count_nonzero(hidden) > 1.2 * np.count_nonzero(guessed)
    assert psnr(back.radiance, room.behind, hidden) > psnr(first_back.radiance, room.behind, guessed) + 5
    visible = back.mask & ~room.hit
    assert psnr(back.radiance, room.behind, visible) > 35


def test_a_turned_panorama_and_a_camera_by_its_axes_see_the_same(folder, tmp_path):
    """As far as they look the same way: distances along the same rays."""
    rays = directions("equirectangular", 64)
    distance, colours = shot_of_room(np.array(BESIDE), rays @ TURN.T)
    write_rgbd(
        tmp_path / "turned.exr", RGBD(colours.astype(np.float32), distance.astype(np.float32), TURN, 1.5)
    )
    camera = Pinhole.looking_at(BESIDE, (3, -0.3, -0.5), 60, 32, 24)
    write_shot(tmp_path / "camera.exr", BESIDE, camera.directions())
    axes = {"forward": camera.axes[2].tolist(), "down": camera.axes[1].tolist()}
    shots = read_shots(
        listed(
            tmp_path,
            {"image": "turned.exr", "origin": BESIDE},
            {"image": "camera.exr", "origin": BESIDE, "fov_deg": 60, **axes},
        )
    )
    for shot in shots:
        expected, colours = shot_of_room(shot.origin, shot.rays.astype(float))
        np.testing.assert_allclose(shot.distances, expected, rtol=1e-4)
        assert np.median(np.abs(shot.colours - colours)) < 1e-3


def test_sky_stays_at_infinity_and_unknown_depth_is_left_to_others(tmp_path):
    rays = directions("equirectangular", 64)
    ball = np.where(rays[..., 0] > 0.9, 2.0, np.inf).astype(np.float32)
    depth = np.where(rays[..., 1] > 0.9, np.float32(np.nan), ball)
    grey = dict.fromkeys("RGB", np.full(depth.shape, 0.5, np.float32))
    write_exr(tmp_path / "a.exr", {**grey, "Z": depth})
    write_exr(tmp_path / "b.exr", {**grey, "Z": np.where(rays[..., 1] > 0.8, ball, np.float32(np.nan))})
    shots = [{"image": name, "origin": [1, 2, 3]} for name in ("a.exr", "b.exr")]
    made = layers_from_shots(read_shots(listed(tmp_path, *shots)), 64, 0.3)
    assert made.origin.tolist() == [1, 2, 3]
    assert check_layers(made).uncovered == 0
    depths = np.concatenate([layer.depth[layer.mask] for layer in made.layers])
    assert (np.isinf(depths) | (np.abs(depths - 2) < 0.2)).all()
    assert np.isinf(made.layers[0].depth[rays[..., 1] > 0.9]).all()


def test_layers_stand_where_it_is_asked_for(tmp_path):
    rays = directions("equirectangular", 64)
    grey = dict.fromkeys("RGB", np.full(rays.shape[:2], 0.5, np.float32))
    write_exr(tmp_path / "ball.exr", {**grey, "Z": np.full(rays.shape[:2], 2, np.float32)})
    shots = read_shots(listed(tmp_path, {"image": "ball.exr", "origin": [1, 2, 3]}))
    made = layers_from_shots(shots, 64, 0.3, origin=(1.5, 2, 3))
    assert made.origin.tolist() == [1.5, 2, 3]
    (layer,) = made.layers
    np.testing.assert_allclose(layer.depth[rays[..., 0] > 0.98], 1.5, rtol=0.02)
    np.testing.assert_allclose(layer.depth[rays[..., 0] < -0.98], 2.5, rtol=0.02)


@pytest.mark.parametrize(
    ("shot", "words"),
    [
        ({"origin": [0, 0, 0]}, r"shots\[0\].image is missing"),
        ({**FIRST, "up": 1}, r"shots\[0\].up is an unknown key"),
        ({**FIRST, "fov_deg": 60}, r"shots\[0\].fov_deg: must be given with look_at"),
        ({**FIRST, "look_at": [1, 0, 0]}, r"shots\[0\].fov_deg: must be given with look_at"),
        ({**FIRST, "fov_deg": 60, "forward": [1, 0, 0]}, r"shots\[0\].forward: must be given with down"),
        ({**FIRST, "fov_deg": 60, "forward": [1, 0, 0], "down": [1, 0, 0]}, "must be a .* rotation"),
        ({"image": "part.exr", "origin": [0, 0, 0]}, "160 x 120 px must be 2:1"),
        ({"image": "bare.exr", "origin": [0, 0, 0]}, "channel Z is needed"),
        ({"image": "zero.exr", "origin": [0, 0, 0]}, "1 depths are not above 0"),
    ],
)
def test_shots_that_cannot_be_are_refused(folder, shot, words):
    grey = dict.fromkeys("RGB", np.ones((4, 8), np.float32))
    write_exr(folder / "bare.exr", grey)
    write_exr(folder / "zero.exr", {**grey, "Z": np.arange(32, dtype=np.float32).reshape(4, 8)})
    with pytest.raises(ValueError, match=words):
        read_shots(listed(folder, shot))


def test_a_list_of_shots_is_told_from_other_files(folder, tmp_path):
    assert is_shots_file(listed(folder, FIRST))
    for text in ('{"version": 1, "image": "a.exr"}', "[]", "shots"):
        (tmp_path / "other.json").write_text(text)
        assert not is_shots_file(tmp_path / "other.json")
