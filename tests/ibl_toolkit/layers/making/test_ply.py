"""Points from PLY files: what is read, and what is refused in which words."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.errors import LayersError
from expanded_panoramas.ibl_toolkit.layers.making.ply import read_ply

POINTS = np.array([[1.5, -2.0, 0.25], [0.0, 4.0, 1e3]])
BYTES = np.array([[0, 128, 255], [10, 20, 30]], np.uint8)
LINEAR_128 = 0.2158605  # of the sRGB value 128, IEC 61966-2-1
UCHAR = "property uchar red\nproperty uchar green\nproperty uchar blue\n"
FLOATS = UCHAR.replace("uchar", "float")
XYZ = "property float x\nproperty float y\nproperty float z\n"


def header(kind, colours=UCHAR, count=2, before="", behind=""):
    return (
        f"ply\nformat {kind} 1.0\ncomment of ours\n{before}"
        f"element vertex {count}\n{XYZ}{colours}{behind}end_header\n"
    ).encode()


def record(order, colours="u1"):
    return np.dtype([(n, order + "f4") for n in "xyz"] + [(n, order + colours) for n in "rgb"])


def rows(order, colours="u1", values=BYTES):
    return np.array([(*p, *c) for p, c in zip(POINTS, values, strict=True)], record(order, colours)).tobytes()


def read(tmp_path, data, **options):
    path = tmp_path / "cloud.ply"
    path.write_bytes(data)
    return read_ply(path, **options)


@pytest.mark.parametrize(("kind", "order"), [("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_binary(tmp_path, kind, order):
    cloud = read(tmp_path, header(kind) + rows(order))
    np.testing.assert_array_equal(cloud.points, POINTS.astype(np.float32))
    np.testing.assert_allclose(cloud.colours[0], [0, LINEAR_128, 1], rtol=1e-5)


def test_ascii_with_windows_lines_and_other_properties(tmp_path):
    text = header("ascii", UCHAR + "property float quality\n").replace(b"\n", b"\r\n")
    body = b"1.5 -2 0.25 0 128 255 0.5\r\n0 4 1000 10 20 30 1\r\n"
    cloud = read(tmp_path, text + body)
    np.testing.assert_array_equal(cloud.points, POINTS)
    np.testing.assert_allclose(cloud.colours[0], [0, LINEAR_128, 1], rtol=1e-5)


def test_float_colours_are_linear(tmp_path):
    values = np.array([[0.5, 7.0, 1e4], [0, 0, 0]])
    cloud = read(tmp_path, header("binary_little_endian", FLOATS) + rows("<", "f4", values))
    np.testing.assert_allclose(cloud.colours, values, rtol=1e-6)


def test_other_elements_are_passed_over(tmp_path):
    before = "element camera 3\nproperty double x\nproperty uchar x\n"
    behind = "element face 1\nproperty list uchar int vertex_indices\n"
    data = header("binary_little_endian", before=before, behind=behind) + bytes(27) + rows("<") + b"\3abcd"
    np.testing.assert_array_equal(read(tmp_path, data).points, POINTS.astype(np.float32))
    lines = b"1 2\n3 4\n5 6\n1.5 -2 0.25 0 128 255\n0 4 1000 10 20 30\n3 0 1 1\n"
    np.testing.assert_array_equal(
        read(tmp_path, header("ascii", before=before, behind=behind) + lines).points, POINTS
    )


BINARY = header("binary_little_endian")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "is no PLY file"),
        (b"plywood\n", "is no PLY file"),
        (b"ply\nformat ascii 1.0\n", "no line 'end_header'"),
        (
            b"ply\n" + b"comment x\n" * 10000 + b"end_header\n",
            "no line 'end_header' in the first 65536 bytes",
        ),
        (BINARY + rows("<")[:-1], "ends after 1 vertices, its header tells of 2"),
        (header("binary_little_endian", count=10**15) + rows("<"), "more than its .* bytes can hold"),
        (header("binary_little_endian", count=20) + rows("<"), "ends after 2 vertices"),
        *[
            (
                header(kind, before=f"element camera {count}\nproperty float x\n") + rows("<"),
                "tells of 9+ of element 'camera', more than its .* bytes can hold",
            )
            for kind in ("binary_little_endian", "ascii")
            for count in ("9" * 18, "9" * 30, "9" * 5000)
        ],
        (header("ascii", count=3) + b"1 2 3 4 5 6\n" * 2, "has 12 numbers of vertices, .* 3 times 6"),
        (header("ascii", count=1) + b"1 2 3 4 five 6\n", "can't be read"),
        (header("ascii", count=0), "has 0 vertices"),
        (BINARY.replace(b"format binary_little_endian", b"format pdp11"), "'format pdp11 1.0' of its header"),
        (BINARY.replace(b"format binary_little_endian 1.0\n", b""), "its header has no format"),
        (BINARY.replace(b"vertex", b"vertices"), "no element 'vertex'"),
        (BINARY.replace(b"float z", b"float depth"), "its vertices have no z"),
        (BINARY.replace(b"float z", b"float y"), "have no z"),
        (BINARY.replace(b"uchar red", b"list uchar int red"), "have a list"),
        (BINARY.replace(b"uchar red", b"float red"), "neither all uchar nor all float"),
        (BINARY.replace(b"uchar", b"ushort") + bytes(99), "neither all uchar nor all float"),
        (BINARY.replace(b"float x", b"quad x"), "'property quad x' of its header"),
        (
            header("binary_little_endian", before="element face 1\nproperty list uchar int i\n") + rows("<"),
            "element 'face' with lists is before the vertices",
        ),
    ],
)
def test_refused(tmp_path, data, message):
    with pytest.raises(LayersError, match=f"cloud.ply: .*{message}"):
        read(tmp_path, data + bytes(40) if b"float red" in data else data)


def test_more_points_than_allowed(tmp_path):
    with pytest.raises(LayersError, match="has 2 vertices, must have 1 to 1"):
        read(tmp_path, BINARY + rows("<"), max_points=1)
