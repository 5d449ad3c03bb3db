"""8-bit PNG files: sRGB transfer, exposure, channel order; and back."""

import struct
import zlib

import cv2
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import ImageError, exposure_for, write_png
from expanded_panoramas.ibl_toolkit.images.png import linear_from_srgb, read_png, srgb_from_linear

# IEC 61966-2-1: linear -> 8-bit code
KNOWN = {0.0: 0, 0.0031308: 10, 0.18: 118, 0.5: 188, 1.0: 255, 7.0: 255, -1.0: 0}


def test_known_values(tmp_path):
    image = np.array(list(KNOWN), dtype=np.float32)[None, :, None].repeat(3, axis=2)
    write_png(tmp_path / "a.png", image)
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "a.png"))[0, :, 0], list(KNOWN.values()))


def test_order_of_channels_and_rows(tmp_path):
    image = np.zeros((2, 4, 3), dtype=np.float32)
    image[0, 0] = (1, 0, 0)
    image[1, 3] = (0, 0, 1)
    write_png(tmp_path / "a.png", image)
    got = cv2.imread(str(tmp_path / "a.png"))[..., ::-1]
    np.testing.assert_array_equal(got, image.astype(np.uint8) * 255)


def test_grey(tmp_path):
    write_png(tmp_path / "a.png", np.array([[0.0, 1.0]]))
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED), [[0, 255]])


def test_exposure_is_a_factor(tmp_path):
    write_png(tmp_path / "a.png", np.full((1, 2), 0.09), exposure=2)
    assert cv2.imread(str(tmp_path / "a.png"))[0, 0, 0] == KNOWN[0.18]


def test_transfer_is_continuous_at_its_knee():
    below, above = srgb_from_linear(np.array([0.0031308, 0.0031309]))
    assert 0 < above - below < 1e-5


def test_exposure_brings_the_median_to_mid_grey():
    image = np.full((8, 16, 3), 0.02, dtype=np.float32)
    image[0, :3] = 1e4  # lamps
    image[6:] = 0  # no light from below
    assert exposure_for(image) == pytest.approx(9, rel=1e-6)


def test_darkness_has_an_exposure():
    assert exposure_for(np.zeros((4, 8, 3), dtype=np.float32)) == 1.0


def test_nan_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"a\.png: 1 values of the image are NaN"):
        write_png(tmp_path / "a.png", np.array([[np.nan, 1.0]]))
    assert not (tmp_path / "a.png").exists()


MEMORY = 2**20


def test_every_code_comes_back():
    codes = np.arange(256, dtype=np.float32) / 255
    np.testing.assert_array_equal(np.round(srgb_from_linear(linear_from_srgb(codes)) * 255), np.arange(256))


def test_reading_what_was_written(tmp_path):
    codes = np.random.default_rng(2).integers(0, 256, (4, 8, 3)).astype(np.float32)
    write_png(tmp_path / "a.png", linear_from_srgb(codes / 255))
    got = read_png(tmp_path / "a.png", max_bytes=MEMORY)
    assert got.dtype == np.float32
    np.testing.assert_allclose(got * 255, codes, atol=1e-4)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (np.full((2, 4), 255, np.uint8), (1, 1, 1)),
        (np.full((2, 4, 4), (0, 51, 255, 7), np.uint8), (1, 0.2, 0)),  # B G R and transparency
        (np.full((2, 4, 3), (0, 13107, 65535), np.uint16), (1, 0.2, 0)),
    ],
    ids=["grey", "transparent", "16 bit"],
)
def test_other_kinds_of_png(tmp_path, kind, expected):
    cv2.imwrite(str(tmp_path / "a.png"), kind)
    np.testing.assert_allclose(read_png(tmp_path / "a.png", max_bytes=MEMORY)[1, 3], expected, atol=1e-6)


def test_damaged_png(tmp_path):
    path = tmp_path / "a.png"
    write_png(path, np.random.default_rng(2).uniform(size=(32, 64, 3)))
    whole = path.read_bytes()
    with pytest.raises(ImageError, match=r"a\.png: its header asks for .* GiB of memory \(64 x 32 px\)"):
        read_png(path, max_bytes=12 * 64 * 32 - 1)
    for start in (whole[:20], b"GIF89a" + whole):
        path.write_bytes(start)
        with pytest.raises(ImageError, match="not a PNG file"):
            read_png(path, max_bytes=MEMORY)
    for spoiled, message in (
        (whole[:-20], r"truncated or damaged: \d+ bytes, must be \d+ or more"),
        (whole[:-12], "truncated: .* without an end"),
        (whole[:8] + b"\x7f" + whole[9:], "truncated or damaged"),  # a chunk of 2 GiB
        (whole[:100] + bytes([whole[100] ^ 1]) + whole[101:], "damaged: the check of its chunk at byte"),
        (with_size(whole, 0, 0), "cannot be decoded"),
        (with_size(whole, 64, 99), "cannot be decoded"),
    ):
        path.write_bytes(spoiled)
        with pytest.raises(ImageError, match=rf"a\.png: {message}"):
            read_png(path, max_bytes=MEMORY)


def with_size(file, width, height):
    """A PNG file whose header says another size."""
    header = b"IHDR" + struct.pack(">2I", width, height) + file[24:29]
    return file[:12] + header + struct.pack(">I", zlib.crc32(header)) + file[33:]
