"""Pre-sampling maps keep the light, come back from their file, and odd files are refused."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import ImageError, read_panorama, write_exr
from expanded_panoramas.ibl_toolkit.light import presampling
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance
from expanded_panoramas.ibl_toolkit.light.presampling import (
    PresamplingMap,
    read_presampling,
    write_presampling,
)
from expanded_panoramas.ibl_toolkit.light.samples import samples_from_sites

ENERGY = 1e-6
SHAPE = 48, 96


@pytest.fixture
def image():
    return np.random.default_rng(1).lognormal(0, 1, (*SHAPE, 3)).astype(np.float32)


@pytest.fixture
def samples(image):
    return samples_from_sites(image, np.random.default_rng(2).normal(size=(40, 3)))


@pytest.mark.parametrize("width", [96, 48, 32, 6, 2])
def test_the_environment_holds_all_the_light_at_any_width(image, samples, width):
    environment = PresamplingMap.from_samples(samples, width).environment
    assert environment.shape == (width // 2, width, 3)
    assert np.allclose(irradiance(environment), irradiance(image), rtol=ENERGY)


def test_each_region_shows_its_mean_radiance(image, samples):
    presampled = PresamplingMap.from_samples(samples)
    for k in (0, 7, 39):
        inside = samples.partition == k
        assert np.allclose(irradiance(presampled.environment, inside), irradiance(image, inside), rtol=ENERGY)
        assert np.ptp(presampled.environment[inside], axis=0).max() == 0


def test_what_is_outside_the_mask_is_black(image):
    mask = np.zeros(SHAPE, bool)
    mask[10:20, 30:50] = True
    samples = samples_from_sites(image, [[1, 0, 0.3], [1, 0.3, 0.5]], mask)
    presampled = PresamplingMap.from_samples(samples)
    assert (presampled.environment[~mask] == 0).all()
    assert (presampled.environment[mask] > 0).all()


@pytest.mark.parametrize("width", [None, 24])
def test_it_comes_back_from_its_file(tmp_path, samples, width):
    written = PresamplingMap.from_samples(samples, width)
    write_presampling(tmp_path / "map.exr", written)
    read = read_presampling(tmp_path / "map.exr")
    assert np.array_equal(read.environment, written.environment)
    for name in ("directions", "irradiance", "solid_angles", "partition"):
        assert np.array_equal(getattr(read.samples, name), getattr(written.samples, name)), name
    assert np.allclose(read.samples.uv, written.samples.uv)
    assert np.array_equal(read_panorama(tmp_path / "map.exr"), written.environment)


@pytest.mark.parametrize("width", [0, 5, 64, 192])
def test_a_width_that_does_not_divide_the_map_is_refused(samples, width):
    with pytest.raises(ValueError, match=f"width is {width}: must divide the map's width, 96"):
        PresamplingMap.from_samples(samples, width)


def good_fields():
    return {"direction": [[1, 0, 0], [0, 1, 0]], "irradiance": [[1, 1, 1]] * 2, "solid_angle": [1, 2]}


def write_fields(path, text, region=0, **channels):
    grey = np.ones((2, 4), np.float32)
    channels = {**dict.fromkeys("RGB", grey), "region": np.full((2, 4), region, np.uint32), **channels}
    write_exr(path, {k: v for k, v in channels.items() if v is not None}, {presampling.SAMPLES: text})


def test_the_file_that_the_refused_ones_differ_from_is_read(tmp_path):
    write_fields(tmp_path / "map.exr", json.dumps(good_fields()), region=2)
    assert len(read_presampling(tmp_path / "map.exr").samples) == 2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"direction": [[1, 0, 0], [0, 0, 0]]}, "sample 1 is impossible: must have directions of length 1"),
        ({"direction": [[1, 0, 0], [0, 1]]}, "no list of samples"),
        ({"direction": [[float("nan"), 0, 0], [0, 1, 0]]}, "sample 0 is impossible"),
        ({"irradiance": [[1, 1, 1], [1, -1, 1]]}, "sample 1 .* finite irradiance from 0"),
        ({"irradiance": [[1, 1, 1], [1, 10**400, 1]]}, "no list of samples"),
        ({"irradiance": [[1, 1], [1, 1]]}, r"irradiance \(2, 2\)"),
        ({"solid_angle": [1, 13]}, "sample 1 .* solid angles above 0"),
        ({"solid_angle": []}, r"solid angles \(0,\)"),
        ({"solid_angle": None}, r"solid angles \(\)"),
    ],
)
def test_impossible_samples_are_refused(tmp_path, changes, message):
    path = tmp_path / "map.exr"
    write_fields(path, json.dumps({**good_fields(), **changes}))
    with pytest.raises(ImageError, match=message) as refused:
        read_presampling(path)
    assert str(path) in str(refused.value)


@pytest.mark.parametrize("text", ["", "[" * 100_000, "[]", "3", '{"direction": []}'])
def test_a_header_that_holds_no_samples_is_refused(tmp_path, text):
    write_fields(tmp_path / "map.exr", text)
    with pytest.raises(ImageError, match="holds no list of samples"):
        read_presampling(tmp_path / "map.exr")


def test_other_files_are_refused(tmp_path):
    path, text = tmp_path / "map.exr", json.dumps(good_fields())
    grey = np.ones((2, 4), np.float32)
    write_exr(path, dict.fromkeys("RGB", grey))
    with pytest.raises(ImageError, match="unsigned integers region"):
        read_presampling(path)
    write_fields(path, text, R=grey.astype(np.float16))
    with pytest.raises(ImageError, match="32-bit floats R G B"):
        read_presampling(path)
    write_fields(path, text, region=3)
    with pytest.raises(ImageError, match="region 3 has no sample: there are 2"):
        read_presampling(path)
    write_fields(path, text, G=np.full((2, 4), np.nan, np.float32))
    with pytest.raises(ImageError, match="NaN"):
        read_presampling(path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(ImageError, match="truncated"):
        read_presampling(path)


def test_a_map_that_is_no_panorama_is_not_written(tmp_path, samples):
    narrow = samples_from_sites(np.ones((48, 48, 3), np.float32), [[1, 0, 0]])
    with pytest.raises(ImageError, match="must be 2:1"):
        write_presampling(tmp_path / "map.exr", PresamplingMap.from_samples(narrow))
    assert not list(tmp_path.iterdir())
