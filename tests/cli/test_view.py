"""`panorama view`: what is written, what is said, what is refused."""

import json

import numpy as np
import OpenEXR
import pytest
from card_room import card_layer, room_layer, true_view

from expanded_panoramas.ibl_toolkit.layers.files.storage import write_layers
from expanded_panoramas.ibl_toolkit.layers.panorama import LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.layers.views.view_methods import METHODS, render_view

EYE, LOOK_AT, FOV_DEG, SIZE = (3.2, -1.6, 1.25), (4.0, -1.9, 1.15), 65, (96, 64)
ORIGIN = np.array([3.0, -2.0, 1.15])
VIEW = ["--eye", *EYE, "--look-at", *LOOK_AT, "--fov", FOV_DEG, "--width", SIZE[0], "--height", SIZE[1]]


@pytest.fixture
def folder(tmp_path):
    """The room with a card, in layers, at ORIGIN in the world."""
    layers = (room_layer("equirectangular", 256), card_layer("equirectangular", 256))
    write_layers(LayeredPanorama(layers, np.eye(3), ORIGIN, 0.5), tmp_path / "room")
    return tmp_path / "room"


def channels_of(path):
    return {
        name: channel.pixels
        for name, channel in OpenEXR.File(str(path), separate_channels=True).channels().items()
    }


@pytest.mark.parametrize("method", METHODS)
def test_every_method_sees_the_room_as_it_is(panorama, folder, tmp_path, method):
    output = tmp_path / "view.exr"
    status, out, err = panorama("view", folder, "-o", output, *VIEW, "--method", method, "--json")
    assert (status, err) == (0, [])
    result = json.loads(out)
    assert result["method"] == method
    assert result["size"] == list(SIZE)
    assert result["holes"] == 0
    assert result["warnings"] == []
    assert set(result["seconds"]) == {"reading", "view", "writing"}
    assert (result["triangles"] is None) == (method in ("splat", "adaptive"))
    channels = channels_of(output)
    assert {name: pixels.dtype for name, pixels in channels.items()} == {
        **dict.fromkeys("RGB", np.float16),
        "Z": np.float32,
    }
    camera = Pinhole.looking_at(np.subtract(EYE, ORIGIN), np.subtract(LOOK_AT, ORIGIN), FOV_DEG, *SIZE)
    colours, distance, _ = true_view(camera)
    radiance = np.stack([channels[name] for name in "RGB"], axis=2)
    assert np.median(np.abs(radiance - colours)) < 0.005
    assert np.sqrt(((radiance - colours) ** 2).mean()) < 0.12
    assert np.median(np.abs(channels["Z"] / distance - 1)) < 0.003


def test_it_is_told_in_one_line(panorama, folder, tmp_path):
    status, out, err = panorama("view", folder, "-o", tmp_path / "view.exr", *VIEW)
    assert (status, err) == (0, [])
    assert out.startswith("96 × 64 px, adaptive: ")
    assert out.endswith("s, holes 0 %\n")


def test_an_eye_outside_of_the_radius_is_told(panorama, folder, tmp_path):
    outside = ["--eye", 3, -1, 1.15, "--look-at", 4, -2, 1.15, "--width", 32, "--height", 24]
    status, out, err = panorama("view", folder, "-o", tmp_path / "view.exr", *outside)
    assert status == 0
    (line,) = err
    assert "warning: the eye is 0.5 m outside of the panorama's radius, 0.5 m" in line
    _, out, _ = panorama("view", folder, "-o", tmp_path / "view.exr", *outside, "--json")
    assert len(json.loads(out)["warnings"]) == 1


def test_holes_are_counted_and_have_no_distance(panorama, folder, tmp_path):
    away = ["--eye", 9, -2, 1, "--look-at", 12, -2, 1, "--width", 16, "--height", 8, "--json"]
    _, out, _ = panorama("view", folder, "-o", tmp_path / "view.exr", *away)
    assert json.loads(out)["holes"] == 16 * 8
    assert np.isnan(channels_of(tmp_path / "view.exr")["Z"]).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (["--fov", 190], "field of view 190.0° must lie between 0 and 180°"),
        (["--look-at", *EYE], "must look at another point than its own"),
        (["--look-at", *EYE[:2], 9], "nothing is upright"),
        (["--eye", "nan", 0, 0], "must look at another point than its own"),
        (["--width", 0], "must be a whole number, 1 to 32767"),
        (["--method", "magic"], "invalid choice: 'magic'"),
    ],
)
def test_impossible_views_are_refused(panorama, folder, tmp_path, change, message):
    status, out, err = panorama("view", folder, "-o", tmp_path / "view.exr", *VIEW, *change)
    assert (status, out, len(err)) == (2, "", 1)
    assert message in err[0]
    assert not (tmp_path / "view.exr").exists()


def test_no_folder_of_layers(panorama, tmp_path):
    (tmp_path / "empty").mkdir()
    for path, message in (("empty", "panorama.xml"), ("none", "must be a folder with a panorama.xml")):
        status, _, err = panorama("view", tmp_path / path, "-o", tmp_path / "view.exr", *VIEW)
        assert (status, len(err)) == (2, 1)
        assert message in err[0]


def test_a_method_that_does_not_exist():
    room = LayeredPanorama((room_layer("cube map", 12),), np.eye(3), np.zeros(3), 0.5)
    with pytest.raises(ValueError, match="'magic' must be one of splat, adaptive, grid, quadtree, mesh"):
        render_view(room, Pinhole.looking_at((0, 0, 0), (1, 0, 0), 60, 4, 3), "magic")
