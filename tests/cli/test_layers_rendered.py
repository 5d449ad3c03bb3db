"""`layers` of scenes and sets, which Cycles renders."""

import json

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.files.storage import read_layers

WIDTH = 64


def save_scene(bpy, path):
    """A ball before a wall, and a camera; of the file `path`."""
    import small_scenes as small

    scene = bpy.context.scene
    small.add_plane(scene, small.material("ShaderNodeEmission"), 6, (3, 0, 0), (-1, 0, 0))
    small.add_ball(scene, small.material("ShaderNodeEmission", Color=(1, 0, 0, 1)), 0.5, (1.5, 0, 0))
    small.add_camera(scene, (0, 0, 0), (0, 1, 0), field_of_view=1)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def test_a_scene_is_rendered(fresh_blend, tmp_path, panorama):
    save_scene(fresh_blend, tmp_path / "scene.blend")
    before = (tmp_path / "scene.blend").read_bytes()
    command = [
        "layers",
        tmp_path / "scene.blend",
        "-o",
        tmp_path / "layers",
        "--width",
        WIDTH,
        "--samples",
        1,
    ]
    _, out, _ = panorama(*command, "--radius", 0.5, "--layers", 2, "--surfaces", "--json")
    result = json.loads(out)
    assert [layer["name"] for layer in result["layers"]] == ["surface 1", "surface 2"]
    assert result["layers"][0]["share"] == pytest.approx(1)
    assert {"surface 1", "surface 2", "writing"} <= set(result["seconds"])
    assert "depth jumps" in result["warnings"][0]
    second = read_layers(tmp_path / "layers").layers[1]
    np.testing.assert_allclose(np.nanmin(second.depth), 3, rtol=0.03)
    assert (tmp_path / "scene.blend").read_bytes() == before


def test_layers_of_a_scene_are_continuous(fresh_blend, tmp_path, panorama):
    save_scene(fresh_blend, tmp_path / "scene.blend")
    command = ["layers", tmp_path / "scene.blend", "-o", tmp_path / "layers", "--width", 128, "--samples", 1]
    _, out, err = panorama(*command, "--radius", 0.5, "--json")
    result = json.loads(out)
    assert (err, result["warnings"]) == ([], [])
    assert {"background", "front 1", "back of surface 1"} <= {layer["name"] for layer in result["layers"]}
    assert "splitting" in result["seconds"]


def test_origin_of_a_scene(fresh_blend, tmp_path, panorama):
    save_scene(fresh_blend, tmp_path / "scene.blend")
    command = ["layers", tmp_path / "scene.blend", "-o", tmp_path / "layers", "--width", 16, "--samples", 1]
    _, out, _ = panorama(*command, "--origin", 0, "1.5", "0.5", "--layers", 1, "--json")
    assert json.loads(out)["origin"] == [0, 1.5, 0.5]


def test_collections_of_a_scene_are_layers(fresh_blend, tmp_path, panorama):
    save_scene(fresh_blend, tmp_path / "scene.blend")
    command = ["layers", tmp_path / "scene.blend", "-o", tmp_path / "layers", "--collection", "things"]
    status, _, err = panorama(*command)
    assert status == 2
    assert "has no collection 'things'; its collections: none" in err[0]
    scene = fresh_blend.context.scene
    things = fresh_blend.data.collections.new("things")
    scene.collection.children.link(things)
    for thing in scene.objects:
        things.objects.link(thing)
    fresh_blend.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    _, out, _ = panorama(*command, "--width", 16, "--samples", 1, "--json")
    assert [layer["name"] for layer in json.loads(out)["layers"]] == ["things"]


def test_a_set_is_rebuilt_and_shows_its_photograph(fresh_blend, room, panorama):
    command = ["layers", room / "room.json", "-o", room / "layers", "--width", 128, "--samples", 1]
    _, out, _ = panorama(*command, "--radius", 0.4, "--surfaces", "--json")
    result = json.loads(out)
    assert result["origin"] == pytest.approx([0, 0, 1.5])
    first, second = read_layers(room / "layers").layers[:2]
    from expanded_panoramas.ibl_toolkit.images import read_panorama

    photograph = read_panorama(room / "room.exr")
    assert np.median(np.abs(first.radiance / photograph - 1)) < 2e-3
    assert (second.depth[second.mask] > first.depth[second.mask]).all()
    assert second.radiance[second.mask].mean() > 0.01
