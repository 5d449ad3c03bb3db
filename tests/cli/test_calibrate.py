"""`calibrate`: the keys of the contract, no Blender, and what it says of bad sets."""

import json
import subprocess
import sys

import pytest

from .conftest import change_set

KEYS = {
    "world_from_panorama",
    "camera_height",
    "tilt_deg",
    "residual_deg",
    "uncertainty",
    "condition",
    "warnings",
}
DEGREES = 1e-6


def test_json_has_the_contracts_keys_and_the_rooms_values(room, panorama):
    status, out, err = panorama("calibrate", room / "room.json", "--json")
    result = json.loads(out)
    assert (status, err) == (0, [])
    assert set(result) == KEYS
    assert set(result["uncertainty"]) == {"tilt_deg", "scale_percent"}
    assert result["camera_height"] == pytest.approx(1.5)
    assert result["tilt_deg"] == pytest.approx(0, abs=DEGREES)


def test_without_json_it_prints_lines_and_warns_on_stderr(room, panorama):
    status, out, err = panorama("calibrate", room / "room.json")
    assert status == 0
    assert out.splitlines()[1].startswith("camera height  1.500 m")
    assert err  # half a pixel of 128 is a lot
    assert all(line.startswith(f"panorama calibrate: {room / 'room.json'}: warning: ") for line in err)


def test_it_reads_no_pixels(room, panorama):
    whole = (room / "room.exr").read_bytes()
    (room / "room.exr").write_bytes(whole[: len(whole) // 2])
    assert panorama("calibrate", room / "room.json", "--json")[0] == 0


def test_it_needs_no_bpy(room):
    code = "import sys; sys.modules['bpy'] = None; from expanded_panoramas.cli import main; sys.exit(main())"
    done = subprocess.run([sys.executable, "-c", code, "calibrate", room / "room.json"], capture_output=True)
    assert done.returncode == 0, done.stderr
    refused = subprocess.run(
        [sys.executable, "-c", code, "depth", room / "room.json", "-o", room / "d.exr"],
        capture_output=True,
        text=True,
    )
    assert refused.returncode == 2
    assert "needs Blender" in refused.stderr


CROSSED = {"rectangles": [{"points": [[0.5, 0.7], [0.6, 0.8], [0.6, 0.7], [0.5, 0.8]], "plane": "FLOOR"}]}


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"image": "none.exr"}, ["room.json: image: ", "none.exr", "No such file"]),
        ({"image": "room.json"}, ["room.json: image: ", "neither OpenEXR nor Radiance"]),
        ({"version": 7}, ["room.json: version is 7"]),
        ({"colour": 1}, ["room.json: ", "colour"]),
        ({"calibration": {**CROSSED, "camera_height": -1}}, ["room.json: calibration.camera_height"]),
        ({"calibration": {**CROSSED, "camera_height": 1.5}}, ["room.json: ", "rectangle"]),
    ],
)
def test_bad_sets_are_refused_in_one_line(room, panorama, keys, words):
    change_set(room / "room.json", **keys)
    status, out, err = panorama("calibrate", room / "room.json", "--json")
    assert (status, out, len(err)) == (2, "", 1)
    assert err[0].startswith("panorama calibrate: ")
    assert [word for word in words if word not in err[0]] == []


def test_a_missing_set_is_named(tmp_path, panorama):
    status, _, err = panorama("calibrate", tmp_path / "no.json")
    assert (status, err) == (2, [f"panorama calibrate: {tmp_path / 'no.json'}: No such file or directory"])
