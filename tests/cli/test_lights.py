"""`lights`: what it writes holds the map's light, whatever the input; what it refuses before any work."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import RGBD, read_panorama, write_exr, write_rgbd
from expanded_panoramas.ibl_toolkit.light.extraction import METHODS
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance
from expanded_panoramas.ibl_toolkit.light.lights_file import read_lights
from expanded_panoramas.ibl_toolkit.light.presampling import read_presampling

from .conftest import change_set

CLOSED = 1e-5  # relative: lights and the residual as read back
PRESAMPLED = 1e-6
SIZE = 128, 64
METRES = 0.02
CEILING = 2.7 - 1.5  # of the closed room, above the camera [m]


def lamps():
    """A dim map with two lamps, one of them across the seam; none is flat, so none looks clipped."""
    directions = equirectangular.pixel_directions(*SIZE)
    image = np.random.default_rng(3).uniform(0.1, 0.3, (64, 128, 3)).astype(np.float32)
    for towards, radiance in (((0.6, 0, 0.8), 300), ((-1, 0, 0), 200)):
        cosines = directions @ np.array(towards)
        image[cosines > 0.995] = radiance * np.array([1, 0.8, 0.6])
    image *= np.random.default_rng(4).uniform(0.8, 1.2, (64, 128, 1)).astype(np.float32)
    return image


@pytest.fixture
def image_path(tmp_path):
    image = lamps()
    write_exr(tmp_path / "map.exr", {name: image[..., k] for k, name in enumerate("RGB")})
    return tmp_path / "map.exr"


def assert_closed(folder, image):
    """Σ over the lights + ∫ residual, both from their files, = ∫ map."""
    lights = read_lights(folder / "lights.json").lights
    total = irradiance(read_panorama(folder / "rest.exr")) + sum(light.irradiance for light in lights)
    assert np.allclose(total, irradiance(image), rtol=CLOSED)


@pytest.mark.parametrize("method", METHODS)
def test_lights_and_residual_are_the_map(image_path, panorama, method):
    folder = image_path.parent
    status, out, err = panorama(
        "lights", image_path, "--method", method, "-n", 5, "-o", folder / "lights.json",
        "--residual", folder / "rest.exr", "--json",
    )  # fmt: skip
    assert (status, err) == (0, [])
    result = json.loads(out)
    assert result["method"] == method
    document = json.loads((folder / "lights.json").read_text())
    assert len(document["lights"]) == len(result["lights"]) == 5
    assert all(set(light) == {"direction", "irradiance", "solid_angle"} for light in document["lights"])
    assert (document["image"], document["residual"]) == ("map.exr", "rest.exr")
    assert ("threshold" in document) == (method == "hybrid")
    assert_closed(folder, lamps())


def test_the_map_chooses_by_default_and_says_why(image_path, panorama):
    status, out, err = panorama("lights", image_path, "-o", image_path.parent / "lights.json")
    assert (status, err) == (0, [])
    lines = out.splitlines()
    assert lines[0].startswith("the brightest 0.47 % of the sphere hold")
    assert lines[0].endswith("2 lights")
    assert len(lines) == 3
    assert len(read_lights(image_path.parent / "lights.json").lights) == 2
    assert not list(image_path.parent.glob("*.part*"))


def test_a_flat_map_is_left_alone(tmp_path, panorama):
    image = np.full((64, 128, 3), 0.5, np.float32)
    write_exr(tmp_path / "map.exr", {name: image[..., k] for k, name in enumerate("RGB")})
    command = ["lights", tmp_path / "map.exr", "-o", tmp_path / "lights.json"]
    status, out, _ = panorama(*command, "--residual", tmp_path / "rest.exr")
    assert status == 0
    assert "left alone" in out
    assert np.array_equal(read_panorama(tmp_path / "rest.exr"), image)


def test_a_threshold_by_hand(image_path, panorama):
    command = ["lights", image_path, "-o", image_path.parent / "lights.json", "--json", "--threshold"]
    result = json.loads(panorama(*command, 0.3)[1])
    assert result["threshold"] == pytest.approx(0.3, abs=0.04)
    assert json.loads(panorama(*command, "auto")[1])["threshold"] > 0.6


def test_a_rgbd_panorama_gives_positions(tmp_path, panorama):
    depth = np.full((64, 128), 3, np.float32)
    depth[:, :32] = depth[:, 96:] = np.inf
    write_rgbd(tmp_path / "map.exr", RGBD(lamps(), depth, np.eye(3), 1.5), half=False)
    status, _, err = panorama("lights", tmp_path / "map.exr", "-o", tmp_path / "lights.json")
    assert status == 0
    assert "1 of 2 lights have no depth" in err[0]
    first, second = sorted(
        read_lights(tmp_path / "lights.json").lights, key=lambda light: -light.direction[0]
    )
    assert np.allclose(first.position, (1.8, 0, 2.4), atol=METRES)
    assert second.position is None


@pytest.mark.usefixtures("fresh_blend")
def test_a_set_with_shapes_gives_positions(room, panorama):
    command = ["lights", room / "room.json", "-n", 1, "-o", room / "lights.json"]
    status, _, _ = panorama(*command, "--residual", room / "rest.exr")
    assert status == 0
    (light,) = read_lights(room / "lights.json").lights
    tilt = 0.1  # [m]: the photograph is tilted by a few degrees
    assert light.position[2] == pytest.approx(CEILING, abs=tilt)
    assert_closed(room, read_panorama(room / "room.exr"))


def test_a_set_without_shapes_gives_directions(room, panorama):
    change_set(room / "room.json", shapes=[])
    assert panorama("lights", room / "room.json", "-n", 1, "-o", room / "lights.json")[0] == 0
    found = read_lights(room / "lights.json")
    assert found.lights[0].position is None
    assert found.image == room / "room.exr"


@pytest.mark.parametrize("method", ["hybrid", "median-cut"])
def test_the_presampling_map_is_the_residual_or_the_whole(image_path, panorama, method):
    folder = image_path.parent
    status, _, _ = panorama(
        "lights", image_path, "--method", method, "-n", 5, "-o", folder / "lights.json",
        "--residual", folder / "rest.exr", "--presampling", folder / "samples.exr",
    )  # fmt: skip
    assert status == 0
    found = read_presampling(folder / "samples.exr")
    light = irradiance(read_panorama(folder / "rest.exr")) if method == "hybrid" else irradiance(lamps())
    assert np.allclose(irradiance(found.environment), light, rtol=PRESAMPLED)
    assert np.allclose(found.samples.irradiance.sum(axis=0), light, rtol=PRESAMPLED)


def clipped_sky(path):
    """A bright upper half and a sun of six pixels at 60° that the capture clipped."""
    image = np.where(np.arange(64)[:, None, None] < 32, 1.0, 0.2) * np.ones((64, 128, 3), np.float32)
    image[10:12, 64:67] = 50
    write_exr(path, {name: image[..., k].astype(np.float32) for k, name in enumerate("RGB")})
    return image


@pytest.mark.parametrize(
    ("option", "expected"),
    [(["--irradiance", "30,20,10"], (30, 20, 10)), (["--lit-over-shadow", "5"], (14.7, 14.7, 14.7))],
)
def test_a_clipped_sun_is_told_and_restored(tmp_path, panorama, option, expected):
    """A shadow under a sky of radiance 1 has irradiance π; lit 5 times as brightly: E = 4 π / cos 31°."""
    clipped_sky(tmp_path / "map.exr")
    command = ["lights", tmp_path / "map.exr", "-o", tmp_path / "lights.json", "-n", 1]
    status, _, err = panorama(*command)
    assert status == 0
    assert "looks clipped: 6 pixels" in err[0]
    assert panorama(*command, *option)[0] == 0
    (light,) = read_lights(tmp_path / "lights.json").lights
    assert np.allclose(light.irradiance, expected, rtol=0.02)


REFUSED = [
    (["--method", "random"], "argument --method: invalid choice: 'random'"),
    (["--threshold", "1"], "argument --threshold: '1': must be auto or a share above 0 and below 1"),
    (["--threshold", "nan"], "argument --threshold: 'nan'"),
    (["-n", "-1"], "argument -n/--count: '-1': must be a whole number, at least 0"),
    (["-n", "0", "--method", "penrose"], "map.exr: count is 0; expected a whole number"),
    (["--method", "penrose", "--threshold", "0.5"], "threshold is 0.5: only the method hybrid"),
    (["--residual", "rest.png"], "--residual rest.png: must end in .exr"),
    (["--residual", "nowhere/rest.exr"], "--residual nowhere/rest.exr: folder nowhere does not exist"),
    (["--residual", "r.exr", "--presampling", "r.exr"], "must be different files"),
    (["--irradiance", "5", "--lit-over-shadow", "3"], "both say how bright the light was: give one"),
    (["--irradiance", "1,2"], "argument --irradiance: '1,2': must be a number, or R,G,B"),
    (["--lit-over-shadow", "x"], "argument --lit-over-shadow: 'x'"),
    (["--irradiance", "1e-9"], "the clipped light brings"),
]


@pytest.mark.parametrize(("option", "message"), REFUSED)
def test_bad_options_are_one_line_and_leave_no_file(tmp_path, monkeypatch, panorama, option, message):
    monkeypatch.chdir(tmp_path)
    clipped_sky(tmp_path / "map.exr")
    status, out, err = panorama("lights", "map.exr", "-o", "lights.json", *option)
    assert (status, out, len(err)) == (2, "", 1)
    assert message in err[0]
    assert [path.name for path in tmp_path.iterdir()] == ["map.exr"]


def test_bad_inputs_are_one_line(tmp_path, panorama):
    (tmp_path / "set.json").write_text("{}")
    (tmp_path / "text.exr").write_text("not an image")
    write_exr(tmp_path / "black.exr", dict.fromkeys("RGB", np.zeros((4, 8), np.float32)))
    for name, message in (
        ("none.exr", "No such file"),
        ("none.json", "No such file"),
        ("set.json", "version is missing"),
        ("text.exr", "neither OpenEXR nor Radiance"),
        ("black.exr", "the light map is black"),
    ):
        status, out, err = panorama("lights", tmp_path / name, "-o", tmp_path / "lights.json")
        assert (status, out, len(err)) == (2, "", 1), name
        assert message in err[0]
        assert str(tmp_path / name) in err[0]
    assert not (tmp_path / "lights.json").exists()


def test_the_map_is_not_overwritten(image_path, panorama):
    before = image_path.read_bytes()
    command = ["lights", image_path, "-o", image_path.parent / "lights.json", "--residual", image_path]
    status, _, err = panorama(*command)
    assert status == 2
    assert "would overwrite an input" in err[0]
    assert image_path.read_bytes() == before


def test_a_failure_while_writing_leaves_none_of_the_files(image_path, panorama, monkeypatch):
    from expanded_panoramas.cli import lights

    def fail(*_):
        raise OSError(28, "No space left on device", "lights.json")

    monkeypatch.setattr(lights, "write_lights", fail)
    folder = image_path.parent
    command = ["lights", image_path, "-o", folder / "lights.json", "--residual", folder / "rest.exr"]
    status, _, err = panorama(*command)
    assert (status, err) == (2, ["panorama lights: lights.json: No space left on device"])
    assert [path.name for path in folder.iterdir()] == ["map.exr"]


def test_a_batch_writes_one_file_for_each(image_path, panorama):
    folder = image_path.parent
    assert panorama("batch", "lights", image_path, "--into", folder / "out")[0] == 0
    assert len(read_lights(folder / "out" / "map_lights.json").lights) == 2
    command = ["batch", "lights", image_path, "--into", folder / "out", "--residual", folder / "rest.exr"]
    status, _, err = panorama(*command)
    assert status == 2
    assert "not in a batch" in err[0]
