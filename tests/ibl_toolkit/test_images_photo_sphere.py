"""What JPEG and PNG panoramas tell viewers: written, read back, read by another program, and refused."""

import struct
import zlib

import cv2
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import (
    ImageError,
    PhotoSphere,
    read_photo_sphere,
    write_jpeg,
    write_png,
)
from expanded_panoramas.ibl_toolkit.images.photo_sphere import pose_of, sphere_from_xmp

WRITERS = {".jpg": write_jpeg, ".png": write_png}
BOTH = pytest.mark.parametrize("suffix", WRITERS)
ANGLE = 1e-4  # [degrees] as they are written


def turn(axis, degrees):
    return cv2.Rodrigues(np.radians(degrees) * np.array(axis, float))[0]


IMAGE = np.linspace(0, 1, 8 * 16 * 3, dtype=np.float32).reshape(8, 16, 3)


@pytest.mark.parametrize(
    ("rotation", "pose"),
    [
        (np.eye(3), (90, 0, 0)),  # looks along +x, the east
        (turn((0, 0, 1), 90), (0, 0, 0)),  # along +y, the north
        (turn((0, 0, 1), -90), (180, 0, 0)),
        (turn((0, 1, 0), -30), (90, 30, 0)),  # looks up
        (turn((1, 0, 0), 20), (90, 0, 20)),  # its left goes up: clockwise
        (turn((0, 0, 1), 40) @ turn((0, 1, 0), -90), (50, 90, 0)),
    ],
)
def test_poses_of_known_turns(rotation, pose):
    np.testing.assert_allclose(pose_of(rotation), pose, atol=1e-9)


def test_a_pose_gives_its_rotation_back():
    for k in range(50):
        rotation = cv2.Rodrigues(np.random.default_rng(k).uniform(-3, 3, 3))[0]
        back = PhotoSphere.whole(8, 4, rotation).world_from_panorama
        np.testing.assert_allclose(back, rotation, atol=1e-9)


@BOTH
def test_written_and_read_back(tmp_path, suffix):
    rotation = turn((1, 2, 3), 25)
    sphere = PhotoSphere.whole(16, 8, rotation)
    WRITERS[suffix](tmp_path / f"a{suffix}", IMAGE, sphere=sphere)
    got = read_photo_sphere(tmp_path / f"a{suffix}")
    assert (got.full_size, got.size, got.corner) == ((16, 8), (16, 8), (0, 0))
    np.testing.assert_allclose(got.pose_deg, sphere.pose_deg, atol=ANGLE)


@BOTH
def test_the_pixels_are_the_same(tmp_path, suffix):
    WRITERS[suffix](tmp_path / f"a{suffix}", IMAGE)
    WRITERS[suffix](tmp_path / f"b{suffix}", IMAGE, sphere=PhotoSphere.whole(16, 8))
    a, b = (cv2.imread(str(tmp_path / f"{name}{suffix}")) for name in "ab")
    np.testing.assert_array_equal(a, b)
    assert read_photo_sphere(tmp_path / f"a{suffix}") is None


def test_a_jpeg_is_near_its_image(tmp_path):
    write_jpeg(tmp_path / "a.jpg", np.full((16, 32, 3), 0.36, np.float32), exposure=0.5)
    assert np.abs(cv2.imread(str(tmp_path / "a.jpg")).astype(int) - 118).max() <= 1


@BOTH
def test_another_program_finds_it(tmp_path, suffix):
    image = pytest.importorskip("PIL.Image")
    WRITERS[suffix](tmp_path / f"a{suffix}", IMAGE, sphere=PhotoSphere.whole(16, 8, np.eye(3)))
    with image.open(tmp_path / f"a{suffix}") as opened:
        opened.load()
        packet = opened.info["xmp" if suffix == ".jpg" else "XML:com.adobe.xmp"]
    packet = packet.encode() if isinstance(packet, str) else packet
    assert b'GPano:ProjectionType="equirectangular"' in packet
    assert b'GPano:FullPanoWidthPixels="16"' in packet
    assert b'GPano:PoseHeadingDegrees="90.0000"' in packet


def packet_of(properties, inner=""):
    return (
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><r:RDF xmlns:r="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        f'<r:Description xmlns:g="http://ns.google.com/photos/1.0/panorama/" {properties}>{inner}'
        "</r:Description></r:RDF></x:xmpmeta>"
    ).encode()


CROPPED = (
    'g:FullPanoWidthPixels="16" g:FullPanoHeightPixels="8" g:CroppedAreaImageWidthPixels="12" '
    'g:CroppedAreaImageHeightPixels="6" g:CroppedAreaLeftPixels="4" g:CroppedAreaTopPixels="1"'
)


def test_other_programs_packets():
    """Properties as elements, another prefix, a part of a panorama, a pose without roll."""
    projection = "<g:ProjectionType>equirectangular</g:ProjectionType>"
    heading = "<g:PoseHeadingDegrees>350.5</g:PoseHeadingDegrees>"
    sphere = sphere_from_xmp(packet_of(CROPPED, projection + heading))
    assert (sphere.full_size, sphere.size, sphere.corner) == ((16, 8), (12, 6), (4, 1))
    assert sphere.pose_deg == (350.5, 0.0, 0.0)
    assert sphere_from_xmp(packet_of("")) is None


PROJECTION = 'g:ProjectionType="equirectangular" '


@pytest.mark.parametrize(
    ("packet", "message"),
    [
        (b"<a", "XMP that cannot be read"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "a DOCTYPE, which could define entities"),
        (packet_of('g:ProjectionType="cylindrical"'), "projection 'cylindrical' must be equirectangular"),
        (packet_of(PROJECTION), "FullPanoWidthPixels is None, must be a whole number"),
        (
            packet_of(PROJECTION + CROPPED.replace('"12"', '"13"')),
            r"13 x 6 px at \(4, 1\) must lie within 16 x 8",
        ),
        (packet_of(PROJECTION + CROPPED + ' g:PoseHeadingDegrees="nan"'), "must be three finite angles"),
        (b"<a>" + b" " * 2**20 + b"</a>", "XMP of 1048583 bytes, the limit is 1048576"),
    ],
)
def test_unsound_packets_are_refused(packet, message):
    with pytest.raises(ImageError, match=message):
        sphere_from_xmp(packet)


def compressed(packet):
    return png_with(b"XML:com.adobe.xmp\0\1\0en\0title\0" + zlib.compress(packet))


def png_with(content):
    chunk = struct.pack(">I4s", len(content), b"iTXt") + content + bytes(4)
    return b"\x89PNG\r\n\x1a\n" + chunk + struct.pack(">I4sI", 0, b"IEND", 0)


def test_compressed_xmp_is_read(tmp_path):
    (tmp_path / "a.png").write_bytes(compressed(packet_of(PROJECTION + CROPPED)))
    assert read_photo_sphere(tmp_path / "a.png").size == (12, 6)
    (tmp_path / "a.png").write_bytes(compressed(b" " * 2**24))
    with pytest.raises(ImageError, match="XMP of 1048577 bytes, the limit is 1048576"):
        read_photo_sphere(tmp_path / "a.png")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"GIF89a", r"a\.jpg: neither JPEG nor PNG"),
        (b"\xff\xd8\xff\xe1\xff\xff", r"a\.jpg: truncated: 6 bytes, without a scan"),
        (png_with(b"XML:com.adobe.xmp\0\1\0\0\0abc"), r"a\.jpg: damaged: its compressed XMP"),
        (b"\xff\xd8\x00\xe1\x00\x10", r"a\.jpg: damaged: no marker at byte 2"),
        (
            b"\x89PNG\r\n\x1a\n" + struct.pack(">I4s", 9, b"IHDR"),
            r"a\.jpg: truncated: 16 bytes, without an end",
        ),
    ],
)
def test_unsound_files_are_refused(tmp_path, data, message):
    (tmp_path / "a.jpg").write_bytes(data)
    with pytest.raises(ImageError, match=message):
        read_photo_sphere(tmp_path / "a.jpg")


def test_nan_and_giants_are_refused(tmp_path):
    with pytest.raises(ValueError, match="1 values of the image are NaN"):
        write_jpeg(tmp_path / "a.jpg", np.array([[[np.nan, 1, 1]]]))
    with pytest.raises(ValueError, match="66000 x 1 px, a JPEG's sides end at 65500 px"):
        write_jpeg(tmp_path / "a.jpg", np.zeros((1, 66000, 3)))
    assert not list(tmp_path.iterdir())
