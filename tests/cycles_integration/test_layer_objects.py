"""Layers as objects of Blender: from the origin they show the panorama, from beside it their own depth."""

import cv2
import numpy as np
import pytest
from box_layers import BOTH, HALF
from layered_box import ORIGIN, RADIUS, ROTATION, layered_box, radiance_in

from expanded_panoramas.cycles_integration import layer_objects
from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.export.pieces import MESHES
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.flattened import flattened

WIDTH, HEIGHT = 128, 64
TURN_OF_CAMERA = np.array([[0, 0, -1.0], [-1, 0, 0], [0, 1, 0]])
"""Panorama from camera: that looks along +x, its left along +y, its top along +z."""


def render(bpy, tmp_path, origin=None, mesh=None):
    """The equirectangular picture (H, W, 3) from the panorama's origin, or an origin [m] in its frame."""
    scene = bpy.context.scene
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    data.type = "PANO"
    target = data if hasattr(data, "panorama_type") else data.cycles
    target.panorama_type = "EQUIRECTANGULAR"
    eye = ORIGIN if origin is None else ORIGIN + ROTATION @ origin
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = ROTATION @ TURN_OF_CAMERA, eye
    camera.matrix_world = matrix.T.tolist()
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(tmp_path / "render.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath, check_existing=False)
    pixels = np.array(image.pixels[:], np.float32).reshape(HEIGHT, WIDTH, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return pixels


def psnr(got, expected):
    return -10 * np.log10(np.mean((got - expected) ** 2))


def painted(panorama):
    """The same with objects that are as dark as the room is bright, so that each can be told from it."""
    *others, objects = panorama.layers
    attributes = {**objects.attributes, "radiance": np.float32(1) - objects.radiance}
    layers = (*others, Layer("objects", objects.mapping, attributes))
    return LayeredPanorama(layers, panorama.world_from_panorama, panorama.origin, panorama.radius)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("mapping", BOTH)
def test_from_the_origin_it_is_the_panorama(fresh_blend, tmp_path, mapping, mesh):
    panorama = painted(layered_box(mapping, 96 if mapping == "cube map" else WIDTH))
    layer_objects.add_layers(fresh_blend.context.scene, panorama, MESHES[mesh])
    got, expected = render(fresh_blend, tmp_path), flattened(panorama)
    inside = cv2.erode(panorama.layers[-1].mask.astype(np.uint8), np.ones((3, 3)))
    rim = inside != cv2.dilate(panorama.layers[-1].mask.astype(np.uint8), np.ones((3, 3)))
    if mapping == "cube map":  # its objects' rim runs between the picture's pixels
        sharp = np.abs(expected - radiance_in(equirectangular.pixel_directions(WIDTH, HEIGHT))).max(axis=2)
        rim = cv2.morphologyEx(sharp, cv2.MORPH_GRADIENT, np.ones((3, 3))) > 0.1
    rows = np.s_[1:-1]  # at the poles Cycles' look-up is another one, see test_environment_texture
    keep = ~rim[rows]
    assert psnr(got[rows][keep], expected[rows][keep]) > 45
    assert psnr(got, expected) > 25


def test_from_beside_it_near_things_move_more(fresh_blend, tmp_path):
    """The closed form: each wall has the colour of the direction from the origin to its point."""
    layer_objects.add_layers(fresh_blend.context.scene, layered_box(width=256, names=("walls",)))
    eye = np.array([0.5, -0.4, 0.3])
    got = render(fresh_blend, tmp_path, eye)
    towards = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    with np.errstate(divide="ignore"):
        distance = np.min((np.sign(towards) * HALF - eye) / towards, axis=2)
    points = eye + towards * distance[..., None]
    expected = radiance_in(points / np.linalg.norm(points, axis=2, keepdims=True))
    assert psnr(got, expected) > 45
    assert psnr(got, radiance_in(towards)) < 25


def test_what_is_made(fresh_blend):
    made = layer_objects.add_layers(fresh_blend.context.scene, layered_box())
    assert [thing.name for thing in made.objects] == ["room", "room at infinity", "objects"]
    assert made.collection.name == "Layers"
    assert made.collection in list(fresh_blend.context.scene.collection.children)
    assert made.origin["panorama_radius"] == RADIUS
    np.testing.assert_allclose(made.origin.matrix_world.translation, ORIGIN, atol=1e-6)
    assert all(thing.parent == made.origin for thing in made.objects)
    nodes = [node for thing in made.objects for node in thing.data.materials[0].node_tree.nodes]
    assert len({node.image for node in nodes if node.type == "TEX_ENVIRONMENT"}) == 2
    for thing in made.objects:
        assert not thing.data.validate()


def test_a_mesh_beyond_the_domain_is_cut_by_its_mask(fresh_blend, tmp_path):
    panorama = painted(layered_box(width=WIDTH, names=("walls", "objects")))
    sphere = MESHES["grid"](layered_box(width=32, names=("walls",)).layers[0], 0)

    class Half:
        points, triangles = sphere.points / 2, sphere.triangles

    def mesh_of(part, radius):
        return Half if part.name == "objects" else MESHES["quadtree"](part, radius)

    made = layer_objects.add_layers(fresh_blend.context.scene, panorama, mesh_of)
    assert len(made.objects[1].data.polygons) == len(sphere.triangles)
    rows = np.s_[1:-1]
    assert psnr(render(fresh_blend, tmp_path)[rows], flattened(panorama)[rows]) > 25


def test_the_empty_moves_all(fresh_blend):
    made = layer_objects.add_layers(fresh_blend.context.scene, layered_box(names=("walls",)))
    made.origin.location.z += 2
    fresh_blend.context.view_layer.update()
    np.testing.assert_allclose(
        made.objects[0].matrix_world.translation - made.origin.matrix_world.translation, 0, atol=1e-6
    )
    assert made.objects[0].matrix_world.translation.z == pytest.approx(ORIGIN[2] + 2)


def test_refused_before_anything_is_made(fresh_blend):
    bare = Layer("bare", "equirectangular", {"depth": np.ones((2, 4), np.float32)})
    with pytest.raises(ValueError, match="layer 'bare' has no radiance"):
        layer_objects.add_layers(
            fresh_blend.context.scene, LayeredPanorama((bare,), np.eye(3), np.zeros(3), 0.0)
        )
    with pytest.raises(ValueError, match=r"far 1\.0 m must be finite and beyond"):
        layer_objects.add_layers(fresh_blend.context.scene, layered_box(), far=1.0)
    assert not fresh_blend.data.collections
    assert not fresh_blend.data.meshes
