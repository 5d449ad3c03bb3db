"""`render`: every method and camera, frame ranges that go on where they stopped, and what is refused."""

import json
from dataclasses import replace

import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.cli.render import RenderOptions, render_set

SAME_PICTURE = 1e-6


def read(path):
    return OpenEXR.File(str(path)).channels()["RGB"].pixels


@pytest.mark.parametrize("method", ["catcher", "single", "difference", "directional"])
def test_every_method_renders_through_the_files_camera(room_with_objects, panorama, method):
    room = room_with_objects
    status, out, err = panorama(
        "render", room / "room.json", "-o", room / "out.exr", "--method", method, "--samples", 2, "--json"
    )
    assert (status, err) == (0, [])
    result = json.loads(out)
    assert result["method"] == method
    assert result["samples"] == 2
    assert result["camera"] == "Front"
    assert list(result["seconds"]) == ["reading", "building", "depth", "lights", "irradiance", "rendering"]
    picture = read(room / "out.exr")
    assert picture.shape == (28, 48, 3)  # half of the objects file's 96 × 56
    assert np.isfinite(picture).all()
    assert picture.max() > 0.1


def test_the_whole_panorama_needs_no_objects_and_shows_the_photograph(fresh_blend, room, panorama):
    status, out, _ = panorama(
        "render", room / "room.json", "-o", room / "out.exr", "--camera", "panorama", "--samples", 1, "--json"
    )
    assert status == 0
    assert json.loads(out)["size"] == [128, 64]
    difference = np.abs(read(room / "out.exr") - read(room / "room.exr").astype(np.float32))
    assert np.median(difference) < SAME_PICTURE


def test_frames_move_and_a_restart_renders_only_what_is_missing(room_with_objects, panorama):
    room = room_with_objects
    command = [
        "render", room / "room.json", "-o", room / "f_##.exr", "--frames", "1-5,2", "--samples", 1, "--json",
        "--camera", "Side",
    ]  # fmt: skip
    status, out, _ = panorama(*command)
    assert status == 0
    assert json.loads(out)["frames"] == {"rendered": [1, 3, 5], "complete_before": []}
    first, third, fifth = (room / f"f_0{number}.exr" for number in (1, 3, 5))
    assert np.abs(read(first) - read(fifth)).max() > 0.01  # the camera follows the ball
    kept = first.stat().st_mtime_ns
    third.write_bytes(third.read_bytes()[:-40])  # as a killed copy leaves it
    fifth.unlink()
    assert json.loads(panorama(*command)[1])["frames"] == {"rendered": [3, 5], "complete_before": [1]}
    assert first.stat().st_mtime_ns == kept
    assert json.loads(panorama(*command)[1])["frames"] == {"rendered": [], "complete_before": [1, 3, 5]}
    resized = json.loads(panorama(*command, "--width", 24)[1])
    assert resized["frames"]["rendered"] == [1, 3, 5]
    assert resized["size"] == [24, 14]


def test_roles_of_the_objects_file_and_what_it_leaves_out_are_honoured(room_with_objects):
    import bpy

    from expanded_panoramas.cycles_integration.objects_file import append_objects

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=str(room_with_objects / "objects.blend"))
    bpy.data.objects["Ball"].panorama_role = "SUPPORT"
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    appended = append_objects(bpy.context.scene, room_with_objects / "objects.blend")
    assert bpy.context.scene.objects["Ball"].panorama_role == "SUPPORT"
    assert bpy.data.collections["Left Out"].hide_render
    assert list(appended.cameras) == ["Front", "Side"]
    assert [scene.name for scene in bpy.data.scenes] == [bpy.context.scene.name]


def test_as_a_function(room_with_objects):
    room = room_with_objects
    options = RenderOptions(objects=str(room / "objects.blend"), samples=1, width=24, lights=0)
    result = render_set(str(room / "room.json"), str(room / "out.exr"), options)
    assert result["lights"] == 0
    assert read(room / "out.exr").shape == (14, 24, 3)


def test_without_frames_the_files_current_frame_is_rendered(room_with_objects):
    import bpy

    room = room_with_objects
    options = RenderOptions(samples=1, camera="Side", width=24)
    bpy.ops.wm.open_mainfile(filepath=str(room / "objects.blend"))
    bpy.context.scene.frame_set(5)
    bpy.ops.wm.save_as_mainfile(filepath=str(room / "last.blend"))
    render_set(room / "room.json", room / "now.exr", replace(options, objects=room / "last.blend"))
    render_set(room / "room.json", room / "frame_#.exr", replace(options, frames=range(5, 6)))
    assert np.array_equal(read(room / "now.exr"), read(room / "frame_5.exr"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--camera", "Top"], ["objects.blend", "no camera 'Top'", "Front, Side"]),
        (["--objects", "none.blend"], ["none.blend", "no such file"]),
        (["--objects", "room.exr"], ["room.exr"]),
        (["--camera", "panorama", "--width", "64", "--height", "64"], ["twice as wide as high"]),
        (["--method", "magic"], ["--method", "catcher"]),
        (["--lights", "many"], ["--lights", "auto, none or a number"]),
        (["--samples", "0"], ["--samples", "1 to 16777216"]),
        (["--frames", "5-1"], ["--frames", "A ≤ B"]),
        (["--frames", "1-5,0"], ["--frames", "step"]),
        (["--frames", "1-5"], ["out.exr", "one name for 5 frames"]),
        (["-o", "out_##.exr"], ["out_##.exr", "--frames must be given"]),
        (["-o", "objects.exr/out.exr"], ["does not exist"]),
    ],
)
def test_bad_input_is_refused_in_one_line(room_with_objects, panorama, monkeypatch, arguments, words):
    monkeypatch.chdir(room_with_objects)
    status, out, err = panorama("render", "room.json", "-o", "out.exr", "--samples", 1, *arguments)
    assert (status, out, len(err)) == (2, "", 1)
    assert err[0].startswith("panorama render: ")
    assert [word for word in words if word not in err[0]] == []
    assert sorted(path.name for path in room_with_objects.iterdir()) == [
        "objects.blend",
        "room.exr",
        "room.json",
    ]


def test_without_objects_a_camera_is_asked_for(fresh_blend, room, panorama):
    status, _, err = panorama("render", room / "room.json", "-o", room / "out.exr")
    assert status == 2
    assert "--objects F.blend, or --camera panorama" in err[0]


def test_radiance_that_is_no_number_is_refused(fresh_blend, room, panorama):
    from expanded_panoramas.ibl_toolkit.images import write_exr

    bad = np.ones((64, 128), np.float32)
    bad[3, 5] = np.nan
    write_exr(room / "room.exr", dict.fromkeys("RGB", bad))
    status, _, err = panorama("render", room / "room.json", "-o", room / "out.exr", "--camera", "panorama")
    assert status == 2
    assert "room.exr: 1 pixel of NaN" in err[0]
