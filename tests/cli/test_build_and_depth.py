"""`build` and `depth`: what they write, what they print, what they refuse before any work."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import read_rgbd

from .conftest import change_set

NAMES = ["floor", "walls", "table", "cabinet", "column"]
METRES = 0.01


def test_build_writes_the_place_with_roles_origin_and_world(fresh_blend, room, panorama):
    (room / "scenes").mkdir()
    status, out, _ = panorama("build", room / "room.json", "-o", room / "scenes" / "room.blend", "--json")
    assert status == 0
    shapes = json.loads(out)["shapes"]
    assert [shape["name"] for shape in shapes] == NAMES
    assert {"vertices", "faces", "size", "residual"} <= set(shapes[0])
    assert shapes[1]["size"] == pytest.approx([5.0, 4.0, 2.7], abs=METRES)

    bpy = fresh_blend
    bpy.ops.wm.open_mainfile(filepath=str(room / "scenes" / "room.blend"))
    scene = bpy.context.scene
    assert scene.objects["floor"].panorama_role == "SUPPORT"
    assert scene.objects["walls"].data.materials[0].name.startswith("Panorama Environment")
    assert scene.panorama_place.origin.matrix_world.translation.z == pytest.approx(1.5)
    assert scene.world.name.startswith("Panorama World")
    assert scene.panorama_place.image.filepath == "//../room.exr"
    assert list(scene.panorama_place.image.size) == [128, 64]


@pytest.mark.parametrize("width", [None, 64, 256])
def test_depth_writes_the_map_and_prints_its_extremes(fresh_blend, room, panorama, width):
    option = [] if width is None else ["--width", width]
    status, out, err = panorama("depth", room / "room.json", "-o", room / "map.exr", "--json", *option)
    result = json.loads(out)
    assert (status, err) == (0, [])
    assert set(result) == {"size", "coverage", "nearest", "farthest"}
    assert result["size"] == [width or 128, (width or 128) // 2]
    assert result["coverage"] == pytest.approx(1)
    written = read_rgbd(room / "map.exr")
    assert written.image.shape == (*result["size"][::-1], 3)
    assert written.camera_height == pytest.approx(1.5)
    assert result["nearest"] == pytest.approx(float(written.depth.min()))
    assert result["farthest"] == pytest.approx(float(written.depth.max()))
    assert float(written.depth[-1].mean()) == pytest.approx(1.5, abs=METRES)  # straight down
    assert np.isfinite(written.depth).all()


def test_a_large_map_is_rendered_in_strips_that_fit(fresh_blend, room, panorama, monkeypatch):
    from expanded_panoramas.cycles_integration import capture

    command = ["depth", room / "room.json", "--width", 204, "-o"]  # 102 rows, which 8 does not divide
    assert panorama(*command, room / "whole.exr")[0] == 0
    monkeypatch.setattr(capture, "STRIP_PIXELS", 3000)
    assert panorama(*command, room / "strips.exr")[0] == 0
    whole, strips = (read_rgbd(room / f"{name}.exr").depth for name in ("whole", "strips"))
    np.testing.assert_allclose(strips, whole, rtol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["depth", "-o", "map.png"], ["map.png", "must end in .exr"]),
        (["depth", "-o", "none/map.exr"], ["folder", "none does not exist"]),
        (["depth", "-o", "room.exr"], ["would overwrite an input"]),
        (["depth", "-o", "map.exr", "--width", "63"], ["--width 63", "even"]),
        (["depth", "-o", "map.exr", "--width", "2"], ["--width", "at least 8"]),
        (["depth"], ["-o/--output"]),
        (["build", "-o", "room.json"], ["must end in .blend"]),
    ],
)
def test_outputs_that_cannot_be_are_refused_first(room, panorama, monkeypatch, arguments, words):
    monkeypatch.chdir(room)
    before = {path: path.read_bytes() for path in room.iterdir()}
    status, out, err = panorama(arguments[0], "room.json", *arguments[1:])
    assert (status, out, len(err)) == (2, "", 1)
    assert err[0].startswith(f"panorama {arguments[0]}: ")
    assert [word for word in words if word not in err[0]] == []
    assert {path: path.read_bytes() for path in room.iterdir()} == before


def test_a_shape_that_cannot_be_rebuilt_is_named(room, panorama):
    floor = {
        "name": "floor",
        "kind": "polygon",
        "points": [[0.5, 0.2], [0.6, 0.7], [0.4, 0.7]],
        "role": "SUPPORT",
    }
    change_set(room / "room.json", shapes=[floor])
    status, _, err = panorama("depth", room / "room.json", "-o", room / "map.exr")
    assert (status, len(err)) == (2, 1)
    assert f"{room / 'room.json'}: shape 'floor' (polygon): pick (0.5000, 0.2000)" in err[0]


def test_a_damaged_image_leaves_no_map(fresh_blend, room, panorama):
    whole = (room / "room.exr").read_bytes()
    (room / "room.exr").write_bytes(whole[: len(whole) // 2])
    status, _, err = panorama("depth", room / "room.json", "-o", room / "map.exr")
    assert (status, len(err)) == (2, 1)
    assert "room.exr: truncated" in err[0]
    assert sorted(path.name for path in room.iterdir()) == ["room.exr", "room.json"]


def test_an_rgbd_map_builds_a_scene_of_its_own(fresh_blend, room, panorama):
    assert panorama("depth", room / "room.json", "-o", room / "map.exr")[0] == 0
    status, out, _ = panorama("build", room / "map.exr", "-o", room / "scene.blend", "--json")
    assert status == 0
    (shape,) = json.loads(out)["shapes"]
    assert (shape["kind"], shape["role"]) == ("depth", "ENVIRONMENT")
    assert np.allclose(shape["size"], (5, 4, 2.7), atol=0.1)
    assert panorama("build", room / "room.exr", "-o", room / "none.blend")[0] == 2
