"""Layers of a place: made into a folder, opened as objects, written to files; and what is refused."""

import os

import numpy as np
import panoramas
import pytest
from layered_box import ORIGIN, ROTATION, layered_box, radiance_in

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import RGBD, write_rgbd
from expanded_panoramas.ibl_toolkit.layers.files.storage import read_layers, write_layers

WIDTH = 128


@pytest.fixture
def room(fresh_blend, tmp_path):
    """A calibrated room with furniture; its layers are to go into tmp_path/layers."""
    scene, here = panoramas.room_place(fresh_blend, panoramas.smooth_panorama(tmp_path / "map.exr"))
    state, layers = scene.panorama_set, scene.panorama_layers
    state.image, state.image_path = here.image, str(tmp_path / "map.exr")
    state.result.is_solved = True
    layers.folder, layers.width, layers.radius = str(tmp_path / "layers"), WIDTH, 0.4
    return scene


@pytest.fixture
def box(fresh_blend, tmp_path):
    """A scene that has nothing but a folder of layers."""
    write_layers(layered_box(), tmp_path / "box")
    scene = fresh_blend.context.scene
    scene.panorama_layers.folder = str(tmp_path / "box")
    return scene


def test_a_place_becomes_layers(fresh_blend, room, tmp_path):
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    panorama = read_layers(tmp_path / "layers")
    first, *behind = panorama.layers
    assert first.size == (WIDTH, WIDTH // 2)
    assert first.mask.all()
    assert behind
    assert all(0 < layer.mask.mean() < 0.5 for layer in behind)
    assert panorama.radius == pytest.approx(0.4)
    origin = room.panorama_place.origin.matrix_world
    np.testing.assert_allclose(panorama.origin, origin.translation, atol=1e-6)
    assert room.panorama_layers.found.startswith(first.name)
    assert room.panorama_layers.found.endswith("radius 0.4 m")


def test_made_again_they_take_the_place_of_the_old(fresh_blend, room, tmp_path):
    fresh_blend.ops.panorama.make_layers()
    room.panorama_layers.most = 1
    room.panorama_layers.width = WIDTH + 1  # an odd number is made even
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    panorama = read_layers(tmp_path / "layers")
    assert [layer.size for layer in panorama.layers] == [(WIDTH, WIDTH // 2)]
    assert len(list((tmp_path / "layers").iterdir())) == 3


def test_of_an_rgbd_panorama_the_file_s_own_depth_is_taken(fresh_blend, tmp_path):
    towards = equirectangular.pixel_directions(WIDTH, WIDTH // 2)
    depth = np.where(towards[..., 0] > 0.9, 1, 3).astype(np.float32)
    write_rgbd(tmp_path / "deep.exr", RGBD(radiance_in(towards), depth, ROTATION, 1.5))
    assert fresh_blend.ops.panorama.load_rgbd(filepath=str(tmp_path / "deep.exr")) == {"FINISHED"}
    scene = fresh_blend.context.scene
    scene.panorama_layers.folder = str(tmp_path / "layers")
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    panorama = read_layers(tmp_path / "layers")
    assert len(panorama.layers) > 1
    nearest = np.fmin.reduce([layer.depth for layer in panorama.layers])
    assert (np.abs(nearest - depth) < 0.01).mean() > 0.98
    np.testing.assert_allclose(panorama.world_from_panorama, ROTATION, atol=1e-6)
    assert panorama.radius > 0.4  # half of what is nearest, none being given


def test_they_are_sorted_if_asked(fresh_blend, tmp_path):
    towards = equirectangular.pixel_directions(WIDTH, WIDTH // 2)
    depth = np.where(towards[..., 0] > 0.9, 1, 3).astype(np.float32)
    depth[towards[..., 2] > 0.9] = np.inf
    write_rgbd(tmp_path / "deep.exr", RGBD(radiance_in(towards), depth, ROTATION, 1.5))
    fresh_blend.ops.panorama.load_rgbd(filepath=str(tmp_path / "deep.exr"))
    layers = fresh_blend.context.scene.panorama_layers
    layers.folder, layers.geometry, layers.infinity = str(tmp_path / "layers"), True, True
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    names = [layer.name for layer in read_layers(tmp_path / "layers").layers]
    assert {"infinity", "front 1, walls", "front 2"} <= set(names)  # before the sky is the room
    assert layers.found.startswith(", ".join(names))


def test_too_few_layers_are_warned_of(fresh_blend, tmp_path, capfd):
    """Of an RGB-D panorama, whose layers should be continuous; not of surfaces, which meshes bridge."""
    towards = equirectangular.pixel_directions(WIDTH, WIDTH // 2)
    depth = np.where(towards[..., 0] > 0.9, 1, 3).astype(np.float32)
    write_rgbd(tmp_path / "deep.exr", RGBD(radiance_in(towards), depth, ROTATION, 1.5))
    fresh_blend.ops.panorama.load_rgbd(filepath=str(tmp_path / "deep.exr"))
    layers = fresh_blend.context.scene.panorama_layers
    layers.folder, layers.most = str(tmp_path / "layers"), 1
    capfd.readouterr()
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    assert "layer 'background': depth jumps" in capfd.readouterr().out
    layers.most = 4
    fresh_blend.ops.panorama.make_layers()
    assert "Warning" not in capfd.readouterr().out


def test_jumps_of_surfaces_are_not_warned_of(fresh_blend, room, capfd):
    capfd.readouterr()
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    assert "depth jumps" not in capfd.readouterr().out


def test_without_a_panorama_the_scene_itself_is_captured(fresh_blend, tmp_path):
    import small_scenes as small

    scene = fresh_blend.context.scene
    for depth, colour, size in ((3, (0, 1, 0, 1), 8), (1.5, (1, 0, 0, 1), 0.5)):
        small.add_plane(
            scene, small.material("ShaderNodeEmission", Color=colour), size, (depth, 0, 1), (-1, 0, 0)
        )
    scene.panorama_layers.folder = str(tmp_path / "layers")
    assert reason(fresh_blend, "make_layers") == "Open a panorama, or add a camera to a scene of your own"
    small.add_camera(scene, (0, 0, 1), (1, 0, 1), field_of_view=1)
    scene.panorama_layers.width, scene.panorama_layers.radius = WIDTH, 0.4
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    assert fresh_blend.ops.panorama.make_layers() == {"FINISHED"}
    panorama = read_layers(tmp_path / "layers")
    ahead = WIDTH // 4, WIDTH // 2
    there = [layer for layer in panorama.layers if layer.mask[ahead]]
    hidden = [layer for layer in there if layer.depth[ahead] > 2]
    np.testing.assert_allclose(min(layer.depth[ahead] for layer in there), 1.5, rtol=2e-3)
    np.testing.assert_allclose(hidden[0].depth[ahead], 3, rtol=2e-3)
    np.testing.assert_allclose(hidden[0].radiance[ahead], (0, 1, 0), atol=1e-3)
    np.testing.assert_allclose(panorama.origin, (0, 0, 1), atol=1e-6)


def test_opened_they_are_objects(fresh_blend, box):
    assert fresh_blend.ops.panorama.open_layers() == {"FINISHED"}
    collection = fresh_blend.data.collections["Layers"]
    assert {o.name for o in collection.objects} == {"Layers Origin", "room", "room at infinity", "objects"}
    np.testing.assert_allclose(collection.objects["Layers Origin"].location, ORIGIN, atol=1e-6)


def test_beside_a_place_they_are_opened_in_a_scene_of_their_own(fresh_blend, room, tmp_path):
    write_layers(layered_box(), tmp_path / "layers")
    room.panorama_layers.folder = str(tmp_path / "layers")
    room.render.engine = "CYCLES"
    before = set(room.objects)
    assert fresh_blend.ops.panorama.open_layers() == {"FINISHED"}
    assert set(room.objects) == before
    scene = fresh_blend.data.scenes["Layers"]
    assert {o.name for o in scene.objects} == {"Layers Origin", "room", "room at infinity", "objects"}
    assert scene.render.engine == "CYCLES"
    assert scene.panorama_layers.found


@pytest.mark.parametrize("suffix", [".glb", ".obj", ".ply"])
def test_written_for_other_programs(fresh_blend, box, tmp_path, suffix):
    target = tmp_path / f"a{suffix}"
    done = fresh_blend.ops.panorama.export_layers(filepath=str(tmp_path / "a"), file_format=suffix)
    assert done == {"FINISHED"}
    assert target.stat().st_size > 10_000


def test_the_panel_knows_what_is_in_the_folder(fresh_blend, box, tmp_path):
    layers = box.panorama_layers
    assert layers.found == "room, objects; radius 0.5 m"
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "panorama.xml").write_text("<Panorama")
    layers.folder = str(tmp_path / "bad")
    assert layers.found == ""
    assert "no XML that can be read" in layers.problem
    layers.folder = str(tmp_path)
    assert (layers.found, layers.problem) == ("", "")


def reason(bpy, verb):
    from expanded_panoramas.operators import layers

    missing = {"make_layers": layers.making_missing}.get(verb, layers.layers_missing)
    assert not getattr(bpy.ops.panorama, verb).poll()
    return missing(bpy.context.scene)


def test_buttons_say_why_not(fresh_blend, room, tmp_path):
    assert reason(fresh_blend, "open_layers") == "Choose a folder with layers, or make them"
    assert reason(fresh_blend, "export_layers") == "Choose a folder with layers, or make them"
    room.panorama_layers.folder = ""
    assert reason(fresh_blend, "make_layers") == "Choose a folder for the layers"
    room.panorama_set.result.is_solved = False
    assert reason(fresh_blend, "make_layers") == "Calibrate first"


def test_folders_that_are_no_place_for_layers_are_refused(fresh_blend, room, tmp_path, monkeypatch):
    def refuses(folder, message):
        room.panorama_layers.folder = str(folder)
        with pytest.raises(RuntimeError, match=message):
            fresh_blend.ops.panorama.make_layers()

    refuses(tmp_path, "has other files in it and no panorama.xml: choose another folder")
    refuses(tmp_path / "map.exr", "is a file, must be a folder")
    refuses(tmp_path / "no" / "layers", "the folder .*no does not exist")
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    refuses(tmp_path / "layers", "cannot be written")
    refuses("//layers", "is relative to the .blend: save that first")
    assert [path.name for path in tmp_path.iterdir()] == ["map.exr"]


def test_layers_gone_or_damaged_change_nothing(fresh_blend, box, tmp_path):
    next((tmp_path / "box").glob("1_*_d.exr")).unlink()
    with pytest.raises(RuntimeError, match="is missing"):
        fresh_blend.ops.panorama.open_layers()
    assert not fresh_blend.data.collections
    with pytest.raises(RuntimeError, match="is missing"):
        fresh_blend.ops.panorama.export_layers(filepath=str(tmp_path / "a.glb"))
    assert not (tmp_path / "a.glb").exists()
