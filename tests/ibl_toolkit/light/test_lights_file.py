"""LIGHTS.json comes back as it was written, and a damaged one is refused by key."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.light.extraction import extract_lights
from expanded_panoramas.ibl_toolkit.light.lights_file import (
    LightsError,
    LightsFile,
    lights_of,
    read_lights,
    write_lights,
)


@pytest.fixture
def extraction():
    image = np.full((32, 64, 3), 0.02, np.float32)
    image[8, 10] = image[12, 40] = 700, 600, 500
    depth = np.full((32, 64), 2.0)
    depth[:, :32] = np.inf
    return extract_lights(image, depth=depth)


@pytest.fixture
def path(tmp_path, extraction):
    (tmp_path / "out").mkdir()
    lights_file = LightsFile(
        tmp_path / "room.exr", "hybrid", extraction.share, lights_of(extraction), extraction.threshold,
        extraction.reason, tmp_path / "out" / "rest.exr",
    )  # fmt: skip
    write_lights(tmp_path / "out" / "lights.json", lights_file)
    return tmp_path / "out" / "lights.json"


def test_it_holds_what_is_promised(path, extraction):
    document = json.loads(path.read_text())
    assert document["version"] == 1
    assert (document["image"], document["residual"]) == ("../room.exr", "rest.exr")
    assert document["threshold"] == pytest.approx(extraction.threshold)
    first, second = document["lights"]
    assert set(first) == {"direction", "irradiance", "solid_angle", "position"}
    assert set(second) == {"direction", "irradiance", "solid_angle"}
    assert np.linalg.norm(first["position"]) == pytest.approx(2)


def test_it_comes_back_exactly(path, extraction):
    found = read_lights(path)
    assert found.image.resolve() == path.parent.parent / "room.exr"
    assert found.residual == path.parent / "rest.exr"
    assert (found.method, found.share, found.reason) == ("hybrid", extraction.share, extraction.reason)
    for light, expected in zip(found.lights, lights_of(extraction), strict=True):
        for name in ("direction", "irradiance", "solid_angle", "position"):
            assert np.array_equal(getattr(light, name), getattr(expected, name)), name


def test_no_lights_are_a_file_too(tmp_path):
    write_lights(tmp_path / "none.json", LightsFile(tmp_path / "a.exr", "hybrid", 0.0, (), 0.3, "left alone"))
    found = read_lights(tmp_path / "none.json")
    assert (found.lights, found.residual) == ((), None)


@pytest.mark.parametrize(
    ("keys", "value", "message"),
    [
        (["version"], 2, "version is 2, must be 1: written by a newer program"),
        (["method"], "guess", "method is 'guess', must be one of hybrid"),
        (["share"], 1.5, "share is 1.5, must be from 0"),
        (["threshold"], "auto", "threshold is 'auto', must be a number"),
        (["lights"], {}, "lights is {}, must be a list"),
        (["lights", 0], 3, r"lights\[0\] is 3, must be an object"),
        (["lights", 0, "direction"], [1, 1, 0], r"lights\[0\].direction is \[1.0, 1.0, 0.0\], .* length 1"),
        (["lights", 1, "irradiance"], [1, -1, 0], r"lights\[1\].irradiance .* must not be below 0"),
        (["lights", 1, "irradiance"], [1, float("nan"), 0], r"lights\[1\].irradiance .* three numbers"),
        (["lights", 1, "irradiance"], [1, 1], r"lights\[1\].irradiance is \[1, 1\], must be three numbers"),
        (["lights", 0, "solid_angle"], 0, r"lights\[0\].solid_angle is 0, must be above 0"),
        (["lights", 0, "solid_angle"], 13, r"lights\[0\].solid_angle is 13.0, must be at most 4π"),
        (["lights", 0, "position"], "here", r"lights\[0\].position is 'here', must be three numbers"),
        (["lights", 0, "power"], 1, r"lights\[0\].power is an unknown key"),
        (["light"], 1, "light is an unknown key"),
    ],
)
def test_a_wrong_value_is_refused_by_its_key(path, keys, value, message):
    document = json.loads(path.read_text())
    inner = document
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    path.write_text(json.dumps(document))
    with pytest.raises(LightsError, match=message) as refused:
        read_lights(path)
    assert str(refused.value).startswith(f"{path}: ")


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000, '{"version": 1}', "\x00"])
def test_what_is_no_such_file_is_refused(path, text):
    path.write_text(text)
    with pytest.raises(LightsError):
        read_lights(path)


@pytest.mark.parametrize("key", ["version", "image", "method", "share", "reason", "lights"])
def test_a_missing_key_is_named(path, key):
    document = json.loads(path.read_text())
    del document[key]
    path.write_text(json.dumps(document))
    with pytest.raises(LightsError, match=f"{key} is missing"):
        read_lights(path)
