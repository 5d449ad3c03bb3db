"""Files of other programs: held to their formats by readers of our own, and by Khronos' validator."""

import json
import shutil
import struct
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest
from layered_box import ORIGIN, ROTATION, layered_box

from expanded_panoramas.ibl_toolkit.layers.export.pieces import MESHES, pieces_of
from expanded_panoramas.ibl_toolkit.layers.export.writing import export_layers, exposure_of
from expanded_panoramas.ibl_toolkit.layers.panorama import LayeredPanorama

ROOT = Path(__file__).parents[4]
NODE_MODULES = ROOT / "out" / "node" / "node_modules"
VALIDATOR = "gltf-validator@2.0.0-dev.3.10"
VALIDATE = """
require("gltf-validator").validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[1])))
    .then(report => console.log(JSON.stringify(report.issues)));
"""
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


def read_glb(path):
    """The document of a .glb file and its arrays, checked against what the specification asks for."""
    data = path.read_bytes()
    magic, version, length = struct.unpack("<4sII", data[:12])
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack("<I4s", data[12:20])
    assert (kind, size % 4) == (b"JSON", 0)
    document = json.loads(data[20 : 20 + size])
    rest, kind = struct.unpack("<I4s", data[20 + size : 28 + size])
    assert (kind, rest % 4, 28 + size + rest) == (b"BIN\0", 0, len(data))
    binary = data[28 + size :]
    assert 0 <= len(binary) - document["buffers"][0]["byteLength"] < 4
    views = [binary[v["byteOffset"] :][: v["byteLength"]] for v in document["bufferViews"]]
    assert all(v["byteOffset"] % 4 == 0 for v in document["bufferViews"])
    arrays = []
    for accessor in document["accessors"]:
        kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        values = np.frombuffer(views[accessor["bufferView"]], kind).reshape(-1, COMPONENTS[accessor["type"]])
        assert len(values) == accessor["count"]
        if "min" in accessor:
            np.testing.assert_array_equal(values.min(axis=0), np.float32(accessor["min"]))
            np.testing.assert_array_equal(values.max(axis=0), np.float32(accessor["max"]))
        arrays.append(values)
    return document, arrays, views


@pytest.mark.parametrize("mapping", ["equirectangular", "cube map"])
def test_glb_holds_the_pieces(tmp_path, mapping):
    panorama = layered_box(mapping, 48 if mapping == "cube map" else 64)
    exported = export_layers(panorama, tmp_path / "a.glb", exposure=0.5)
    document, arrays, views = read_glb(tmp_path / "a.glb")
    pieces = pieces_of(panorama, 0.5, MESHES["mesh"])
    assert [m["name"] for m in document["meshes"]] == [p.name for p in pieces]
    for piece, mesh, material in zip(pieces, document["meshes"], document["materials"], strict=True):
        (part,) = mesh["primitives"]
        position, uv = (arrays[part["attributes"][name]] for name in ("POSITION", "TEXCOORD_0"))
        x, y, z = position.T
        np.testing.assert_array_equal(np.stack([x, -z, y], axis=1), piece.points)
        np.testing.assert_array_equal(uv, piece.uv)
        np.testing.assert_array_equal(arrays[part["indices"]].reshape(-1, 3), piece.triangles)
        assert document["accessors"][part["attributes"]["POSITION"]]["min"]
        assert material["extensions"] == {"KHR_materials_unlit": {}}
        assert material["extras"] == {"exposure": 0.5}
        image = document["images"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]
        pixels = cv2.imdecode(np.frombuffer(views[image["bufferView"]], np.uint8), cv2.IMREAD_UNCHANGED)
        assert material["alphaMode"] == "MASK"
        np.testing.assert_array_equal(cv2.cvtColor(pixels, cv2.COLOR_BGRA2RGBA), piece.texture.pixels)
    assert [(e.vertices, e.triangles) for e in exported.layers] == [
        (len(p.points), len(p.triangles)) for p in pieces
    ]
    assert sum(e.bytes for e in exported.layers) < (tmp_path / "a.glb").stat().st_size
    assert sum(e.bytes for e in exported.layers) > (tmp_path / "a.glb").stat().st_size - 4000


def test_pieces_of_one_layer_share_a_texture_that_needs_no_mask(tmp_path):
    export_layers(layered_box(), tmp_path / "a.glb", surface="quadtree")
    document, _, views = read_glb(tmp_path / "a.glb")
    assert (len(document["materials"]), len(document["images"])) == (3, 2)
    assert not any("alphaMode" in material for material in document["materials"])
    png = np.frombuffer(views[document["images"][0]["bufferView"]], np.uint8)
    assert cv2.imdecode(png, cv2.IMREAD_UNCHANGED).shape == (32, 64, 3)


def test_the_node_puts_the_panorama_where_it_stands(tmp_path):
    export_layers(layered_box(), tmp_path / "a.glb")
    root = read_glb(tmp_path / "a.glb")[0]["nodes"][0]
    x, y, z = root["translation"]
    np.testing.assert_allclose([x, -z, y], ORIGIN)
    (qx, qy, qz), w = root["rotation"][:3], root["rotation"][3]
    vector = np.array([qx, -qz, qy])  # the axis, z up
    angle = 2 * np.arctan2(np.linalg.norm(vector), w)
    got = cv2.Rodrigues(vector / np.linalg.norm(vector) * angle)[0]
    np.testing.assert_allclose(got, ROTATION, atol=1e-12)


def test_a_panorama_that_stands_at_the_world_s_origin_says_nothing_of_it(tmp_path):
    panorama = LayeredPanorama(layered_box().layers, np.eye(3), np.zeros(3), 0.5)
    export_layers(panorama, tmp_path / "a.glb")
    assert read_glb(tmp_path / "a.glb")[0]["nodes"][0].keys() == {"name", "children", "extras"}


def validated(path):
    """What Khronos' validator says of a file."""
    node = shutil.which("node")
    if node is None or not (NODE_MODULES / "gltf-validator").is_dir():
        pytest.skip(f"needs Node, and: npm install --prefix out/node {VALIDATOR}")
    done = subprocess.run(
        [node, "-e", VALIDATE, str(path)],
        env={"NODE_PATH": str(NODE_MODULES)},
        capture_output=True,
        check=True,
    )
    return json.loads(done.stdout)


@pytest.mark.parametrize("names", [("room", "objects"), ("walls",)])
@pytest.mark.parametrize("mapping", ["equirectangular", "cube map"])
def test_khronos_validator_finds_nothing(tmp_path, mapping, names):
    export_layers(layered_box(mapping, 48 if mapping == "cube map" else 64, names), tmp_path / "a.glb")
    report = validated(tmp_path / "a.glb")
    assert [report[kind] for kind in ("numErrors", "numWarnings", "numHints")] == [0, 0, 0]
    # A cube map's three columns are no power of two.
    assert {message["code"] for message in report["messages"]} <= {"IMAGE_NPOT_DIMENSIONS"}


def test_khronos_validator_would_find_something(tmp_path):
    export_layers(layered_box(), tmp_path / "a.glb")
    data = bytearray((tmp_path / "a.glb").read_bytes())
    data[data.index(b'"min":[') + 7] = ord("9")
    (tmp_path / "a.glb").write_bytes(data)
    assert validated(tmp_path / "a.glb")["numErrors"] > 0


def read_obj(path):
    lines = [line.split() for line in path.read_text().splitlines()]
    columns = {
        kind: [line[1:] for line in lines if line[:1] == [kind]] for kind in ("v", "vt", "f", "usemtl")
    }
    points, uv = (np.array(columns[kind], float) for kind in ("v", "vt"))
    faces = np.array([[corner.split("/") for corner in face] for face in columns["f"]], int) - 1
    assert (faces[..., 0] == faces[..., 1]).all()
    return points, uv, faces[..., 0], columns["usemtl"]


def test_obj_holds_the_pieces_in_the_world(tmp_path):
    panorama = layered_box()
    exported = export_layers(panorama, tmp_path / "a b.obj", exposure=1.0)
    points, uv, faces, materials = read_obj(tmp_path / "a b.obj")
    pieces = pieces_of(panorama, 1.0)
    world = np.concatenate([piece.points for piece in pieces]) @ ROTATION.T + ORIGIN
    x, y, z = points.T
    np.testing.assert_allclose(np.stack([x, -z, y], axis=1), world, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(uv[:, 1], 1 - np.concatenate([p.uv for p in pieces])[:, 1], atol=1e-6)
    starts = np.cumsum([0, *(len(piece.points) for piece in pieces[:-1])])
    expected = [piece.triangles.astype(int) + k for piece, k in zip(pieces, starts, strict=True)]
    np.testing.assert_array_equal(faces, np.concatenate(expected))
    assert materials == [["0_room"], ["1_room_at_infinity"], ["2_objects"]]
    named = (tmp_path / "a b.mtl").read_text()
    assert named.count("map_Kd a b_0_room.png") == 2
    assert {file.name for file in exported.files} == {p.name for p in tmp_path.iterdir()}
    assert sum(e.bytes for e in exported.layers) == pytest.approx(
        sum(f.stat().st_size for f in exported.files), abs=600
    )


@pytest.mark.parametrize("surface", [None, "quadtree"])
def test_ply_is_as_long_as_its_header_says(tmp_path, surface):
    panorama = layered_box()
    exported = export_layers(panorama, tmp_path / "a.ply", surface=surface, exposure=1.0)
    header, _, body = (tmp_path / "a.ply").read_bytes().partition(b"end_header\n")
    assert len(body) == sum(layer.bytes for layer in exported.layers)
    vertices = sum(layer.vertices for layer in exported.layers)
    assert f"element vertex {vertices}\n".encode() in header
    assert (b"element face" in header) == (surface is not None)
    if surface is None:
        assert vertices == sum(np.count_nonzero(layer.mask) for layer in panorama.layers)


def test_one_exposure_for_all_layers():
    panorama = layered_box(width=128)
    assert exposure_of(panorama) == pytest.approx(0.18 / 0.5, rel=0.1)


def test_what_is_clipped_is_told(tmp_path):
    panorama = layered_box()
    limit = 1 / 1.5
    expected = [(layer.radiance[layer.mask] > limit).any(axis=1) for layer in panorama.layers]
    for name in ("a.glb", "a.ply"):
        clipped = export_layers(panorama, tmp_path / name, exposure=1.5).clipped
        assert clipped == pytest.approx(np.concatenate(expected).mean())
    assert export_layers(panorama, tmp_path / "a.glb", exposure=1.0).clipped == 0


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("a.stl", {}, r"a\.stl: must end in \.glb, \.obj, \.ply"),
        ("a.glb", {"surface": "points"}, r"points can be written as \.ply only, not as \.glb"),
        ("a.glb", {"surface": "cloud"}, "surface 'cloud' must be one of mesh, quadtree, grid, points"),
        ("a.glb", {"exposure": 0.0}, r"exposure 0\.0 must be finite and above 0"),
        ("a.ply", {"surface": "mesh"}, "goes beyond its domain, which a .ply cannot cut off; take quadtree"),
        ("a.ply", {"far": 1.0}, r"far 1\.0 m must be finite and beyond"),
    ],
)
def test_refused(tmp_path, name, options, message):
    with pytest.raises(ValueError, match=message):
        export_layers(layered_box(), tmp_path / name, **options)
    assert not list(tmp_path.iterdir())
