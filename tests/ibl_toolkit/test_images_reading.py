"""Panoramas in, whatever the format: radiance that cannot be, Radiance .hdr, Blender's own panoramas."""

import importlib.util
import pathlib

import cv2
import exr_files
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import ImageError, read_panorama
from expanded_panoramas.ibl_toolkit.images.checking import NEGATIVE_ROUNDING

RGBE_ROUNDING = 1 / 128  # of the largest of a pixel's three values


@pytest.fixture
def exr(tmp_path):
    def write(image):
        return exr_files.write(tmp_path / "room.exr", exr_files.channels(image))

    return write


@pytest.fixture
def hdr(tmp_path):
    def write(image, *flags):
        path = tmp_path / "rööm.hdr"
        path.write_bytes(cv2.imencode(".hdr", np.ascontiguousarray(image[..., ::-1]), flags)[1].tobytes())
        return path

    return write


@pytest.mark.parametrize(("value", "said"), [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "-inf")])
@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_not_finite(exr, value, said, dtype):
    image = exr_files.picture(height=80, dtype=dtype)
    image[70, 5, 1] = image[70, 6] = image[75, 0, 0] = value
    with pytest.raises(ImageError, match=rf"room\.exr: 3 pixels of NaN .* first at \(5, 70\): {said} in G"):
        read_panorama(exr(image))


def test_negative_beyond_rounding(exr):
    image = exr_files.picture(height=80)
    image[66, 3, 2] = -0.25
    with pytest.raises(ImageError, match=r"room\.exr: negative radiance, -0\.25 in B of pixel \(3, 66\)"):
        read_panorama(exr(image))


def test_negative_by_rounding_becomes_zero(exr):
    image = exr_files.picture()
    image[3, 3] = -0.5 * NEGATIVE_ROUNDING * image.mean()
    image[3, 4] = -2e-6
    np.testing.assert_array_equal(read_panorama(exr(image)), np.maximum(image, 0))


def test_darkness_is_a_panorama(exr):
    image = np.zeros((4, 8, 3), dtype=np.float32)
    np.testing.assert_array_equal(read_panorama(exr(image)), image)


@pytest.mark.parametrize("flags", [[], [cv2.IMWRITE_HDR_COMPRESSION, cv2.IMWRITE_HDR_COMPRESSION_NONE]])
@pytest.mark.parametrize("height", [2, 64])
def test_hdr(hdr, flags, height):
    image = exr_files.picture(height=height) + np.float32(0.5)
    image[0, 0] = (1000, 2000, 4000)
    got = read_panorama(hdr(image, *flags))
    assert got.dtype == np.float32
    error = np.abs(got - image) / image.max(axis=-1, keepdims=True)
    assert error.max() < RGBE_ROUNDING


def test_hdr_truncated_anywhere(hdr, capfd):
    path = hdr(exr_files.picture(height=16))
    whole = path.read_bytes()
    for length in [*range(0, len(whole), 16), len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(ImageError, match=r"rööm\.hdr: ") as refusal:
            read_panorama(path)
        assert "\n" not in str(refusal.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"-Y 8 +X 16", b"-Y 8 +X 15", "15 x 8 px.*2:1"),
        (b"-Y 8 +X 16", b"+Y 8 +X 16", "size line"),
        (b"-Y 8 +X 16", b"-Y 99999999 +X 199999998", "asks for"),
        (b"-Y 8 +X 16", b"-Y 9999999999 +X 16", "size line"),
        (b"rle_rgbe", b"rle_xyze", "FORMAT is"),
    ],
)
def test_hdr_headers_that_are_refused(hdr, old, new, message):
    path = hdr(exr_files.picture())
    path.write_bytes(path.read_bytes().replace(old, new))
    with pytest.raises(ImageError, match=message):
        read_panorama(path)


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n" + bytes(100), b"hello"])
def test_other_files(tmp_path, content):
    path = tmp_path / "room.exr"
    path.write_bytes(content)
    with pytest.raises(ImageError, match=r"room\.exr: neither OpenEXR nor Radiance"):
        read_panorama(path)


def test_absent_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nothing\.exr"):
        read_panorama(tmp_path / "nothing.exr")


def test_blenders_own_panoramas():
    spec = importlib.util.find_spec("bpy")
    folders = pathlib.Path(spec.origin).parent.glob("*/datafiles/studiolights/world") if spec else ()
    paths = sorted(path for folder in folders for path in folder.glob("*.exr"))
    if not paths:
        pytest.skip("no bpy wheel")
    for path in paths:
        image = read_panorama(path)
        assert image.shape == (512, 1024, 3)
        assert image.min() >= 0
