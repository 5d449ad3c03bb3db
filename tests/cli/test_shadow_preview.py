"""`shadow-preview`: pages, glTF and pictures of a scene and of a set; what it prints and refuses."""

import base64
import json
import re

import cv2
import numpy as np
import OpenEXR
import pytest


@pytest.fixture
def scene_file(fresh_blend, tmp_path):
    """A ball over a support, and a sun."""
    import small_scenes as small

    scene = fresh_blend.context.scene
    small.add_plane(scene, small.material(small.DIFFUSE), 4).panorama_role = "SUPPORT"
    small.add_ball(scene, small.material(small.DIFFUSE), 0.3, (0.5, 0, 0.6))
    small.add_camera(scene, (0.3, -3, 1.9), (0.1, 0, 0.3), field_of_view=0.9)
    sun = fresh_blend.data.objects.new("Sun", fresh_blend.data.lights.new("Sun", "SUN"))
    sun.data.energy = 1
    scene.collection.objects.link(sun)
    scene.render.resolution_x, scene.render.resolution_y = 60, 40
    scene.panorama_shadow_preview.method, scene.panorama_shadow_preview.resolution = "vsm", 64
    fresh_blend.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    return tmp_path / "scene.blend"


def test_a_page_has_the_scenes_own_kind_of_shadow_map(scene_file, tmp_path, panorama):
    page = tmp_path / "page.html"
    status, out, err = panorama("shadow-preview", scene_file, "-o", page, "--json")
    result = json.loads(out)
    assert (status, len(err)) == (0, 0)
    assert result["kinds"] == ["VSM, 64 × 64, 16+16, window 3, 16 KiB"]
    assert (result["file"], result["bytes"]) == (str(page), page.stat().st_size)
    assert (result["meshes"], result["size"], result["background"]) == (2, None, "panorama")
    (light,) = result["lights"]
    assert light == {"name": "Sun", "direction": [0, 0, 1], "strength": [1, 1, 1]}
    assert result["ambient"] == [0, 0, 0]
    assert "there is no World" in result["warnings"][0]
    assert "<title>scene</title>" in page.read_text(encoding="utf-8")


def test_kinds_are_all_combinations(scene_file, tmp_path, panorama):
    command = ["shadow-preview", scene_file, "-o", tmp_path / "page.html", "--json"]
    several = ["--method", "hard,evsm,hard", "--resolution", "32,64", "--storage", "8+8,8+8"]
    _, out, _ = panorama(*command, *several)
    labels = [kind.rpartition(",")[0] for kind in json.loads(out)["kinds"]]
    assert labels[:2] == ["HARD, 32 × 32, 8+8", "HARD, 64 × 64, 8+8"]
    assert labels[2:] == [f"EVSM, {size} × {size}, 8+8, window 3" for size in (32, 64)]
    document = (tmp_path / "page.html").read_text(encoding="utf-8")
    data = base64.b64decode(re.search('id="scene">(.*?)</script>', document)[1])
    assert all(label.encode() in data for label in labels)
    _, out, _ = panorama(*command, "--penumbra", "0.1")
    assert "window 7" in json.loads(out)["kinds"][0]  # of 64 texels over about 0.6 · √3 m: 0.1 m


def test_pictures_without_a_browser(scene_file, tmp_path, panorama):
    for name, size in (("a.png", ()), ("a.exr", ("--width", 30))):
        status, out, err = panorama("shadow-preview", scene_file, "-o", tmp_path / name, *size)
        assert status == 0
        assert out.splitlines()[0] == "Sun: sun towards +0.00 +0.00 +1.00, 1 1 1 W/m²"
        assert "warning: there is no World" in err[0]
    assert cv2.imread(str(tmp_path / "a.png")).shape == (40, 60, 3)
    picture = OpenEXR.File(str(tmp_path / "a.exr")).channels()["RGB"].pixels
    assert picture.shape == (20, 30, 3)
    assert 0.25 < picture.max() <= 1 / np.pi  # of white in a sun of 1 W/m²
    assert picture.min() == 0


def test_a_set_is_rebuilt_and_lit_by_its_panorama(room_with_objects, panorama):
    room = room_with_objects
    command = ["shadow-preview", room / "room.json", "--camera", "Side"]
    _, out, _ = panorama(*command, "-o", room / "room.glb", "--resolution", "64", "--json")
    result = json.loads(out)
    (light,) = result["lights"]
    assert light["name"] == "panorama 1"
    assert light["position"][2] > 2  # on the ceiling
    assert result["exposure"] == pytest.approx(0.18 / 0.5, rel=0.1)  # of its median
    assert result["meshes"] > 3
    assert (room / "room.glb").read_bytes()[:4] == b"glTF"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["a.blend", "-o", "page.html"], "a.blend: No such file"),
        (["a.exr", "-o", "page.html"], "a.exr: must be scene (.blend) or panorama set (.json)"),
        (["a.blend", "-o", "page.htm"], "-o page.htm: must end in .html, .glb, .png, .exr"),
        (["a.blend", "-o", "none/page.html"], "folder none does not exist"),
        (["a.blend", "-o", "page.html", "--width", "9"], "--width: does nothing for page.html"),
        (["a.blend", "-o", "a.html", "--objects", "b.blend"], "--objects: does nothing for a.blend"),
        (["room.json", "-o", "page.html"], "without objects nothing throws a shadow"),
        (["room.json", "-o", "page.html", "--objects", "b.blend"], "objects: b.blend: no such file"),
        (["a.blend", "-o", "page.html", "--method", "soft"], "'soft': must be one or more of hard"),
        (["a.blend", "-o", "page.html", "--resolution", "64,8"], "'8': must be a whole number, 16 to"),
        (["a.blend", "-o", "page.html", "--lights", "9"], "'9': must be a whole number, 1 to 8"),
        (["a.blend", "-o", "p.html", "--window", "3", "--penumbra", "1"], "not allowed with argument"),
    ],
)
def test_what_cannot_be_is_refused_first(room, panorama, monkeypatch, arguments, words):
    monkeypatch.chdir(room)
    before = sorted(path.name for path in room.iterdir())
    status, out, err = panorama("shadow-preview", *arguments)
    assert (status, out) == (2, "")
    assert words in err[-1]
    assert sorted(path.name for path in room.iterdir()) == before


def test_a_scene_that_cannot_be_shown_leaves_no_file(scene_file, tmp_path, panorama, fresh_blend):
    fresh_blend.data.objects["ball"].visible_shadow = False
    fresh_blend.ops.wm.save_as_mainfile(filepath=str(scene_file))
    status, _, err = panorama("shadow-preview", scene_file, "-o", tmp_path / "page.html")
    assert status == 2
    assert err[0].startswith(f"panorama shadow-preview: {scene_file}: nothing throws a shadow")
    assert not (tmp_path / "page.html").exists()
