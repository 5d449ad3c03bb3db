"""Objects stand where the cursor points: on the floor or a support, as they were turned."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from room_job import built, calibrated, select

from expanded_panoramas.sample_scenes import closed_room as room

from mathutils import Matrix, Vector  # isort: skip; it comes with bpy, which the line above imports

EYE = Vector((0, 0, room.CAMERA_HEIGHT))
LENGTH = 1e-4  # [m]


def add_cube(bpy, name="cube", matrix=None, parent=None):
    """A cube of 2 m about its origin."""
    mesh = bpy.data.meshes.new(name)
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)])
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    thing.parent = parent
    thing.matrix_world = matrix or Matrix()
    bpy.context.view_layer.update()
    return thing


def spot(bpy, towards, eye=EYE):
    from expanded_panoramas.cycles_integration.standing import spot_under

    context = bpy.context
    return spot_under(context.scene, context.evaluated_depsgraph_get(), eye, Vector(towards) - eye)


def lowest(thing):
    return min((thing.matrix_world @ vertex.co).z for vertex in thing.data.vertices)


def test_spots_on_floor_and_table(fresh_blend, tmp_path):
    built(fresh_blend, tmp_path)
    found, name = spot(fresh_blend, (1.0, 1.0, 0))
    assert (tuple(found), name) == (pytest.approx((1, 1, 0), abs=LENGTH), "'floor'")
    x, y = room.TABLE.centre
    found, name = spot(fresh_blend, (x, y, room.TABLE.size[2]))
    assert (tuple(found), name) == (pytest.approx((x, y, room.TABLE.size[2]), abs=LENGTH), "'table'")


def test_beyond_what_was_built_is_the_floor_too(fresh_blend, tmp_path):
    calibrated(fresh_blend, tmp_path)
    found, name = spot(fresh_blend, (3, -4, 0), eye=Vector((1, 1, 5)))
    assert (tuple(found), name) == (pytest.approx((3, -4, 0), abs=LENGTH), "the floor")


@pytest.mark.parametrize(
    ("towards", "eye", "reason"),
    [
        ((2, 0, room.CAMERA_HEIGHT), EYE, "at the horizon or above it"),
        ((2, 0, 9), EYE, "at the horizon or above it"),
        ((400, 0, 0), EYE, "at the horizon or above it"),
        ((40, 40, -9), Vector((40, 40, -1)), "seen from below"),
        ((*room.TABLE.centre, 0.3), Vector((0, 0.4, 0.4)), "a side of 'table'"),
    ],
)
def test_where_nothing_stands(fresh_blend, tmp_path, towards, eye, reason):
    built(fresh_blend, tmp_path)
    with pytest.raises(ValueError, match=reason):
        spot(fresh_blend, towards, eye)


def test_supports_that_are_hidden_carry_all_the_same(fresh_blend, tmp_path):
    built(fresh_blend, tmp_path)
    fresh_blend.data.objects["table"].hide_viewport = True
    fresh_blend.context.view_layer.update()
    assert spot(fresh_blend, (*room.TABLE.centre, room.TABLE.size[2]))[1] == "'table'"


def test_a_turned_object_comes_to_lie_on_the_spot(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    turned = Matrix.Translation((5, 6, 7)) @ Matrix.Rotation(0.7, 4, (1, 2, 3)) @ Matrix.Scale(0.2, 4)
    cube = add_cube(bpy, matrix=turned)
    cube.panorama_role = "SUPPORT"
    select(bpy, "cube")
    bpy.ops.panorama.send_to_place(location=(1, -2, 0.5))
    bpy.context.view_layer.update()
    assert lowest(cube) == pytest.approx(0.5, abs=LENGTH)
    assert np.allclose(cube.matrix_world.to_3x3(), turned.to_3x3(), atol=1e-6)
    corners = [cube.matrix_world @ vertex.co for vertex in cube.data.vertices]
    middle = [(min(c[i] for c in corners) + max(c[i] for c in corners)) / 2 for i in (0, 1)]
    assert middle == pytest.approx([1, -2], abs=LENGTH)
    assert cube.panorama_role == "SYNTHETIC"


def test_several_objects_keep_their_arrangement(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    above = add_cube(bpy, "above")  # first, as it stands in the scene before what it hangs on
    below = add_cube(bpy, "below", Matrix.Translation((0, 0, 4)))
    above.parent, above.matrix_world = below, Matrix.Translation((0.5, 0, 6))
    bpy.context.view_layer.update()
    aside = add_cube(bpy, "aside", Matrix.Translation((3, 0, 4)))
    select(bpy, "below", "above", "aside")
    bpy.ops.panorama.send_to_place(location=(10, 0, 0))
    bpy.context.view_layer.update()
    offset = below.matrix_world.translation - Vector((0, 0, 4))
    assert lowest(below) == pytest.approx(0, abs=LENGTH)
    for thing, before in ((above, (0.5, 0, 6)), (aside, (3, 0, 4))):
        assert (thing.matrix_world.translation - Vector(before) - offset).length < LENGTH


def test_what_hangs_on_an_empty_stands_on_its_own_bottom(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    empty = bpy.data.objects.new("rig", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.location = (0, 0, 9)
    bpy.context.view_layer.update()
    child = add_cube(bpy, "child", Matrix.Translation((4, 0, 3)), parent=empty)
    select(bpy, "rig")
    bpy.ops.panorama.send_to_place(location=(0, 0, 0))
    bpy.context.view_layer.update()
    assert lowest(child) == pytest.approx(0, abs=LENGTH)


def test_an_instanced_collection_stands_on_its_bottom(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    source = bpy.data.collections.new("source")
    cube = add_cube(bpy)
    bpy.context.scene.collection.objects.unlink(cube)
    source.objects.link(cube)
    instance = bpy.data.objects.new("instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", source
    bpy.context.scene.collection.objects.link(instance)
    instance.location = (3, 3, 9)
    bpy.context.view_layer.update()
    select(bpy, "instance")
    bpy.ops.panorama.send_to_place(location=(0, 0, 0.25))
    bpy.context.view_layer.update()
    assert tuple(instance.matrix_world.translation) == pytest.approx((0, 0, 1.25), abs=LENGTH)


def test_pieces_of_the_place_stay(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    before = bpy.data.objects["table"].matrix_world.copy()
    for name in ("table", "Panorama Origin"):
        select(bpy, name)
        with pytest.raises(RuntimeError, match=f"'{name}' is part of the place"):
            bpy.ops.panorama.send_to_place(location=(0, 0, 0))
    assert bpy.data.objects["table"].matrix_world == before
    select(bpy, "table")
    bpy.ops.panorama.store_coordinates()
    bpy.ops.panorama.send_to_place(location=(0, 0, 0))  # with its picture
    assert bpy.data.objects["table"].panorama_role == "SUPPORT"


def test_it_is_undone_in_one_step(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    add_cube(bpy, matrix=Matrix.Translation((0, 0, 5)))
    select(bpy, "cube")
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.panorama.send_to_place("EXEC_DEFAULT", True, location=(2, 0, 0))
    assert bpy.data.objects["cube"].location.x == pytest.approx(2)
    bpy.ops.ed.undo()
    assert bpy.data.objects["cube"].location.z == pytest.approx(5)


def test_the_ray_on_the_flat_panorama_goes_through_the_calibration(fresh_blend, tmp_path, monkeypatch):
    from expanded_panoramas.operators import placing

    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    origin = bpy.context.scene.panorama_place.origin
    origin.matrix_world = Matrix.Translation((0, 0, 1.5)) @ Matrix.Rotation(math.radians(90), 4, "Z")
    bpy.context.view_layer.update()
    monkeypatch.setattr(
        placing, "canvas_of", lambda *_: SimpleNamespace(uv_at=lambda xy: np.array([0.5, 0.75]))
    )
    region = SimpleNamespace(x=0, y=0, type="WINDOW")
    context = SimpleNamespace(
        scene=bpy.context.scene, area=SimpleNamespace(type="IMAGE_EDITOR"), region=region
    )
    eye, direction = placing.ray_under(context, SimpleNamespace(mouse_x=5, mouse_y=5))
    assert tuple(eye) == pytest.approx((0, 0, 1.5))
    assert tuple(direction) == pytest.approx((0, math.sqrt(0.5), -math.sqrt(0.5)), abs=1e-6)
