"""panorama.xml: the printed one, ours, and those that would harm."""

import os
import time

import cv2
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import cube_map, equirectangular
from expanded_panoramas.ibl_toolkit.layers.errors import LayersError
from expanded_panoramas.ibl_toolkit.layers.files import xml_nodes
from expanded_panoramas.ibl_toolkit.layers.files.atlas import Patch
from expanded_panoramas.ibl_toolkit.layers.files.xml_file import (
    LayerFiles,
    LevelFiles,
    PanoramaFile,
    read_xml,
    write_xml,
)

# Thesis, section 6.2.1, letter by letter.
PRINTED = """<?xml version="1.0" encoding="iso-8859-1"?>
<!-- Panorama: anotacoes -->
<Panorama>
  <TransformGroup> <!-- Affine transformation LocalToWorld -->
    <Translate vector='0 0 1.15' />
    <Rotate axis='0 0 1' angle='90' />
    <Scale vector='-1 1 1' />
  </TransformGroup>
  <Mapping type='LatLongMapping' />
  <Freedom radius="0.5" />
  <Layer>
    <Textures mapname="Background.png" depthname="Background_d.exr" normals="" />
  </Layer>
  <Layer>
    <Textures mapname="Foreground.png" depthname="Foreground_d.exr" normals="" />
  </Layer>
</Panorama>
"""
EXACT = 1e-14
FAST = 10  # s: a hostile file is refused, not worked through


@pytest.fixture
def path(tmp_path):
    return tmp_path / "panorama.xml"


def read(path, text):
    path.write_bytes(text.encode("iso-8859-1", "xmlcharrefreplace"))
    return read_xml(path)


def changed(old, new):
    assert old in PRINTED
    return PRINTED.replace(old, new, 1)


def test_printed_file(path):
    panorama = read(path, PRINTED)
    quarter_left = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(panorama.world_from_panorama, quarter_left, atol=EXACT)
    np.testing.assert_array_equal(panorama.origin, [0, 0, 1.15])
    assert panorama.radius == 0.5
    back = LevelFiles({"radiance": "Background.png", "depth": "Background_d.exr"})
    front = LevelFiles({"radiance": "Foreground.png", "depth": "Foreground_d.exr"})
    assert panorama.layers == (
        LayerFiles("layer 1", "equirectangular", (back,)),
        LayerFiles("layer 2", "equirectangular", (front,)),
    )


def test_printed_matrix_on_directions_of_appendix_a(path):
    """M applied to eq. A.5's direction of a pixel is our direction of it in the world."""
    rotate = cv2.Rodrigues(np.array([0, 0, np.pi / 2]))[0]
    m = rotate @ np.diag([-1, 1, 1])
    u, v = np.random.default_rng(1).uniform(size=(2, 20))
    phi, theta = 2 * np.pi * u, np.pi * v
    printed = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    ours = equirectangular.direction_from_uv(np.stack([u, v], axis=-1))
    world = read(path, PRINTED).world_from_panorama
    np.testing.assert_allclose(ours @ world.T, printed @ m.T, atol=EXACT)


def test_cube_map_needs_no_mirror(path):
    text = changed("LatLongMapping", "CubeMapping")
    with pytest.raises(
        LayersError, match="TransformGroup, line 4: it must turn .* neither stretch nor mirror"
    ):
        read(path, text)
    panorama = read(path, text.replace("<Scale vector='-1 1 1' />", ""))
    assert panorama.layers[0].mapping == "cube map"
    # Eq. A.30: the middle of the second face looks along +y; the rotation turns that to -x.
    middle = cube_map.direction_from_uv([0.5, 0.25])
    np.testing.assert_allclose(panorama.world_from_panorama @ middle, [-1, 0, 0], atol=EXACT)


def test_transforms_act_from_the_last_to_the_first(path):
    turned_first = changed("<Rotate axis='0 0 1' angle='90' />", "").replace(
        "<Translate", "<Rotate axis='0 0 2' angle='90' /> <Translate", 1
    )
    np.testing.assert_allclose(
        read(path, turned_first.replace("'0 0 1.15'", "'3 0 1.15'")).origin, [0, 3, 1.15], atol=EXACT
    )


def rotations():
    for angle in (0, 1e-9, 0.3, np.pi / 2, 3.0, np.pi - 1e-9, np.pi):
        for axis in ((0, 0, 1), (1, 0, 0), (0.6, 0, -0.8), (-0.48, 0.64, 0.6)):
            yield cv2.Rodrigues(np.array(axis, dtype=float) * angle)[0]


@pytest.mark.parametrize("mapping", ["equirectangular", "cube map"])
def test_round_trip(path, mapping):
    other = {"equirectangular": "cube map", "cube map": "equirectangular"}[mapping]
    levels = (
        LevelFiles({"radiance": "a.png", "depth": "a_d.exr", "mask": "m.png"}, exposure=0.25),
        LevelFiles(
            {"depth": "sub/b.exr"}, 1.0, (64, 32), (Patch(1, 2, 3, 4, 5, 6), Patch(60, 0, 0, 0, 9, 1))
        ),
    )
    layers = (
        LayerFiles("Größe <&> \"'ж", mapping, levels),
        LayerFiles("rest", other, (LevelFiles({"depth": "c&'\u0436.exr"}),)),
    )
    for rotation in rotations():
        write_xml(path, PanoramaFile(layers, rotation, np.array([1 / 3, -2.0, 1e-7]), 0.1))
        panorama = read_xml(path)
        assert panorama.layers == layers
        np.testing.assert_allclose(panorama.world_from_panorama, rotation, atol=EXACT)
        np.testing.assert_array_equal(panorama.origin, [1 / 3, -2.0, 1e-7])
        assert panorama.radius == 0.1


def test_written_as_printed(path):
    place = cv2.Rodrigues(np.array([0, 0, np.pi / 2]))[0], np.array([0, 0, 1.15]), 0.5
    layers = (LayerFiles("layer 1", "equirectangular", (LevelFiles({"depth": "d.exr"}),)),)
    write_xml(path, PanoramaFile(layers, *place))
    lines = path.read_bytes().decode("iso-8859-1").splitlines()
    assert lines[0] == PRINTED.splitlines()[0]
    assert "    <Translate vector='0.0 0.0 1.15' />" in lines
    assert "    <Rotate axis='0.0 0.0 1.0' angle='90.0' />" in lines
    for line in (
        "    <Scale vector='-1 1 1' />",
        "  <Mapping type='LatLongMapping' />",
        '  <Freedom radius="0.5" />',
    ):
        assert line in lines
        assert line in PRINTED.splitlines()


LAYER = '<Textures mapname="Background.png" depthname="Background_d.exr" normals="" />'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "<Panorama>",
            '<Panorama version="2">',
            "Panorama, line 3: version is 2, must be 1: written by a newer",
        ),
        ("<Panorama>", '<Panorama version="0">', "version is 0, must be 1$"),
        ("<Panorama>", '<Panorama version="1.5">', "version is '1.5', must be a whole number"),
        ("<Panorama>", '<Panorama colour="x">', "Panorama, line 3: unknown attribute 'colour'"),
        ("<Freedom", "<Fog /> <Freedom", "Panorama/Fog, line 10: unknown element"),
        ('<Freedom radius="0.5" />', "", "element Freedom is missing"),
        ("<Freedom", '<Freedom radius="1" /> <Freedom', r"Freedom\[2\], line 10: a second one"),
        ('"0.5"', '"nan"', "Panorama/Freedom, line 10: radius is 'nan', must be a number"),
        ('"0.5"', '"1_0"', "radius is '1_0', must be a number"),
        ('"0.5"', '"1e999"', "radius is '1e999', must be finite"),
        ('"0.5"', '"-1"', "radius is '-1', must be at least 0"),
        ("LatLongMapping", "Mercator", "type is 'Mercator', must be one of LatLongMapping, CubeMapping"),
        ("'0 0 1.15'", "'0 0'", "TransformGroup/Translate, line 5: vector is '0 0', must be 3 numbers"),
        ("'0 0 1'", "'0 0 0'", "Rotate, line 6: axis is '0 0 0', must have a length"),
        ("'-1 1 1'", "'1 1 1'", "line 4: it must turn and move the panorama, with Scale vector='-1 1 1'"),
        ("'-1 1 1'", "'-2 2 2'", "neither stretch"),
        ("Scale vector", "Shear vector", "TransformGroup/Shear, line 7: unknown element"),
        (LAYER, "", "Panorama/Layer, line 11: element Textures is missing"),
        ('depthname="Foreground_d.exr"', "", r"Layer\[2\]/Textures, line 15: depthname must name a file"),
        (LAYER, LAYER[:-2] + 'width="64" />', "attribute height is missing"),
        (LAYER, LAYER[:-2] + 'width="64" height="32" />', "without a Patch"),
        (LAYER, LAYER[:-2] + 'exposure="0" />', "exposure is '0', must be above 0"),
        (LAYER, LAYER[:-2] + "><Patch /></Textures>", "attribute width is missing|attribute map is missing"),
        (
            LAYER,
            LAYER[:-2] + ' width="9" height="9"><Patch map="0 -1" atlas="0 0" size="1 1" /></Textures>',
            "Textures/Patch, line 12: map is '0 -1', must be 2 whole numbers",
        ),
        (LAYER, "a" + LAYER, "Panorama/Layer, line 12: text 'a'"),
        ("</Panorama>", "", "no XML that can be read: no element found"),
        ("iso-8859-1", "klingon", "no XML that can be read"),
        ("Panorama>", "Scene>", "no XML that can be read: mismatched tag"),
    ],
)
def test_clear_errors(path, old, new, message):
    with pytest.raises(LayersError, match=rf"panorama\.xml: .*({message})"):
        read(path, changed(old, new))


def test_another_root(path):
    with pytest.raises(LayersError, match="Scene, line 1: the file must begin with Panorama"):
        read(path, "<Scene />")


@pytest.mark.parametrize(
    "name",
    [
        "../secret.exr",
        "a/../../secret.exr",
        "a/../b.exr",
        "/etc/passwd",
        "//server/share.exr",
        "\\\\server\\share.exr",
        "C:/secret.exr",
        "C:secret.exr",
        "..\\secret.exr",
        "./a.exr",
        "a//b.exr",
        "file:///etc/passwd",
        "a&#10;b.exr",
        "a" * 300,
    ],
)
def test_paths_that_leave_the_folder(path, name):
    with pytest.raises(
        LayersError, match=r"Layer/Textures, line 12: mapname is .*, must be the relative path"
    ):
        read(path, changed("Background.png", name))


def test_link_that_leaves_the_folder(path, tmp_path):
    (tmp_path / "inside").mkdir()
    (tmp_path / "secret.exr").write_bytes(b"")
    os.symlink(tmp_path, tmp_path / "inside" / "link")
    with pytest.raises(LayersError, match="'link/secret.exr', which leads out of the folder"):
        read(tmp_path / "inside" / "panorama.xml", changed("Background.png", "link/secret.exr"))


LAUGHS = "".join(f"<!ENTITY l{k} '{f'&l{k - 1};' * 10}'>" for k in range(1, 10))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"<!DOCTYPE x [<!ENTITY l0 'ha'>{LAUGHS}]><Panorama>&l9;</Panorama>", "line 1: a DOCTYPE"),
        ("<!DOCTYPE x [<!ENTITY f SYSTEM 'file:///etc/passwd'>]><Panorama>&f;</Panorama>", "a DOCTYPE"),
        ("<!DOCTYPE x SYSTEM 'http://example.com/x.dtd'><Panorama />", "a DOCTYPE"),
        ("<Panorama>&f;</Panorama>", "no XML that can be read: undefined entity"),
        ("<a>" * 100_000, "elements more than 8 deep"),
        ("<Panorama>" + "<a/>" * 100_001 + "</Panorama>", "more than 100000 elements"),
        ("<Panorama " + "x" * 17 * 2**20, "larger than 16 MiB"),
        ("", "no element found"),
        ("\0\0\0", "no XML that can be read"),
        (f"<{'P' * 10000} />", "must begin with Panorama"),
    ],
    ids=["laughs", "file", "dtd", "undefined", "deep", "many", "large", "empty", "binary", "long name"],
)
def test_hostile_files(path, text, message):
    path.write_bytes(text.encode())
    start = time.perf_counter()
    with pytest.raises(LayersError, match=rf"panorama\.xml: .*{message}") as caught:
        read_xml(path)
    assert time.perf_counter() - start < FAST
    assert len(str(caught.value)) < 300 + len(str(path))


def test_bytes_of_utf_16(path):
    path.write_bytes(PRINTED.replace("iso-8859-1", "utf-16").encode("utf-16"))
    assert read_xml(path).radius == 0.5


def test_limit_of_size_is_of_the_file(path, monkeypatch):
    monkeypatch.setattr(xml_nodes, "MAX_BYTES", len(PRINTED))
    read(path, PRINTED)
    with pytest.raises(LayersError, match="larger than"):
        read(path, PRINTED + " ")
