"""The command line's jobs in a real Blender, on the installed zip: the same results as under the wheel."""

import json
import os

import build_zips
import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.ibl_toolkit.images import read_rgbd, write_exr
from expanded_panoramas.ibl_toolkit.panorama_set import write_set

from .test_real_blender import BLENDER, blender

pytestmark = pytest.mark.skipif(not BLENDER, reason="needs BLENDER=/path/to/blender ./run test")

METRES = 0.01


@pytest.fixture(scope="module")
def panorama(tmp_path_factory):
    """The command: panorama(*arguments) -> exit status, its JSON or None, stderr."""
    user = tmp_path_factory.mktemp("user")
    zipped = user / "plain.zip"
    build_zips.build(build_zips.ROOT, zipped)
    blender(user, "extension", "install-file", "-r", "user_default", "--enable", str(zipped))

    def run(*arguments):
        done = blender(user, "panorama", *map(str, arguments), "--json")
        _, brace, rest = done.stdout.partition("{\n")  # after the line with which Blender itself begins
        return done.returncode, json.loads(brace + rest) if brace else None, done.stderr

    return run


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    pytest.importorskip("bpy")
    from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

    folder = tmp_path_factory.mktemp("room")
    image = np.full((64, 128), 0.5, np.float16)
    image[:8, 30:40] = 20
    write_exr(folder / "room.exr", dict.fromkeys("RGB", image))
    write_set(closed_room_set(folder / "room.exr"), folder / "room.json")
    return folder


def test_calibrate(panorama, room):
    status, result, err = panorama("calibrate", room / "room.json")
    assert status == 0, err
    assert result["camera_height"] == pytest.approx(1.5)


def test_depth(panorama, room):
    status, result, err = panorama("depth", room / "room.json", "-o", room / "map.exr")
    assert status == 0, err
    assert result["size"] == [128, 64]
    assert float(read_rgbd(room / "map.exr").depth[-1].mean()) == pytest.approx(1.5, abs=METRES)


def test_build_and_render(panorama, room):
    status, result, err = panorama("build", room / "room.json", "-o", room / "room.blend")
    assert status == 0, err
    assert len(result["shapes"]) == 5
    status, result, err = panorama(
        "render", room / "room.json", "-o", room / "out.exr", "--camera", "panorama", "--samples", 2
    )
    assert status == 0, err
    assert (result["method"], result["size"]) == ("catcher", [128, 64])
    picture = OpenEXR.File(str(room / "out.exr")).channels()["RGB"].pixels
    assert np.median(np.abs(picture - 0.5)) < 1e-3


def test_bad_input(panorama, room):
    status, result, err = panorama("render", room / "none.json", "-o", room / "none.exr")
    assert (status, result) == (2, None)
    assert err.splitlines()[-1] == f"panorama render: {room / 'none.json'}: No such file or directory"
    assert os.listdir(room).count("none.exr") == 0
