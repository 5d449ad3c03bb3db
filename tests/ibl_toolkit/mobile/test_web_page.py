"""The page's file: all is in it and nothing outside, and what is in it is what was given."""

import base64
import json
import re
import struct

import cv2
import numpy as np
import pytest
from web_pages import camera, photo, sky, still_life

from expanded_panoramas.ibl_toolkit.glb import Y_UP
from expanded_panoramas.ibl_toolkit.images.png import srgb_codes
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import ShadowSettings
from expanded_panoramas.ibl_toolkit.mobile.shadow_scene import SceneLight, SceneMesh, ShadowScene, scene_glb
from expanded_panoramas.ibl_toolkit.mobile.web_page import SOURCES, WIDEST, Background, write_page

SETTINGS = [ShadowSettings("pcf", np.int64(256), "8+8", np.int64(3)), ShadowSettings("hard", 512, "float32")]
TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])


@pytest.fixture
def text(tmp_path):
    write_page(tmp_path / "a.html", still_life(), SETTINGS, sky(), camera(), "Sun & </title>")
    return (tmp_path / "a.html").read_text(encoding="utf-8")


def element(text, opening):
    return re.search(f"{opening}>(.*?)</script>", text, re.DOTALL)[1]


def read_glb(data):
    """(document, binary)."""
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data))
    size = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def array(document, binary, number):
    accessor = document["accessors"][number]
    kind, width = {"VEC3": ("<f4", 3), "SCALAR": ("<u4", 1)}[accessor["type"]]
    start = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    return np.frombuffer(binary, kind, accessor["count"] * width, start).reshape(-1, width)


def test_nothing_is_loaded_from_elsewhere(text):
    """Not by the page, nor by the modules in it; and the policy would not let it."""
    modules = json.loads(element(text, '"importmap"'))["imports"]
    parts = [text, *(base64.b64decode(address.partition(",")[2]).decode() for address in modules.values())]
    for part in parts:
        assert not re.search(r"""https?:|[\s"'=(]//\w|fetch\(|XMLHttpRequest|WebSocket|@import|url\(""", part)
        assert all(name in modules for name in re.findall(r'^import .* from "(.*)";', part, re.MULTILINE))
    assert re.findall(r'(?:src|href)="(\w+:)', text) == ["data:"]
    assert "default-src 'none'" in text


def test_every_source_is_in_the_page(text):
    modules = json.loads(element(text, '"importmap"'))["imports"]
    shaders = json.loads(element(text, 'id="shaders"'))
    files = {file.name for file in SOURCES.iterdir()}
    assert files == {*shaders, *(f"{name}.js" for name in modules), "main.js", "page.html"}
    assert shaders["vsm.glsl"] == (SOURCES / "vsm.glsl").read_text(encoding="utf-8")
    assert "<title>Sun &amp; &lt;/title&gt;</title>" in text


def test_scene_comes_back(text):
    document, binary = read_glb(base64.b64decode(element(text, 'id="scene"')))
    scene, view = still_life(), camera()
    for mesh, node in zip(scene.meshes, document["meshes"], strict=True):
        (primitive,) = node["primitives"]
        points, normals, triangles = mesh.with_normals()
        attributes = primitive["attributes"]
        np.testing.assert_allclose(array(document, binary, attributes["POSITION"]) @ Y_UP, points, atol=1e-6)
        np.testing.assert_allclose(array(document, binary, attributes["NORMAL"]) @ Y_UP, normals, atol=1e-6)
        np.testing.assert_array_equal(array(document, binary, primitive["indices"]).reshape(-1, 3), triangles)
        assert document["materials"][primitive["material"]]["extras"] == {"role": mesh.role, "throws": True}
    extras = document["scenes"][0]["extras"]
    light = scene.lights[0].camera
    np.testing.assert_allclose(
        extras["lights"][0]["clip_from_world"], light.clip_from_light @ light.light_from_world
    )
    assert extras["shadow_settings"][0]["window"] == 3
    assert extras["shadow_settings"][1]["label"] == "HARD, 512 × 512, float32, 1024 KiB"
    assert extras["camera"]["half_width"] == pytest.approx(np.tan(np.radians(55 / 2)))
    np.testing.assert_allclose(extras["camera"]["axes"], view.axes)
    np.testing.assert_allclose(extras["background"]["panorama_from_world"], sky().world_from_panorama.T)


def test_background_comes_back(text):
    data = base64.b64decode(re.search('src="data:image/jpeg;base64,([^"]*)"', text)[1])
    shown = cv2.cvtColor(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
    right = srgb_codes(sky().image, sky().exposure)
    assert np.abs(shown.astype(int) - right).mean() < 2


def test_background_is_no_larger_than_phones_take():
    shown = cv2.imdecode(np.frombuffer(Background(np.ones((4, WIDEST + 902, 3))).jpeg("a"), np.uint8), 1)
    assert shown.shape[1] == WIDEST


def test_flat_normals_point_where_triangles_turn_left():
    _, normals, _ = SceneMesh("one", *TRIANGLE).with_normals()
    np.testing.assert_array_equal(normals, [[0, 0, 1]] * 3)
    twice = TRIANGLE[0], np.array([[0, 0, 1], [0, 1, 2]])
    assert len(SceneMesh("with one without area", *twice).with_normals()[0]) == 3


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SceneMesh("a", TRIANGLE[0][:2], TRIANGLE[1]), "corners are among 2 points"),
        (lambda: SceneMesh("a", TRIANGLE[0] * np.nan, TRIANGLE[1]), "all finite"),
        (lambda: SceneMesh("a", *TRIANGLE, "real"), "role 'real' must be one of support, env"),
        (lambda: SceneMesh("a", *TRIANGLE, albedo=(0, 0, 2)), "numbers from 0 to 1"),
        (lambda: SceneMesh("a", *TRIANGLE, normals=np.ones((2, 3))), "normals (2, 3) must be (3, 3)"),
        (lambda: SceneLight(still_life().lights[0].camera, (1, 1, -1)), "0 or more"),
        (lambda: ShadowScene([], still_life().lights), "no meshes"),
        (lambda: ShadowScene(still_life().meshes, []), "0 lights must have 1 to 8"),
        (lambda: ShadowScene(still_life().meshes, still_life().lights, (0, 0, np.nan)), "ambient"),
        (
            lambda: ShadowScene(still_life().meshes, still_life().lights, (0, 0, 0), (0, -1, 0)),
            "ambient light (0, -1, 0)",
        ),
        (lambda: Background(np.ones((2, 4, 3)), "video"), "'video' must be one of panorama, photo"),
        (lambda: Background(np.ones((2, 5, 3))), "width 5 px must have an even one"),
        (lambda: Background(np.ones((2, 4))), "must be (H, W, 3)"),
        (lambda: Background(np.ones((2, 4, 3)), exposure=0), "exposure 0 must be above 0"),
        (lambda: Background(np.ones((2, 4, 3)), world_from_panorama=np.ones((3, 3))), "a (3, 3) rotation"),
        (lambda: scene_glb(still_life(), [], camera(), {}), "at least one kind of shadow map"),
    ],
)
def test_bad_input_is_refused(make, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        make()


def test_photo_of_another_size_is_refused_and_nothing_written(tmp_path):
    small = Background(photo(camera()).image[::2, ::2], "photo")
    with pytest.raises(
        ValueError, match="240 x 160 px must be as large as the camera's picture, 480 x 320 px"
    ):
        write_page(tmp_path / "a.html", still_life(), SETTINGS, small, camera())
    dark = Background(np.full((2, 4, 3), np.nan))
    with pytest.raises(ValueError, match="NaN"):
        write_page(tmp_path / "a.html", still_life(), SETTINGS, dark, camera())
    assert not list(tmp_path.iterdir())
