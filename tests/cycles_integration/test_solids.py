"""Closed solids are found as they are rendered, whatever the viewport shows of them."""

import pytest

bpy = pytest.importorskip("bpy")

import small_scenes as small  # noqa: E402
from mathutils import Vector  # noqa: E402

from expanded_panoramas.cycles_integration.solids import closed_solids  # noqa: E402


def found(scene):
    return {thing.name for thing in closed_solids(scene.view_layers[0], Vector())}


@pytest.fixture
def scene(fresh_blend):
    """A ball in a collection, and a plane that is as thick as its modifier makes it."""
    scene = fresh_blend.context.scene
    things = bpy.data.collections.new("things")
    scene.collection.children.link(things)
    ball = small.add_ball(scene, None, 0.5, (2, 0, 0))
    scene.collection.objects.unlink(ball)
    things.objects.link(ball)
    plate = small.add_plane(scene, None, 1, (0, 0, 3))
    plate.modifiers.new("thickness", "SOLIDIFY").thickness = 0.1
    return scene


def flags(scene):
    ball, plate = scene.objects["ball"], scene.objects["plane"]
    child = scene.view_layers[0].layer_collection.children["things"]
    return (
        ball.hide_viewport,
        ball.hide_get(),
        child.hide_viewport,
        child.collection.hide_viewport,
        plate.modifiers[0].show_viewport,
    )


@pytest.mark.parametrize("number", range(5))
def test_what_the_viewport_hides_is_found_and_stays_hidden(scene, number):
    ball, plate = scene.objects["ball"], scene.objects["plane"]
    child = scene.view_layers[0].layer_collection.children["things"]
    (
        lambda: setattr(ball, "hide_viewport", True),
        lambda: ball.hide_set(True),
        lambda: setattr(child, "hide_viewport", True),
        lambda: setattr(child.collection, "hide_viewport", True),
        lambda: setattr(plate.modifiers[0], "show_viewport", False),
    )[number]()
    before = flags(scene)
    assert found(scene) == {"ball", "plane"}
    assert flags(scene) == before


def test_what_is_not_rendered_is_not_found(scene):
    scene.objects["ball"].hide_render = True
    scene.objects["plane"].modifiers[0].show_render = False
    assert found(scene) == set()
    assert not scene.objects["ball"].hide_viewport


def test_what_an_instance_shows_is_found_where_the_viewport_hides_it(scene):
    things = bpy.data.collections["things"]
    scene.collection.children.unlink(things)
    empty = bpy.data.objects.new("instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", things
    scene.collection.objects.link(empty)
    bpy.data.objects["ball"].hide_viewport = True
    assert found(scene) == {"ball", "plane"}
    assert bpy.data.objects["ball"].hide_viewport
