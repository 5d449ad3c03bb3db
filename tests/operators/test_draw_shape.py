"""What is drawn is added to the set and built in one step, or not at all."""

from types import SimpleNamespace

import numpy as np
import pytest
from room_job import calibrated, write_room

from expanded_panoramas.ibl_toolkit.panorama_set import set_to_dict

pytest.importorskip("bpy")
from drawing_hand import Hand

LENGTH_M = 1e-5  # picks are stored in single precision


def drawing(bpy, kind, of=""):
    """A hand that draws in the scene, with the tool as the operator makes it."""
    from expanded_panoramas.operators.tools.draw_shape import PANORAMA_OT_draw_shape

    reports = []
    operator = SimpleNamespace(kind=kind, of=of, report=lambda level, text: reports.append(text))
    operator.tool = PANORAMA_OT_draw_shape.make_tool(operator, bpy.context)
    hand = Hand(kind, stand=operator.tool.shape.stand)
    hand.tool = operator.tool
    hand.apply = lambda: PANORAMA_OT_draw_shape.work(operator, bpy.context)
    return hand


def everything(bpy):
    """What a refusal must leave alone."""
    from expanded_panoramas.operators.conversion import set_from_state

    state = bpy.context.scene.panorama_set
    things = {thing.name: [list(row) for row in thing.matrix_world] for thing in bpy.data.objects}
    flags = state.shapes_are_old, state.maps_are_old, state.active_shape, len(state.shapes)
    return set_to_dict(set_from_state(state), "/"), things, flags


@pytest.fixture
def empty_room(fresh_blend, tmp_path):
    """A calibrated scene without shapes."""
    state = calibrated(fresh_blend, tmp_path)
    state.shapes.clear()
    fresh_blend.context.view_layer.update()
    return fresh_blend


def draw_floor(bpy, kind="rectangle"):
    hand = drawing(bpy, kind)
    hand.click((-2, -2), (2, -2), (1, 2))
    hand.apply()


def test_a_room_is_built_with_its_roles(empty_room):
    bpy = empty_room
    hand = drawing(bpy, "room")
    hand.click((-2, -2), (2, -2), (2, 2), (-2, 2), (-2, -2))
    hand.type("2.5")
    assert hand.enter() == "CONFIRM", hand.tool.problem
    assert hand.apply() == "Built floor and walls"
    floor, walls = (bpy.data.objects[name] for name in ("floor", "walls"))
    assert (floor.panorama_role, walls.panorama_role) == ("SUPPORT", "ENVIRONMENT")
    assert list(walls.scale) == pytest.approx([4, 4, 2.5], abs=LENGTH_M)
    state = bpy.context.scene.panorama_set
    assert not state.shapes_are_old
    assert [shape.is_built for shape in state.shapes] == [True, True]


def test_names_differ_and_walls_stand_over_the_last_flat_shape(empty_room):
    bpy = empty_room
    with pytest.raises(ValueError, match="draw a flat shape first"):
        drawing(bpy, "walls")
    draw_floor(bpy)
    draw_floor(bpy)
    state = bpy.context.scene.panorama_set
    assert [shape.name for shape in state.shapes] == ["rectangle", "rectangle 2"]
    hand = drawing(bpy, "walls")
    assert hand.click((2, 1, 2.4)) == "CONFIRM"
    hand.apply()
    assert state.shapes[-1].of == "rectangle 2"
    assert bpy.data.objects["walls"].scale.z == pytest.approx(2.4, abs=LENGTH_M)
    with pytest.raises(ValueError, match="no flat shape is called 'walls'"):
        drawing(bpy, "walls", of="walls")


def test_a_refused_shape_leaves_the_scene_alone_and_the_tool_at_work(empty_room):
    bpy = empty_room
    draw_floor(bpy)
    before = everything(bpy)
    hand = drawing(bpy, "walls")
    hand.click((2, 1, 1.2))  # below the camera
    with pytest.raises(ValueError, match="the ceiling at 1.200 m is not above the panorama"):
        hand.apply()
    assert everything(bpy) == before
    assert "the ceiling at 1.200 m" in hand.tool.problem
    hand.click((2, 1, 2.4))
    hand.apply()
    assert len(bpy.context.scene.panorama_set.shapes) == 2


def test_a_shape_of_an_older_calibration_is_refused(empty_room):
    bpy = empty_room
    hand = drawing(bpy, "square")
    hand.click((1, 1), (2, 2))
    bpy.context.scene.panorama_set.camera_height = 2.0
    bpy.context.view_layer.update()
    with pytest.raises(ValueError, match="the calibration has changed since"):
        hand.apply()
    assert not bpy.context.scene.panorama_set.shapes


def test_a_half_picked_shape_of_the_list_is_in_nobodys_way(empty_room):
    bpy = empty_room
    bpy.ops.panorama.add_shape(kind="box")
    draw_floor(bpy)
    state = bpy.context.scene.panorama_set
    assert state.shapes[-1].is_built
    assert state.shapes_are_old  # the other one is still to be built


def test_role_and_height_of_the_list_are_built(empty_room):
    bpy = empty_room
    draw_floor(bpy)
    hand = drawing(bpy, "walls")
    hand.click((2, 1, 2.4))
    hand.apply()
    shape = bpy.context.scene.panorama_set.shapes["walls"]
    shape.role, shape.has_height, shape.height = "SUPPORT", True, 3.0
    assert bpy.context.scene.panorama_set.shapes_are_old
    bpy.ops.panorama.build()
    walls = bpy.data.objects["walls"]
    assert (walls.panorama_role, walls.scale.z) == ("SUPPORT", pytest.approx(3))


def test_it_says_what_comes_first(fresh_blend, tmp_path):
    bpy = fresh_blend
    with pytest.raises(RuntimeError, match="Calibrate first"):
        bpy.ops.panorama.draw_shape(kind="room")
    bpy.ops.panorama.import_set(filepath=str(write_room(tmp_path)))
    bpy.ops.panorama.calibrate()
    state = bpy.context.scene.panorama_set
    state.picks[0].points[0].uv = np.add(state.picks[0].points[0].uv, 1e-4)
    with pytest.raises(RuntimeError, match="calibrate again"):
        bpy.ops.panorama.draw_shape(kind="room")


def test_without_a_mouse_it_says_so(empty_room):
    with pytest.raises(RuntimeError, match="works with the mouse"):
        empty_room.ops.panorama.draw_shape("EXEC_DEFAULT", kind="room")
