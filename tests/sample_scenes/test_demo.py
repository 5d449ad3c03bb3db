"""The demo, tiny: every file is there and says what it should; what nothing touches stays the photograph."""

import json
import re

import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.ibl_toolkit.images import read_panorama, read_rgbd

WIDTH = 128
FLOOR_BELOW_M, ROOM_ACROSS_M = 1.32, 6.0  # the camera's height; nothing in the room is farther
STEPS = {
    "input",
    "calibrate",
    "reconstruct",
    "build",
    "objects",
    "depth",
    "prepare",
    "frame",
    "panorama",
    "page",
}
PICTURES = ("frame", "frame_before", "panorama", "panorama_before", "reconstruction", "depth", "lamps")


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    """The folder of one quick run, and its report."""
    pytest.importorskip("bpy")
    from expanded_panoramas.sample_scenes import demo
    from expanded_panoramas.sample_scenes.demo_job import QUICK

    folder = tmp_path_factory.mktemp("demo") / "out"
    demo.run_demo(folder, QUICK)
    return folder


@pytest.fixture
def report(demo):
    return json.loads((demo / "report.json").read_text(encoding="utf-8"))


def test_all_files_and_no_others(demo):
    pictures = {f"{name}.png" for name in PICTURES}
    images = {"depth.exr", "frame.exr", "frame_before.exr", "panorama.exr", "interior.exr"}
    assert {file.name for file in demo.iterdir()} == pictures | images | {
        "hotel_room.json",
        "index.html",
        "report.json",
    }


def test_pictures_are_numbers_of_the_right_size(demo):
    for name, size in (("frame", (54, 96, 3)), ("panorama", (WIDTH // 2, WIDTH, 3))):
        picture = pixels(demo / f"{name}.exr")
        assert picture.shape == size
        assert np.isfinite(picture).all()
        assert picture.min() >= 0


def test_objects_are_in_both_pictures(demo):
    photograph = read_panorama(demo / "interior.exr")
    for picture, before in (
        (pixels(demo / "panorama.exr"), photograph),
        (pixels(demo / "frame.exr"), pixels(demo / "frame_before.exr")),
    ):
        changed = np.abs(picture - before).max(axis=2) > 0.05 * before.max(axis=2)
        assert 0.02 < changed.mean() < 0.6


def test_what_nothing_touches_is_the_photograph(demo, report):
    """Above the middle of the upper half there are walls and ceiling only; the report knows of more."""
    photograph, panorama = read_panorama(demo / "interior.exr"), pixels(demo / "panorama.exr")
    np.testing.assert_array_equal(panorama[: WIDTH // 4], photograph[: WIDTH // 4])
    untouched = report["errors"]["untouched"]
    assert untouched["psnr_db"] is None
    assert untouched["largest_difference"] == 0
    assert untouched["share_of_pixels"] > 0.5


def test_depth_is_that_of_a_room(demo):
    rgbd = read_rgbd(demo / "depth.exr")
    assert rgbd.depth.shape == (WIDTH // 2, WIDTH)
    assert rgbd.camera_height == FLOOR_BELOW_M
    assert rgbd.depth.max() < ROOM_ACROSS_M
    assert rgbd.depth[-1].min() == pytest.approx(FLOOR_BELOW_M, rel=0.01)


def test_the_report_says_what_was_spent_and_found(report):
    assert set(report["seconds"]) == STEPS | {"total"}
    assert report["seconds"]["total"] == pytest.approx(sum(report["seconds"][step] for step in STEPS))
    assert {shape["name"] for shape in report["shapes"]} >= {"floor", "walls", "bed", "desk"}
    assert report["calibration"]["warnings"] == []
    assert report["depth"]["coverage"] == pytest.approx(1)
    assert report["lights"]["count"] > 0
    assert 0 < report["lights"]["share"] < 1


def test_the_page_stands_alone(demo):
    """Every picture and file it names lies beside it; no placeholder was left."""
    page = (demo / "index.html").read_text(encoding="utf-8")
    named = set(re.findall(r'(?:src|href)="([^"]+)"', page))
    assert named >= {f"{name}.png" for name in PICTURES}
    assert all((demo / name).is_file() for name in named)
    assert not re.search(r"\$\w", page)


def pixels(path):
    return OpenEXR.File(str(path)).channels()["RGB"].pixels
