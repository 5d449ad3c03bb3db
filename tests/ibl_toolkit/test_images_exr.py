"""OpenEXR panoramas in: storages, channel names, windows; and what is refused by header or file."""

import gc
import resource
import struct
import sys

import cv2
import exr_files
import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.ibl_toolkit.images import ImageError, read_panorama, write_exr
from expanded_panoramas.ibl_toolkit.images.exr_header import read_header

HALF_ROUNDING = 2**-11
MEMORY_FOR_A_REFUSAL = 64 * 2**20  # [bytes]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "room.exr"


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("tiles", [None, (5, 3)])
@pytest.mark.parametrize("compression", ["NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24"])
def test_storages(path, dtype, tiles, compression):
    image = exr_files.picture(height=40)
    compression = getattr(OpenEXR, compression + "_COMPRESSION")
    exr_files.write(path, exr_files.channels(image.astype(dtype)), tiles=tiles, compression=compression)
    got = read_panorama(path)
    assert got.dtype == np.float32
    assert got.flags.c_contiguous
    np.testing.assert_array_equal(got, image)


@pytest.mark.parametrize("compression", ["B44", "B44A", "DWAA", "DWAB"])
def test_lossy_storages(path, compression):
    image = np.ones((40, 80, 3), dtype=np.float16)
    exr_files.write(
        path, exr_files.channels(image), compression=getattr(OpenEXR, compression + "_COMPRESSION")
    )
    np.testing.assert_allclose(read_panorama(path), 1, rtol=0.01)


@pytest.mark.parametrize(
    "names",
    [
        "RGB",
        "rgb",
        "RGBA",
        "RGBAZ",
        ("red", "green", "blue"),
        ("Red", "Green", "Blue", "Z"),
        ("layer.R", "layer.G", "layer.B"),
        ("layer.R", "layer.G", "layer.B", "layer.A", "depth.Z"),
        ("ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Normal.X"),
        ("beauty.r", "beauty.g", "beauty.b", "gi.r", "gi.g", "gi.b"),
        ("R", "G", "B", "gi.R", "gi.G", "gi.B"),
    ],
    ids=lambda names: ".".join(names),
)
@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_channel_names(path, names, dtype):
    image = exr_files.picture()
    decoys = exr_files.picture(seed=1)
    pixels = exr_files.channels(image, names[:3])
    pixels.update({name: decoys[..., 0].copy() for name in names[3:]})
    exr_files.write(path, {name: array.astype(dtype) for name, array in pixels.items()})
    np.testing.assert_array_equal(read_panorama(path), image)


def test_colour_grouped_by_the_library(path):
    image = exr_files.picture()
    exr_files.write(path, {"RGB": image})
    np.testing.assert_array_equal(read_panorama(path), image)


def test_mixed_types(path):
    image = exr_files.picture()
    pixels = exr_files.channels(image)
    exr_files.write(path, {"R": pixels["R"], "G": pixels["G"].astype(np.float16), "B": pixels["B"]})
    np.testing.assert_array_equal(read_panorama(path), image)


@pytest.mark.parametrize("names", ["Y", "YA", ["grey.Y"]])
def test_luminance_alone_is_grey(path, names):
    image = exr_files.picture()
    exr_files.write(path, exr_files.channels(image, names))
    np.testing.assert_array_equal(read_panorama(path), image[..., :1].repeat(3, axis=2))


@pytest.mark.parametrize("tiles", [None, (16, 16)])
@pytest.mark.parametrize("order", [("depth", "beauty"), ("beauty", "depth")])
def test_multipart(path, tiles, order):
    image = exr_files.picture(height=20)
    pixels = {"depth": {"Z": image[..., 0].copy()}, "beauty": exr_files.channels(image)}
    exr_files.write_parts(path, {name: pixels[name] for name in order}, tiles)
    np.testing.assert_array_equal(read_panorama(path), image)


def test_first_part_with_colour_is_the_picture(path):
    first, second = exr_files.picture(seed=1), exr_files.picture(seed=2)
    exr_files.write_parts(path, {"a": exr_files.channels(first), "b": exr_files.channels(second)})
    np.testing.assert_array_equal(read_panorama(path), first)


@pytest.mark.parametrize("shift", [(0, 0), (3, 2), (-3, 2), (-100, 50)])
def test_display_window_is_the_picture(path, shift):
    """The data window is moved against the display window: what sticks out is cut off, the rest is black."""
    image, (dx, dy) = exr_files.picture(), shift
    exr_files.write(path, exr_files.channels(image), dataWindow=exr_files.window(dx, dy, dx + 15, dy + 7))
    exr_files.patch_window(path, "displayWindow", (0, 0, 15, 7))
    expected = np.zeros_like(image)
    for j, i in np.ndindex(8, 16):
        if 0 <= j - dy < 8 and 0 <= i - dx < 16:
            expected[j, i] = image[j - dy, i - dx]
    np.testing.assert_array_equal(read_panorama(path), expected)


def test_cropped_and_overscanned_data_windows(path):
    image = exr_files.picture(height=4)
    exr_files.write(path, exr_files.channels(image), dataWindow=exr_files.window(4, 3, 11, 6))
    exr_files.patch_window(path, "displayWindow", (0, 0, 15, 7))
    assert read_panorama(path).shape == (8, 16, 3)
    np.testing.assert_array_equal(read_panorama(path)[3:7, 4:12], image)
    assert read_panorama(path).sum() == pytest.approx(image.sum(), rel=1e-6)
    exr_files.patch_window(path, "displayWindow", (5, 3, 8, 4))
    np.testing.assert_array_equal(read_panorama(path), image[0:2, 1:5])


@pytest.mark.parametrize(
    ("names", "found"),
    [
        ("RG", "G, R"),
        ("AZ", "A, Z"),
        ("XYZ", "X, Y, Z"),
        (["Y", "RY", "BY"], "BY, RY, Y"),
        ("RGY", "G, R, Y"),
    ],
)
def test_missing_channels_are_named(path, names, found):
    exr_files.write(path, exr_files.channels(exr_files.picture(), names))
    with pytest.raises(ImageError, match=rf"room\.exr: channels R G B .* found {found}"):
        read_panorama(path)


def test_ambiguous_layers_are_named(path):
    names = [f"{layer}.{c}" for layer in ("left", "right") for c in "RGB"]
    exr_files.write(path, exr_files.channels(exr_files.picture(), names))
    with pytest.raises(ImageError, match="layers left, right"):
        read_panorama(path)


def test_uint_colour_is_refused(path):
    exr_files.write(path, exr_files.channels(exr_files.picture().astype(np.uint32)))
    with pytest.raises(ImageError, match="of type uint"):
        read_panorama(path)


def test_not_two_to_one(path):
    exr_files.write(path, exr_files.channels(np.ones((8, 15, 3), dtype=np.float32)))
    with pytest.raises(ImageError, match=r"room\.exr: 15 x 8 px.*2:1"):
        read_panorama(path)


@pytest.mark.parametrize("tiles", [None, (16, 16)])
@pytest.mark.parametrize("multipart", [False, True])
def test_truncated_anywhere(path, tiles, multipart, capfd):
    """Always refused, in one line, and the library has nothing to print."""
    pixels = exr_files.channels(exr_files.picture(height=20))
    if multipart:
        exr_files.write_parts(path, {"a": pixels, "b": {"Z": pixels["R"]}}, tiles)
    else:
        exr_files.write(path, pixels, tiles=tiles)
    whole = path.read_bytes()
    for length in [*range(0, 600, 5), *range(600, len(whole), 97), len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(ImageError, match=r"room\.exr: ") as refusal:
            read_panorama(path)
        assert "\n" not in str(refusal.value)
    assert capfd.readouterr() == ("", "")
    path.write_bytes(whole)
    read_panorama(path)


def test_truncation_names_the_sizes(path):
    exr_files.write(path, exr_files.channels(exr_files.picture()))
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    with pytest.raises(ImageError, match=f"truncated: {len(whole) - 1} bytes, must be {len(whole)}"):
        read_panorama(path)


def test_unfinished_file(path):
    exr_files.write(path, exr_files.channels(exr_files.picture()))
    data = bytearray(path.read_bytes())
    with open(path, "rb") as file:
        table = file.read().index(b"screenWindowWidth")  # the last attribute but `type`
    table = data.index(b"scanlineimage", table) + len(b"scanlineimage") + 1
    data[table : table + 8] = bytes(8)
    path.write_bytes(data)
    with pytest.raises(ImageError, match="not finished"):
        read_panorama(path)


def test_damaged_pixels(path):
    exr_files.write(path, exr_files.channels(exr_files.picture(height=64)))
    data = bytearray(path.read_bytes())
    data[-4000:-2000] = bytes(2000)
    path.write_bytes(data)
    with pytest.raises(ImageError, match="cannot be decoded"):
        read_panorama(path)


@pytest.mark.parametrize(
    "hostile",
    [(0, 0, 2**20 - 1, 2**19 - 1), (0, 0, 2**31 - 1, 2**30 - 1), (-(2**31), -(2**31), 2**31 - 1, 2**31 - 1)],
)
@pytest.mark.parametrize("name", ["dataWindow", "displayWindow"])
def test_hostile_window_is_refused_before_it_costs_memory(path, name, hostile):
    exr_files.write(path, exr_files.channels(exr_files.picture()))
    exr_files.patch_window(path, name, hostile)
    gc.collect()
    before = peak_memory()
    with pytest.raises(ImageError, match=r"room\.exr: its header asks for .* GiB .*the limit is 4 GiB"):
        read_panorama(path)
    assert peak_memory() - before < MEMORY_FOR_A_REFUSAL


def test_hostile_tiles_are_refused_before_they_cost_memory(path):
    exr_files.write(path, exr_files.channels(exr_files.picture()), tiles=(16, 16))
    data = path.read_bytes()
    path.write_bytes(data.replace(struct.pack("<2I", 16, 16), struct.pack("<2I", 2**20, 2**20)))
    before = peak_memory()
    with pytest.raises(ImageError, match="its header asks for"):
        read_panorama(path)
    assert peak_memory() - before < MEMORY_FOR_A_REFUSAL


def test_limit_can_be_set(path):
    exr_files.write(path, exr_files.channels(exr_files.picture()))
    assert read_panorama(path, max_bytes=8 * 16 * 12).shape == (8, 16, 3)
    with pytest.raises(ImageError, match="asks for"):
        read_panorama(path, max_bytes=8 * 16 * 12 - 1)


def test_all_parts_count_for_the_limit(path):
    pixels = exr_files.channels(exr_files.picture())
    exr_files.write_parts(path, {"a": pixels, "b": pixels})
    with pytest.raises(ImageError, match="asks for"):
        read_panorama(path, max_bytes=8 * 16 * 12)


@pytest.mark.parametrize(
    ("window", "message"),
    [((0, 0, -2, 7), r"dataWindow \(0, 0, -2, 7\) is empty"), ((5, 5, 4, 4), "is empty")],
)
def test_empty_window(path, window, message):
    exr_files.write(path, exr_files.channels(exr_files.picture()))
    exr_files.patch_window(path, "dataWindow", window)
    with pytest.raises(ImageError, match=message):
        read_panorama(path)


def test_any_damaged_header_is_refused_or_read(path):
    """Random bytes in the header: an ImageError or an image, nothing else."""
    exr_files.write(path, exr_files.channels(exr_files.picture()))
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    refused = 0
    for _ in range(300):
        data = bytearray(whole)
        data[rng.integers(4, 400)] = rng.integers(256)
        path.write_bytes(data)
        try:
            read_panorama(path, max_bytes=2**24)
        except ImageError:
            refused += 1
    assert refused > 50


def test_header_agrees_with_the_library(path):
    exr_files.write(path, exr_files.channels(exr_files.picture(), "RGBA"), tiles=(8, 4))
    (part,) = read_header(path)
    assert [channel.name for channel in part.channels] == ["A", "B", "G", "R"]
    assert part.data_window == part.display_window == (0, 0, 15, 7)
    assert part.tile_size == (8, 4)
    assert part.decoded_bytes == 8 * 16 * 16


def test_write_exr_round_trip(path):
    image = exr_files.picture()
    write_exr(path, exr_files.channels(image), {"owner": "nobody"})
    np.testing.assert_array_equal(read_panorama(path), image)
    with OpenEXR.File(str(path), header_only=True) as file:
        assert file.header()["owner"] == "nobody"


@pytest.mark.parametrize("bad", [np.ones((4, 8)), np.ones((4, 8), dtype=np.uint8)])
def test_write_exr_refuses_other_types(path, bad):
    with pytest.raises(ValueError, match="channel R is of type"):
        write_exr(path, {"R": bad})


def test_write_exr_refuses_different_shapes(path):
    with pytest.raises(ValueError, match="must all be"):
        write_exr(path, {"R": np.ones((4, 8), dtype="f"), "G": np.ones((4, 9), dtype="f")})


def test_opencv_reads_what_we_write(path, monkeypatch):
    """Another implementation's view, where this build of OpenCV has OpenEXR."""
    monkeypatch.setenv("OPENCV_IO_ENABLE_OPENEXR", "1")
    image = exr_files.picture()
    write_exr(path, exr_files.channels(image))
    try:
        got = cv2.imread(str(path), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR)
    except cv2.error:
        pytest.skip("OpenCV without OpenEXR")
    if got is None:
        pytest.skip("OpenCV without OpenEXR")
    np.testing.assert_allclose(got[..., ::-1], image, rtol=HALF_ROUNDING)


def peak_memory():
    """Largest resident size so far [bytes]."""
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
