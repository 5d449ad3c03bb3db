"""RGB-D panoramas out and in again, and what is refused either way."""

import dataclasses

import exr_files
import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.ibl_toolkit.images import RGBD, ImageError, read_rgbd, write_rgbd

EXACT = 1e-15


@pytest.fixture
def path(tmp_path):
    return tmp_path / "map.exr"


def rotation():
    a, b = 0.3, 1.1
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return about_z @ about_x


def example(height=8):
    depth = np.random.default_rng(3).uniform(0.1, 100, (height, 2 * height)).astype(np.float32)
    depth[0] = np.inf
    return RGBD(exr_files.picture(height), depth, rotation(), 1.6180339887498949)


@pytest.mark.parametrize("half", [True, False, None])
def test_round_trip(path, half):
    rgbd = example()
    write_rgbd(path, rgbd, half=half)
    got = read_rgbd(path)
    assert got.depth.dtype == got.image.dtype == np.float32
    np.testing.assert_array_equal(got.depth, rgbd.depth)
    np.testing.assert_array_equal(got.image, rgbd.image)  # made of values that halves hold
    np.testing.assert_allclose(got.world_from_panorama, rgbd.world_from_panorama, atol=EXACT)
    assert got.camera_height == rgbd.camera_height


def test_header_as_other_programs_see_it(path):
    write_rgbd(path, example())
    with OpenEXR.File(str(path), separate_channels=True) as file:
        types = {name: channel.pixels.dtype for name, channel in file.channels().items()}
        matrix, camera_height = (
            file.header()[f"panorama.{n}"] for n in ("worldFromPanorama", "cameraHeight")
        )
    assert types == {"R": np.float16, "G": np.float16, "B": np.float16, "Z": np.float32}
    np.testing.assert_array_equal(matrix, rotation())
    assert float(camera_height[0]) == 1.6180339887498949


def test_radiance_beyond_half_floats(path):
    rgbd = example()
    rgbd.image[2, 3, 1] = 1e5
    write_rgbd(path, rgbd)
    np.testing.assert_array_equal(read_rgbd(path).image, rgbd.image)
    with pytest.raises(ImageError, match=r"map\.exr: radiance up to 100000 does not fit half floats"):
        write_rgbd(path, rgbd, half=True)


@pytest.mark.parametrize("value", [np.nan, 0.0, -1.0, -np.inf])
def test_impossible_depth(path, value):
    rgbd = example()
    rgbd.depth[5, 7] = value
    with pytest.raises(ImageError, match=rf"map\.exr: 1 depths .* \(7, 5\): {value}"):
        write_rgbd(path, rgbd)
    assert not path.exists()
    attributes = {"panorama.worldFromPanorama": np.eye(3), "panorama.cameraHeight": 1.5}
    exr_files.write(path, {**exr_files.channels(rgbd.image), "Z": rgbd.depth}, **attributes)
    with pytest.raises(ImageError, match=rf"map\.exr: 1 depths .* \(7, 5\): {value}"):
        read_rgbd(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"camera_height": 0.0}, "camera_height 0.0 m"),
        ({"camera_height": np.nan}, "camera_height nan m"),
        ({"world_from_panorama": np.diag([1.0, 1, -1])}, "rotation"),
        ({"world_from_panorama": 2 * np.eye(3)}, "rotation"),
        ({"world_from_panorama": np.full((3, 3), np.nan)}, "rotation"),
        ({"world_from_panorama": np.eye(4)}, "rotation"),
        ({"depth": np.ones((4, 8), dtype="f")}, "of one size"),
        ({"image": np.full((8, 16, 3), np.nan, dtype="f")}, "NaN"),
    ],
)
def test_what_is_not_written(path, change, message):
    with pytest.raises(ImageError, match=message):
        write_rgbd(path, dataclasses.replace(example(), **change))
    assert not path.exists()


def test_writing_leaves_the_image_alone(path):
    rgbd = example()
    rgbd.image[1, 1] = -1e-6
    write_rgbd(path, rgbd)
    assert rgbd.image[1, 1, 0] == np.float32(-1e-6)
    assert read_rgbd(path).image[1, 1, 0] == 0


@pytest.mark.parametrize("z", [None, np.float16])
def test_depth_must_be_there_in_32_bits(path, z):
    pixels = exr_files.channels(exr_files.picture())
    if z:
        pixels["Z"] = pixels["R"].astype(z)
    exr_files.write(path, pixels)
    with pytest.raises(ImageError, match=r"map\.exr: a 32-bit float channel Z .* found B, G, R"):
        read_rgbd(path)


@pytest.mark.parametrize("missing", ["panorama.worldFromPanorama", "panorama.cameraHeight"])
def test_attributes_must_be_there(path, missing):
    attributes = {"panorama.worldFromPanorama": np.eye(3), "panorama.cameraHeight": 1.5}
    pixels = {**exr_files.channels(exr_files.picture()), "Z": np.ones((8, 16), dtype="f")}
    exr_files.write(path, pixels, **attributes)
    assert read_rgbd(path).camera_height == 1.5
    exr_files.write(path, pixels, **{name: v for name, v in attributes.items() if name != missing})
    with pytest.raises(ImageError, match=f"attribute {missing} is missing"):
        read_rgbd(path)
    exr_files.write(path, pixels, **{**attributes, missing: "north"})
    with pytest.raises(ImageError, match=f"attribute {missing} is 'north'"):
        read_rgbd(path)


def test_truncated(path):
    write_rgbd(path, example())
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(ImageError, match="truncated"):
        read_rgbd(path)
