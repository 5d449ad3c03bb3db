"""`panorama export`: files of other programs, opened again in Blender; pictures for viewers."""

import json

import cv2
import numpy as np
import pytest
from layered_box import ORIGIN, RADIUS, ROTATION, layered_box, radiance_in

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import RGBD, read_photo_sphere, write_exr, write_rgbd
from expanded_panoramas.ibl_toolkit.images.png import linear_from_srgb
from expanded_panoramas.ibl_toolkit.layers.export.pieces import MESHES, pieces_of
from expanded_panoramas.ibl_toolkit.layers.files.storage import write_layers

SINGLE = 2e-5  # [m] of float32 coordinates through Blender's matrices
MEAN, LARGEST = (
    0.01,
    0.06,
)  # radiance: 8-bit codes, and a look-up half a texel beyond a domain of a coarse map


@pytest.fixture
def box(tmp_path):
    """A folder of layers, its panorama."""
    panorama = layered_box()
    write_layers(panorama, tmp_path / "box")
    return tmp_path / "box", panorama


def world_of(pieces):
    return [piece.points.astype(float) @ ROTATION.T + ORIGIN for piece in pieces]


def in_world(thing):
    points = np.array([tuple(vertex.co) for vertex in thing.data.vertices])
    matrix = np.array(thing.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def bounds(points):
    return np.stack([points.min(axis=0), points.max(axis=0)])


def meshes(bpy):
    return {thing.name: thing for thing in bpy.context.scene.objects if thing.type == "MESH"}


def image_of(thing):
    """The pixels of the one image in an object's material, top row first, 0 to 1 as they are encoded."""
    nodes = thing.data.materials[0].node_tree.nodes
    (image,) = {node.image for node in nodes if node.type == "TEX_IMAGE"}
    return np.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)[::-1]


def assert_shows_the_panorama(thing):
    """The texture looked up at UVs of corners has the colour of the corner's direction."""
    pixels, mesh = image_of(thing), thing.data
    height, width = pixels.shape[:2]
    uv = np.array([tuple(entry.vector) for entry in mesh.uv_layers[0].uv])
    world = in_world(thing)[[loop.vertex_index for loop in mesh.loops]]
    towards = (world - ORIGIN) @ ROTATION
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    columns = np.floor(uv[:, 0] * width - 1e-4).astype(int) % width
    rows = np.clip(((1 - uv[:, 1]) * height).astype(int), 0, height - 1)
    shown = pixels[rows, columns, 3] == 1  # a mesh that goes beyond its layer's domain is cut
    assert shown.mean() > 0.1
    error = np.abs(linear_from_srgb(pixels[rows, columns, :3]) - radiance_in(towards))[shown]
    assert error.max() < 2 * LARGEST  # the nearest texel, up to a whole one away
    assert error.mean() < 2 * MEAN


@pytest.mark.parametrize("surface", MESHES)
def test_glb_opens_in_blender(fresh_blend, box, tmp_path, panorama, surface):
    folder, layered = box
    arguments = ("export", folder, "-o", tmp_path / "a.glb", "--exposure", 1, "--json")
    status, out, err = panorama(*arguments, *(() if surface == "mesh" else ("--surface", surface)))
    assert (status, err) == (0, [])
    told = json.loads(out)
    assert told["bytes"] == (tmp_path / "a.glb").stat().st_size
    fresh_blend.ops.import_scene.gltf(filepath=str(tmp_path / "a.glb"))
    found = meshes(fresh_blend)
    pieces = pieces_of(layered, 1.0, MESHES[surface])
    for piece, world, layer in zip(pieces, world_of(pieces), told["layers"], strict=True):
        thing = found[piece.name]
        assert layer["name"] == piece.name
        assert layer["triangles"] == len(thing.data.polygons) == len(piece.triangles)
        assert layer["vertices"] == len(piece.points)
        np.testing.assert_allclose(bounds(in_world(thing)), bounds(world), atol=SINGLE * np.abs(world).max())
        assert_shows_the_panorama(thing)
        assert thing.data.materials[0]["exposure"] == 1.0
    empty = fresh_blend.data.objects["Panorama"]
    np.testing.assert_allclose(empty.matrix_world.translation, ORIGIN, atol=SINGLE)
    np.testing.assert_allclose(np.array(empty.matrix_world)[:3, :3], ROTATION, atol=SINGLE)
    assert empty["radius"] == RADIUS


def test_obj_opens_in_blender(fresh_blend, box, tmp_path, panorama):
    folder, layered = box
    assert panorama("export", folder, "-o", tmp_path / "a.obj", "--exposure", 1)[0] == 0
    fresh_blend.ops.wm.obj_import(filepath=str(tmp_path / "a.obj"))
    found = meshes(fresh_blend)
    assert set(found) == {"0_room", "1_room_at_infinity", "2_objects"}
    for name, world in zip(sorted(found), world_of(pieces_of(layered, 1.0)), strict=True):
        got = in_world(found[name])
        np.testing.assert_allclose(bounds(got), bounds(world), atol=SINGLE * np.abs(world).max())
        assert_shows_the_panorama(found[name])


@pytest.mark.parametrize("surface", ["points", "quadtree"])
def test_ply_opens_in_blender(fresh_blend, box, tmp_path, panorama, surface):
    folder, _ = box
    arguments = ("export", folder, "-o", tmp_path / "a.ply", "--exposure", 1, "--surface", surface, "--json")
    status, out, _ = panorama(*arguments)
    assert status == 0
    told = json.loads(out)["layers"]
    fresh_blend.ops.wm.ply_import(filepath=str(tmp_path / "a.ply"))
    (thing,) = meshes(fresh_blend).values()
    world = in_world(thing)
    assert len(thing.data.polygons) == sum(layer["triangles"] for layer in told)
    assert len(world) == sum(layer["vertices"] for layer in told)
    towards = (world - ORIGIN) @ ROTATION
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    colours = np.array([tuple(entry.color) for entry in thing.data.color_attributes[0].data])[:, :3]
    error = np.abs(colours - radiance_in(towards))
    assert error.max() < LARGEST
    assert error.mean() < MEAN


@pytest.mark.parametrize("suffix", [".jpg", ".png"])
def test_a_picture_of_layers_has_what_is_nearest(tmp_path, panorama, suffix):
    """Seen from the origin the objects have the walls' colours; so they are painted white here."""
    layered = layered_box(names=("walls", "objects"))
    layered.layers[1].attributes["radiance"][:] = 1
    write_layers(layered, tmp_path / "box")
    output = tmp_path / f"a{suffix}"
    status, out, _ = panorama("export", tmp_path / "box", "-o", output, "--exposure", 1, "--json")
    assert status == 0
    assert json.loads(out)["size"] == [64, 32]
    got = cv2.imread(str(output))[..., ::-1] / 255
    mask = layered.layers[1].mask
    expected = np.where(mask[..., None], 1, radiance_in(equirectangular.pixel_directions(64, 32)))
    error = np.abs(linear_from_srgb(got) - expected)
    assert np.median(error) < (0.005 if suffix == ".png" else 0.02)
    assert (got[mask] > 0.9).mean() > 0.95
    np.testing.assert_allclose(read_photo_sphere(output).world_from_panorama, ROTATION, atol=1e-5)


def test_a_picture_of_a_panorama_has_no_pose_unless_it_is_known(tmp_path, panorama):
    image = radiance_in(equirectangular.pixel_directions(32, 16))
    write_exr(tmp_path / "plain.exr", {name: image[..., k] for k, name in enumerate("RGB")})
    write_rgbd(tmp_path / "deep.exr", RGBD(image, np.full((16, 32), 3, np.float32), ROTATION, 1.5))
    for name in ("plain", "deep"):
        assert panorama("export", tmp_path / f"{name}.exr", "-o", tmp_path / f"{name}.jpg")[0] == 0
    assert read_photo_sphere(tmp_path / "plain.jpg").pose_deg is None
    got = read_photo_sphere(tmp_path / "deep.jpg").world_from_panorama
    np.testing.assert_allclose(got, ROTATION, atol=1e-5)


def test_what_people_read(box, tmp_path, panorama):
    _, out, _ = panorama("export", box[0], "-o", tmp_path / "a.glb", "--exposure", 2)
    lines = out.splitlines()
    assert [line.split(":")[0] for line in lines[:-1]] == ["room", "room at infinity", "objects"]
    assert "triangles" in lines[0]
    assert "radiance × 2, " in lines[-1]
    assert "% of the pixels clipped" in lines[-1]
    _, out, _ = panorama("export", box[0], "-o", tmp_path / "a.jpg")
    assert out.splitlines()[0] == "64 × 32 px"


def test_a_coarser_level(tmp_path, panorama):
    write_layers(layered_box(), tmp_path / "box", levels=2)
    vertices = []
    for level in (0, 1):
        arguments = ("export", tmp_path / "box", "-o", tmp_path / "a.ply", "--level", level, "--json")
        vertices.append(json.loads(panorama(*arguments)[1])["layers"][0]["vertices"])
    assert vertices[1] == pytest.approx(vertices[0] / 4, rel=0.05)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("box", "-o", "a.stl"), "-o a.stl: must end in .glb, .obj, .ply, .jpg, .png"),
        (("box", "-o", "none/a.glb"), "-o none/a.glb: folder none does not exist"),
        (("plain.exr", "-o", "a.glb"), "plain.exr: must be a folder with a panorama.xml, for a .glb file"),
        (("box", "-o", "a.glb", "--surface", "points"), "box: a.glb: points can be written as .ply only"),
        (("box", "-o", "a.jpg", "--far", "9"), "--far: does nothing for a picture, a.jpg"),
        (("plain.exr", "-o", "a.jpg", "--level", "1"), "--level: does nothing for plain.exr"),
        (("nothing", "-o", "a.glb"), "nothing: must be a folder with a panorama.xml"),
        (
            ("box", "-o", "a.glb", "--far", "1"),
            "box: far 1.0 m must be finite and beyond the farthest surface",
        ),
    ],
)
def test_refused(box, tmp_path, panorama, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    write_exr("plain.exr", dict.fromkeys("RGB", np.ones((4, 8), np.float16)))
    status, _, err = panorama("export", *arguments)
    assert status == 2
    assert len(err) == 1
    assert message in err[0]
    assert {path.name for path in tmp_path.iterdir()} == {"box", "plain.exr"}
