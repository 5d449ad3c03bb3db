"""`layers`: what it writes, what it prints, what it refuses before any work."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import RGBD, write_exr, write_rgbd
from expanded_panoramas.ibl_toolkit.layers.files.folder import write_folder
from expanded_panoramas.ibl_toolkit.layers.files.storage import read_layers
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

WIDTH = 64
WALL, CARD = 4.0, 1.5


@pytest.fixture
def rgbd_file(tmp_path):
    """A card before a wall all round."""
    path = tmp_path / "map.exr"
    write_rgbd(path, RGBD(*card_picture(), np.eye(3), 1.6))
    return path


def card_picture():
    directions = equirectangular.pixel_directions(WIDTH, WIDTH // 2)
    is_card = (directions[..., 0] > 0.8) & (np.abs(directions[..., 2]) < 0.3)
    image = np.where(is_card[..., None], np.float32(0.8), np.float32([0.1, 0.2, 0.3])).astype(np.float32)
    return image, np.where(is_card, CARD, WALL).astype(np.float32)


def test_an_rgbd_panorama_becomes_layers(rgbd_file, tmp_path, panorama):
    folder = tmp_path / "layers"
    command = ["layers", rgbd_file, "-o", folder, "--radius", 0.5]
    status, out, err = panorama(*command, "--json")
    result = json.loads(out)
    assert (status, err) == (0, [])
    assert set(result) == {"radius", "origin", "layers", "seconds", "warnings"}
    assert (result["radius"], result["origin"], result["warnings"]) == (0.5, [0.0, 0.0, 1.6], [])
    written = read_layers(folder)
    assert [layer["name"] for layer in result["layers"]] == [layer.name for layer in written.layers]
    assert len(written.layers) == 2
    for layer, described in zip(written.layers, result["layers"], strict=True):
        assert described["size"] == list(layer.size)
        assert described["discontinuities"] == 0
        assert described["share"] == pytest.approx(weights()[layer.mask].sum())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["layers", "map.exr"]


def weights():
    angles = equirectangular.row_solid_angles(WIDTH, WIDTH // 2) / (4 * np.pi)
    return np.repeat(angles[:, None], WIDTH, axis=1)


def test_without_attributes_it_is_level_at_the_world_origin(tmp_path, panorama):
    image, depth = card_picture()
    write_exr(tmp_path / "map.exr", {**{name: image[..., k] for k, name in enumerate("RGB")}, "Z": depth})
    status, out, _ = panorama("layers", tmp_path / "map.exr", "-o", tmp_path / "layers", "--json")
    assert status == 0
    assert json.loads(out)["origin"] == [0.0, 0.0, 0.0]
    assert json.loads(out)["radius"] == pytest.approx(CARD / 2)


def test_layers_are_sorted_into_classes(rgbd_file, tmp_path, panorama):
    classes = ["--by-geometry", "--by-depth", "1,2", "--infinity", "--flatten"]
    made = tmp_path / "made"
    status, out, _ = panorama("layers", rgbd_file, "-o", made, "--radius", 0.5, *classes, "--json")
    result = json.loads(out)
    assert status == 0
    names = [layer["name"] for layer in result["layers"]]
    assert names == [layer.name for layer in read_layers(made).layers]
    assert names[-1] == "front 1, from 1 m to 2 m"
    assert "background, walls, from 2 m" in names
    assert set(result["hides"]["front 1, from 1 m to 2 m"]) <= set(names[:-1])
    assert "sorting" in result["seconds"]


def test_a_folder_of_layers_is_sorted_in_its_place(rgbd_file, tmp_path, panorama):
    folder = tmp_path / "layers"
    panorama("layers", rgbd_file, "-o", folder, "--radius", 0.5)
    before = read_layers(folder)
    status, out, err = panorama("layers", folder, "-o", folder, "--by-depth", 2)
    assert (status, err) == (0, [])
    assert [layer.name for layer in read_layers(folder).layers] == ["background, from 2 m", "front 1, to 2 m"]
    assert read_layers(folder).radius == before.radius
    assert len(out.splitlines()) == 3


def test_what_is_far_and_what_is_thin_is_told_apart(tmp_path, panorama):
    """Each by its own option: a mountain becomes infinity, and a rough wall flat."""
    is_wall = np.arange(WIDTH) < WIDTH // 2
    depth = np.where(is_wall, 2 + 1e-3 * (np.arange(WIDTH) % 2), 900) * np.ones((WIDTH // 2, 1))
    view = Layer("view", "equirectangular", {"depth": depth.astype(np.float32)})
    write_folder(LayeredPanorama((view,), np.eye(3), np.zeros(3), 0.5), tmp_path / "view")
    for option, names, distances in (("--infinity", ["infinity", "view"], 2), ("--flatten", ["view"], 1)):
        status, _, _ = panorama("layers", tmp_path / "view", "-o", tmp_path / option, option)
        layers = read_layers(tmp_path / option).layers
        assert (status, [layer.name for layer in layers]) == (0, names)
        assert len(np.unique(layers[-1].depth[:, is_wall])) == distances


def test_points_become_layers(tmp_path, panorama):
    image, depth = card_picture()
    places = depth[..., None] * equirectangular.pixel_directions(WIDTH, WIDTH // 2) + np.float32([1, 0, 2])
    vertices = np.concatenate([places, image], axis=-1).reshape(-1, 6)
    kinds = [f"property float {name}" for name in ("x", "y", "z", "red", "green", "blue")]
    header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *kinds, "end_header"]
    lines = [" ".join(map(str, vertex)) for vertex in vertices.tolist()]
    (tmp_path / "scan.ply").write_text("\n".join([*header, *lines]) + "\n")
    command = ["layers", tmp_path / "scan.ply", "-o", tmp_path / "layers", "--origin", 1, 0, 2]
    _, out, _ = panorama(*command, "--width", WIDTH, "--json")
    result = json.loads(out)
    assert result["origin"] == [1, 0, 2]
    assert result["radius"] == pytest.approx(CARD / 2, rel=1e-3)
    background, front = read_layers(tmp_path / "layers").layers[:2]
    assert np.nanmedian(background.depth) == pytest.approx(WALL, rel=0.01)
    assert np.nanmedian(front.depth) == pytest.approx(CARD, rel=0.01)


def test_rgbd_shots_become_layers(rgbd_file, tmp_path, panorama):
    shots = [{"image": "map.exr", "origin": place} for place in ([1, 2, 3], [1, 2, 3.2])]
    (tmp_path / "shots.json").write_text(json.dumps({"version": 1, "shots": shots}))
    command = ["layers", tmp_path / "shots.json", "-o", tmp_path / "layers", "--width", WIDTH, "--json"]
    status, out, _ = panorama(*command)
    result = json.loads(out)
    assert (status, result["origin"]) == (0, [1, 2, 3])
    assert result["layers"][0]["size"] == [WIDTH, WIDTH // 2]
    status, _, err = panorama(*command, "--samples", 3)
    assert (status, "--samples: does nothing for" in err[-1]) == (2, True)


def test_a_second_run_replaces_the_first_and_levels_and_ldr_are_written(rgbd_file, tmp_path, panorama):
    folder = tmp_path / "layers"
    for radius in (0.2, 0.5):
        command = [
            "layers",
            rgbd_file,
            "-o",
            folder,
            "--radius",
            radius,
            "--levels",
            2,
            "--ldr",
            "--layers",
            1,
        ]
        status, out, err = panorama(*command)
        assert status == 0
    assert out.splitlines()[0] == "radius 0.5 m round (0, 0, 1.6)"
    assert len(out.splitlines()) == 2
    assert "warning: layer 'background': depth jumps" in err[0]
    assert read_layers(folder).radius == 0.5
    assert read_layers(folder, level=1).layers[0].size == (WIDTH // 2, WIDTH // 4)
    assert len(list(folder.glob("*.png"))) == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["map.png", "-o", "new"], "map.png: must be RGB-D panorama"),
        (["map.exr", "-o", "none/new"], "-o none/new: the folder none does not exist"),
        (["map.exr", "-o", "map.exr"], "-o map.exr: is a file"),
        (["map.exr", "-o", "."], "has other files in it and no panorama.xml"),
        (["map.exr", "-o", "new", "--samples", "3"], "--samples: does nothing for map.exr"),
        (["a.ply", "-o", "new", "--denoise"], "--denoise: does nothing for a.ply"),
        (["map.exr", "-o", "new", "--width", "64"], "--width: does nothing for map.exr"),
        ([".", "-o", "new", "--radius", "1"], "--radius: does nothing for ."),
        ([".", "-o", "new"], "panorama.xml"),
        (["map.exr", "-o", "new", "--by-depth", "2,1"], "'2,1': must rise from number to number"),
        (["map.exr", "-o", "new", "--collection", "a"], "--collection: does nothing for map.exr"),
        (["room.json", "-o", "new", "--origin", "0", "0", "1"], "--origin: does nothing for room.json"),
        (
            ["a.blend", "-o", "new", "--layers", "3", "--collection", "b"],
            "--layers: does nothing for a.blend",
        ),
        (["a.blend", "-o", "new"], "a.blend: No such file"),
        (["map.exr", "-o", "new", "--radius", "0"], "'0': must be a number above 0"),
    ],
)
def test_what_cannot_be_is_refused_first(rgbd_file, panorama, monkeypatch, arguments, words):
    monkeypatch.chdir(rgbd_file.parent)
    before = sorted(path.name for path in rgbd_file.parent.iterdir())
    status, out, err = panorama("layers", *arguments)
    assert (status, out) == (2, "")
    assert words in err[-1]
    assert sorted(path.name for path in rgbd_file.parent.iterdir()) == before
