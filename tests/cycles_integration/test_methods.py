"""Each method shows exactly the photograph where nothing new is, and changes it where something is."""

import numpy as np
import panoramas
import pytest

from expanded_panoramas.sample_scenes import closed_room_truth
from expanded_panoramas.sample_scenes.closed_room_truth import add_camera, add_objects, hide_objects

SIZE = (64, 32)
PICTURE = (48, 27)
EXACT = 2e-5
SINGLE_MEAN = 0.02  # relative: `single` is a noisy render


@pytest.fixture
def prepared(fresh_blend, tmp_path, monkeypatch):
    from expanded_panoramas.cycles_integration import preparation

    monkeypatch.setattr(preparation, "IRRADIANCE_SAMPLES", 64)
    image = panoramas.smooth_panorama(tmp_path / "smooth.exr")
    scene, _ = panoramas.room_place(fresh_blend, image)
    fresh_blend.data.objects["floor"].panorama_reflectivity = 0.2
    camera = add_camera(scene)
    preparation.prepare(scene)
    return scene, camera


def render(scene, camera, path, **picture):
    from expanded_panoramas.cycles_integration.rendering import Picture, render_picture

    render_picture(scene, camera, Picture(*PICTURE, seed=1, **picture), path)
    return closed_room_truth.read_picture(path)


def photograph(scene, camera, path):
    """The catcher's own backplate without objects."""
    return render(scene, camera, path, method="catcher", samples=1)


@pytest.mark.parametrize("method", ["catcher", "difference", "directional"])
def test_without_objects_the_picture_is_the_photograph(prepared, tmp_path, method):
    """With a glossy floor, too."""
    scene, camera = prepared
    picture = render(scene, camera, tmp_path / "picture.exr", method=method, samples=4)
    assert np.abs(picture - photograph(scene, camera, tmp_path / "photograph.exr")).max() < EXACT


def test_single_shows_the_photograph_on_average(prepared, tmp_path):
    scene, camera = prepared
    picture = render(scene, camera, tmp_path / "picture.exr", method="single", samples=64)
    expected = photograph(scene, camera, tmp_path / "photograph.exr")
    assert picture.mean() == pytest.approx(expected.mean(), rel=SINGLE_MEAN)


@pytest.mark.parametrize("method", ["catcher", "single", "difference", "directional"])
def test_objects_appear_and_darken_the_floor(prepared, tmp_path, method):
    scene, camera = prepared
    add_objects(scene)
    picture = render(scene, camera, tmp_path / "picture.exr", method=method, samples=16)
    expected = photograph_without_objects(scene, camera, tmp_path)
    assert np.isfinite(picture).all()
    change = (picture - expected).mean(axis=2)
    assert (np.abs(change) > 0.1).mean() > 0.02
    assert change[12:20, 20:32].min() < -0.05


@pytest.mark.parametrize("method", ["catcher", "single", "difference"])
def test_real_surfaces_hide_what_is_behind_them(prepared, tmp_path, method):
    """Table 5.1: a new object outside the room is not seen, and neither lights nor shades it."""
    scene, camera = prepared
    settings = {"method": method, "samples": 4}
    without = render(scene, camera, tmp_path / "without.exr", **settings)
    for thing in add_objects(scene):
        thing.location.x += 5
    assert np.abs(render(scene, camera, tmp_path / "with.exr", **settings) - without).max() < EXACT


def photograph_without_objects(scene, camera, tmp_path):
    hide_objects(scene)
    return photograph(scene, camera, tmp_path / "photograph.exr")


def test_the_whole_panorama_keeps_the_file_where_nothing_is_new(prepared, tmp_path):
    from expanded_panoramas.cycles_integration import blender_images, rendering
    from expanded_panoramas.cycles_integration.place import place_of

    scene, _ = prepared
    with rendering.panorama_camera(scene) as camera:
        rendering.render_picture(scene, camera, rendering.Picture(*SIZE, samples=1), tmp_path / "whole.exr")
    image = blender_images.array_from_image(place_of(scene).image)
    assert np.array_equal(closed_room_truth.read_picture(tmp_path / "whole.exr"), image)


def test_an_unknown_method_is_refused(prepared, tmp_path):
    scene, camera = prepared
    with pytest.raises(ValueError, match="expected catcher, single"):
        render(scene, camera, tmp_path / "picture.exr", method="magic")


def test_an_unprepared_place_is_refused(fresh_blend, tmp_path):
    scene, _ = panoramas.room_place(fresh_blend, panoramas.smooth_panorama(tmp_path / "smooth.exr"))
    with pytest.raises(ValueError, match="not prepared"):
        render(scene, add_camera(scene), tmp_path / "picture.exr")


@pytest.mark.parametrize("method", ["catcher", "difference"])
def test_a_glossy_floor_mirrors_the_objects(prepared, fresh_blend, tmp_path, method):
    """A red wall of light behind the floor shows in a smooth floor, and not in a matte one."""
    from expanded_panoramas.cycles_integration import preparation

    scene, camera = prepared
    add_glowing_board(fresh_blend, scene)
    floor = fresh_blend.data.objects["floor"]
    floor.panorama_roughness = 0.0
    redness = []
    for floor.panorama_reflectivity in (0.0, 0.5):
        preparation.prepare(scene)
        picture = render(scene, camera, tmp_path / "picture.exr", method=method, samples=16)
        redness.append((picture[..., 0] - picture[..., 1])[18:24, 18:30].mean())
    assert redness[1] > redness[0] + 0.05


def add_glowing_board(bpy, scene):
    """A board across the view that emits red to mirror rays alone, so that it lights nothing diffuse."""
    mesh = bpy.data.meshes.new("board")
    mesh.from_pydata([(2.0, -2, 0), (0.5, -2.2, 0), (0.5, -2.2, 2), (2.0, -2, 2)], [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new("red")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (3, 0, 0, 1)
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    board = bpy.data.objects.new("board", mesh)
    board.visible_diffuse = False
    scene.collection.objects.link(board)


def test_a_support_mirrors_no_more_than_the_photograph_shows(fresh_blend, tmp_path):
    """A dark red floor in a bright grey room, asked to mirror half of it, still shows its dark red."""
    from expanded_panoramas.cycles_integration import preparation

    image = np.full((32, 64, 3), 0.8, np.float32)
    image[17:] = (0.2, 0.02, 0.02)
    scene, _ = panoramas.room_place(fresh_blend, panoramas.write_panorama(tmp_path / "red.exr", image))
    fresh_blend.data.objects["floor"].panorama_reflectivity = 0.5
    camera = add_camera(scene)
    preparation.prepare(scene)
    picture = render(scene, camera, tmp_path / "picture.exr", method="single", samples=32)
    expected = photograph(scene, camera, tmp_path / "photograph.exr")
    floor = (slice(20, 27), slice(24, 40))
    assert np.allclose(
        picture[floor].mean(axis=(0, 1)), expected[floor].mean(axis=(0, 1)), rtol=0.1, atol=0.01
    )
