"""`panorama probe`: light directions from photographs with known lights."""

import json

import cv2
import numpy as np
import OpenEXR
import pytest
from probe_photos import Lamp, angle_deg, codes, desk_before, photograph, unit

from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.mobile.probe import Ball, PhotoCamera

LIGHT = unit([0.5, 0.3, 0.7])
"""In the marker's frame."""
BALL = (0.12, 0.02, 0.05)
FOV = 42


@pytest.fixture(scope="module")
def photo(tmp_path_factory):
    """A PNG of a mirror ball beside a marker; camera, desk."""
    camera, desk = PhotoCamera.from_fov(FOV, 400, 300), desk_before()
    lamp = Lamp(desk.camera_from_marker @ LIGHT)
    image = photograph(camera, Ball(desk.to_camera(BALL), BALL[2]), [lamp], desk=desk, fine=3)
    path = tmp_path_factory.mktemp("probe") / "ball.png"
    cv2.imwrite(str(path), (codes(image, 0.8)[..., ::-1] * 255).astype(np.uint8))
    return path, camera, desk


MARKER = ("--fov", FOV, "--marker-size", 0.1)
PLACE = (*MARKER, "--ball-radius", BALL[2], "--ball-centre", *BALL)


def test_a_light_in_the_markers_frame(photo, panorama, tmp_path):
    out = tmp_path / "light.json"
    status, text, err = panorama("probe", photo[0], *PLACE, "--json", "-o", out)
    result = json.loads(text)
    assert status == 0
    assert err == []
    assert json.loads(out.read_text()) == result
    (light,) = result["lights"]
    assert result["frame"] == "marker"
    assert angle_deg(light["direction"], LIGHT) < 1
    assert light["altitude_deg"] == pytest.approx(np.degrees(np.arcsin(LIGHT[2])), abs=1)
    assert light["strength"] == 1
    assert light["is_clipped"]
    assert result["ball"]["placed_by"] == "marker"
    assert result["ball"]["unit"] == "m"
    assert result["marker"]["id"] == 7
    assert ["clipped" in text for text in result["warnings"]] == [True]


def test_lines_for_people_and_warnings_on_stderr(photo, panorama):
    status, text, err = panorama("probe", photo[0], *PLACE, "--domain", "sphere")
    assert status == 0
    assert "(marker)" in text
    assert "above the plane" in text
    assert len(err) == 1
    assert "warning: light 1: clipped" in err[0]


def test_without_a_marker_the_frame_is_the_cameras(photo, panorama):
    path, camera, desk = photo
    points = camera.pixels(Ball(desk.to_camera(BALL), BALL[2]).outline(8))
    outline = [f"{x},{y}" for x, y in points]
    focal = camera.focal[0]
    status, text, _ = panorama("probe", path, "--focal", focal, "--outline", *outline, "--json")
    result = json.loads(text)
    assert status == 0
    assert result["frame"] == "camera"
    assert result["marker"] is None
    assert result["ball"]["unit"] == "radii"
    assert angle_deg(result["lights"][0]["direction"], desk.camera_from_marker @ LIGHT) < 1


def test_the_unwrapped_ball_stands_upright_and_shows_the_light(photo, panorama, tmp_path):
    out = tmp_path / "room.exr"
    status, text, _ = panorama("probe", photo[0], *PLACE, "--unwrap", out, "--width", 64, "--json")
    result = json.loads(text)
    image = read_panorama(out)
    assert status == 0
    assert image.shape == (32, 64, 3)
    assert result["unwrapped"]["size"] == [64, 32]
    assert 0.99 < result["unwrapped"]["known"] < 1
    alpha = OpenEXR.File(str(out), separate_channels=True).channels()["A"].pixels
    assert alpha.mean() == pytest.approx(result["unwrapped"]["known"])
    assert not image[alpha == 0].any()
    row, column = np.unravel_index(np.argmax(image.sum(axis=2)), image.shape[:2])
    u, v = result["lights"][0]["uv"]
    assert abs((column + 0.5) / 64 - u) < 0.03
    assert abs((row + 0.5) / 32 - v) < 0.06


def test_a_shadow_instead_of_a_ball(photo, panorama):
    path, camera, desk = photo
    foot = np.array([0.0, 0.12, 0.0])
    tip = foot - LIGHT * 0.08 / LIGHT[2] + (0, 0, 0.08)
    points = [",".join(map(str, camera.pixels(desk.to_camera(p)))) for p in (foot, tip)]
    status, text, err = panorama("probe", path, *MARKER, "--shadow", *points, "--height", 0.08, "--json")
    result = json.loads(text)
    assert status == 0, err
    assert result["method"] == "shadow"
    assert angle_deg(result["lights"][0]["direction"], LIGHT) < 0.5
    assert panorama("probe", path, *MARKER, "--shadow", *points, "--height", 0.08)[0] == 0


def test_batch(photo, panorama, tmp_path):
    status, _, _ = panorama("batch", "probe", photo[0], *PLACE, "--into", tmp_path)
    assert status == 0
    assert json.loads((tmp_path / "ball_probe.json").read_text())["method"] == "mirror"
    status, _, err = panorama("batch", "probe", photo[0], *PLACE, "--into", tmp_path, "--unwrap", "x.exr")
    assert status == 2
    assert "not in a batch" in err[0]


@pytest.mark.parametrize(
    ("options", "what"),
    [
        ((), "one of the arguments --fov --focal is required"),
        (("--fov", 42, "--focal", 300), "not allowed with"),
        (("--fov", 200), "field of view 200"),
        (("--fov", 42, "--ball-centre", 0, 0, 1), "--ball-centre: needs --marker-size too"),
        ((*MARKER, "--ball-centre", 0, 0, 1), "--ball-centre: needs --ball-radius too"),
        ((*MARKER, "--shadow", "1,2", "3,4"), "--shadow: needs --height too"),
        (
            (*MARKER, "--shadow", "1,2", "3,4", "--height", 1, "--ball-radius", 1),
            "does nothing with --shadow",
        ),
        *(
            ((*MARKER, "--shadow", "1,2", "3,4", "--height", 1, *extra), "does nothing with --shadow")
            for extra in (("--kind", "diffuse"), ("--lights", 2), ("--domain", "sphere"))
        ),
        (("--fov", 42, "--dictionary", "6X6_50"), "--dictionary: needs --marker-size too"),
        (("--fov", 42, "--marker-id", 3), "--marker-id: needs --marker-size too"),
        (("--fov", 42, "--width", 64), "--width: needs --unwrap too"),
        (("--fov", 42, "--outline", "1;2"), "must be a point X,Y"),
        (("--fov", 42, "--lights", 0), "1 to 16"),
        (("--fov", 42, "--kind", "diffuse", "--unwrap", "a.exr"), "mirrors no panorama"),
        (("--fov", 42, "--unwrap", "a.png"), "must end in .exr"),
        ((*MARKER, "--marker-id", 9), "ball.png: marker 9 is not seen; seen: 7"),
        ((*MARKER, "--dictionary", "6X6_50"), "ball.png: no marker of dictionary 6X6_50"),
    ],
)
def test_bad_orders_are_refused_in_one_line(photo, panorama, options, what):
    status, text, err = panorama("probe", photo[0], *options)
    assert status == 2
    assert text == ""
    assert len(err) == 1
    assert what in err[0]
