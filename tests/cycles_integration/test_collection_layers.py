"""Layers of collections that the artist has sorted, in one render job."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import small_scenes as small  # noqa: E402
from mathutils import Matrix  # noqa: E402

from expanded_panoramas.cycles_integration.collection_layers import capture_collections  # noqa: E402
from expanded_panoramas.cycles_integration.layer_render import LayerCapture  # noqa: E402

TINY = LayerCapture(64, samples=1)
EYE = (0, 0, 1)
CENTRE = 16, 32
"""Row and column of the direction +x."""


@pytest.fixture
def scene(fresh_blend):
    """A wall behind a ball that glows, and a floor in a collection within the wall's."""
    scene = fresh_blend.context.scene
    back, ground, front = (new_collection(name) for name in ("back", "ground", "front"))
    scene.collection.children.link(back)
    scene.collection.children.link(front)
    back.children.link(ground)
    grey = small.material(small.DIFFUSE)
    move(scene, small.add_plane(scene, grey, 8, (4, 0, 0), (-1, 0, 0)), back)
    move(scene, small.add_plane(scene, grey, 20), ground)
    move(scene, small.add_ball(scene, small.material("ShaderNodeEmission"), 0.5, (2, 0, 1)), front)
    return scene


def new_collection(name):
    return bpy.data.collections.new(name)


def move(scene, thing, collection):
    scene.collection.objects.unlink(thing)
    collection.objects.link(thing)


def test_each_collection_is_a_layer_lit_by_the_others(scene):
    before = [layer.name for layer in scene.view_layers]
    panorama = capture_collections(scene, Matrix.Translation(EYE), 0.5, TINY, ["back", "front"])
    back, front = panorama.layers
    assert (back.name, front.name, panorama.radius) == ("back", "front", 0.5)
    assert back.depth[CENTRE] == pytest.approx(4, rel=0.01)
    assert back.radiance[12:20, 28:36].mean() > 0.01  # by the ball before it, of which nothing is seen
    assert back.depth[-1, 0] == pytest.approx(1, rel=0.01)  # the collection within
    assert back.mask.all()
    assert np.isinf(back.depth[0]).all()
    assert front.depth[CENTRE] == pytest.approx(1.5, rel=0.02)
    assert 0.01 < front.mask.mean() < 0.1
    np.testing.assert_allclose(front.radiance[front.mask], 1, rtol=1e-3)
    assert [layer.name for layer in scene.view_layers] == before
    assert not scene.view_layers[0].layer_collection.children["front"].indirect_only


def test_the_radius_is_half_of_what_is_nearest(scene):
    panorama = capture_collections(scene, Matrix.Translation(EYE), None, TINY, ["back", "front"])
    assert panorama.radius == pytest.approx(0.5, rel=0.05)


def test_things_of_two_collections_are_refused(scene):
    bpy.data.collections["ground"].objects.link(bpy.data.objects["ball"])
    with pytest.raises(ValueError, match="'ball' in both collections 'back' and 'front'"):
        capture_collections(scene, Matrix(), 0.5, TINY, ["back", "front"])


def test_an_empty_that_instances_surfaces_is_a_stray(scene):
    def add_empty(name, instanced, parent):
        empty = bpy.data.objects.new(name, None)
        empty.instance_type, empty.instance_collection = "COLLECTION", instanced
        parent.objects.link(empty)

    lamps = new_collection("lamps")
    lamps.objects.link(bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT")))
    nested = new_collection("nested")
    add_empty("inner", bpy.data.collections["front"], nested)
    add_empty("light", lamps, scene.collection)
    add_empty("inside", bpy.data.collections["front"], bpy.data.collections["back"])
    capture_collections(scene, Matrix.Translation(EYE), 0.5, TINY, ["back", "front"])
    add_empty("outer", nested, scene.collection)
    with pytest.raises(ValueError, match="'outer' in none of the collections back, front"):
        capture_collections(scene, Matrix(), 0.5, TINY, ["back", "front"])


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["back", "top"], "no collection 'top'; its collections: 'back', 'ground', 'front'"),
        (["back", "ground", "front"], "'ground' lies in 'back'"),
        (["front", "front"], "'front' is named twice"),
        (["back"], "'ball' in none of the collections back"),
    ],
)
def test_collections_that_cannot_be_layers_are_refused(scene, names, words):
    with pytest.raises(ValueError, match=words):
        capture_collections(scene, Matrix(), 0.5, TINY, names)
