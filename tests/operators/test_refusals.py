"""What operators refuse: an error that says why, and the scene as it was."""

import json

import numpy as np
import pytest
from room_job import built, calibrated, picture, select, write_room

from expanded_panoramas.ibl_toolkit.images import write_exr


def image_editor(bpy):
    """A context with an Image Editor."""
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "IMAGE_EDITOR"
    space = area.spaces.active
    return bpy.context.temp_override(window=window, area=area, space_data=space), space


@pytest.mark.parametrize(
    ("operator", "reason"),
    [
        ("export_set", "Open a panorama first"),
        ("calibrate", "Open a panorama first"),
        ("build", "Open a panorama first"),
        ("remove_item", "Add a pick or a shape first"),
        ("set_point", "Only in the Image Editor"),
        ("set_role", "Select mesh objects first"),
        ("store_coordinates", "Calibrate first"),
        ("clear_coordinates", "Calibrate first"),
        ("write_uv", "Calibrate first"),
        ("add_ball", "Calibrate first"),
        ("add_camera", "Calibrate first"),
        ("prepare", "Calibrate first"),
        ("export_depth", "Calibrate first"),
        ("set_up_picture", "Calibrate first"),
        ("render_frame", "Calibrate first"),
        ("render_panorama", "Calibrate first"),
    ],
)
def test_an_empty_scene_says_what_comes_first(fresh_blend, operator, reason):
    with pytest.raises(RuntimeError, match=reason):
        getattr(fresh_blend.ops.panorama, operator)()


def test_each_step_names_the_one_before(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    with pytest.raises(RuntimeError, match="Build shapes first"):
        bpy.ops.panorama.prepare()
    bpy.ops.panorama.build()
    with pytest.raises(RuntimeError, match="Prepare the light first"):
        bpy.ops.panorama.render_frame()


def test_images_that_are_no_panoramas(fresh_blend, tmp_path):
    bpy = fresh_blend
    square = tmp_path / "square.exr"
    write_exr(square, {name: np.ones((8, 8), np.float32) for name in "RGB"}, {})
    for path, reason in ((square, "square.exr"), (tmp_path / "none.exr", "No such file")):
        with pytest.raises(RuntimeError, match=reason):
            bpy.ops.panorama.load_image(filepath=str(path))
        assert bpy.context.scene.panorama_set.image_path == ""
        assert not bpy.data.images


def test_sets_that_are_wrong_leave_the_scene(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    document = json.loads((tmp_path / "room.json").read_text())
    document["shapes"][0]["colour"] = "red"
    (tmp_path / "wrong.json").write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match=r"shapes\[0\].colour is an unknown key"):
        bpy.ops.panorama.import_set(filepath=str(tmp_path / "wrong.json"))
    (tmp_path / "without.json").write_text(
        (tmp_path / "room.json").read_text().replace("room.exr", "gone.exr")
    )
    with pytest.raises(RuntimeError, match="gone.exr"):
        bpy.ops.panorama.import_set(filepath=str(tmp_path / "without.json"))
    assert state.result.is_solved
    assert state.image_path.endswith("room.exr")


def test_picks_that_contradict_leave_the_calibration(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    before = bpy.data.objects["floor"].matrix_world.copy()
    rug = next(pick for pick in state.picks if pick.plane == "FLOOR")
    kept = tuple(rug.points[0].uv)
    rug.points[0].uv = (kept[0], 0.2)
    assert state.calibration_is_old
    with pytest.raises(RuntimeError, match="is not convex"):
        bpy.ops.panorama.calibrate()
    with pytest.raises(RuntimeError, match="is not convex"):
        bpy.ops.panorama.build()
    assert bpy.data.objects["floor"].matrix_world == before


def test_a_shape_that_cannot_be_built_leaves_the_others(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    before = bpy.data.objects["floor"].matrix_world.copy()
    state.camera_height = 1.5
    table = next(shape for shape in state.shapes if shape.name == "table")
    table.points[0].uv = (0.5, 0.1)
    with pytest.raises(RuntimeError, match="shape 'table'"):
        bpy.ops.panorama.build()
    assert bpy.data.objects["floor"].matrix_world == before


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda s: setattr(s.shapes[1], "name", s.shapes[0].name), "names must differ"),
        (lambda s: setattr(s.shapes[1], "of", ""), "name the flat shape"),
        (lambda s: setattr(s.shapes[1], "of", "table"), "must name a polygon"),
        (lambda s: setattr(s.shapes[2].points[1], "picked", False), "'table': point 2 of 3 is not picked"),
        (lambda s: setattr(s.shapes[2].top, "picked", False), "'table': pick a point of its upper edge"),
        (lambda s: setattr(s.shapes[2], "has_height", True), "height is 0.0, must be above 0"),
        (lambda s: s.shapes.clear(), "Add a shape"),
        (lambda s: setattr(s.picks[0].points[3], "picked", False), "point 4 of 4 is not picked"),
        (lambda s: setattr(s, "camera_height", 0), "Give the camera height"),
        (lambda s: s.picks.clear(), "Add a rectangle"),
    ],
)
def test_the_button_says_what_is_missing(fresh_blend, tmp_path, change, reason):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    change(state)
    with pytest.raises(RuntimeError, match=reason):
        bpy.ops.panorama.build()


def test_lists_of_picks_and_shapes(fresh_blend):
    bpy = fresh_blend
    state = bpy.context.scene.panorama_set
    bpy.ops.panorama.add_pick(kind="LENGTH")
    with pytest.raises(RuntimeError, match="known length already"):
        bpy.ops.panorama.add_pick(kind="LENGTH")
    bpy.ops.panorama.add_pick(kind="PARALLELS")
    bpy.ops.panorama.resize_item(target="PICK")
    assert len(state.picks[1].points) == 4
    bpy.ops.panorama.resize_item(target="PICK", grow=False)
    with pytest.raises(RuntimeError, match="has 2 points and needs at least 2"):
        bpy.ops.panorama.resize_item(target="PICK", grow=False)
    bpy.ops.panorama.move_item(target="PICK", step=-1)
    assert [pick.kind for pick in state.picks] == ["PARALLELS", "LENGTH"]
    bpy.ops.panorama.remove_item(target="PICK")
    assert [pick.kind for pick in state.picks] == ["LENGTH"]
    with pytest.raises(RuntimeError, match="no shape is selected"):
        bpy.ops.panorama.remove_item(target="SHAPE")
    for kind in ("polygon", "walls", "box", "box"):
        bpy.ops.panorama.add_shape(kind=kind)
    assert [shape.name for shape in state.shapes] == ["polygon", "walls", "box", "box 2"]
    assert state.shapes[1].of == "polygon"
    with pytest.raises(RuntimeError, match="a box has 3 points"):
        bpy.ops.panorama.resize_item(target="SHAPE")


def test_a_point_from_the_cursor(fresh_blend, tmp_path):
    bpy = fresh_blend
    bpy.ops.panorama.import_set(filepath=str(write_room(tmp_path)))
    state = bpy.context.scene.panorama_set
    override, space = image_editor(bpy)
    with override:
        with pytest.raises(RuntimeError, match="shows no image"):
            bpy.ops.panorama.set_point(target="PICK", index=0)
        space.image = state.image
        space.cursor_location = (0.25, 0.1)
        bpy.ops.panorama.set_point(target="PICK", index=2)
        assert tuple(state.picks[0].points[2].uv) == pytest.approx((0.25, 0.9))
        space.uv_editor.show_pixel_coords = True
        space.cursor_location = (64, 32)
        state.active_shape = 2
        bpy.ops.panorama.set_point(target="SHAPE", index=-1)
        assert tuple(state.shapes[2].top.uv) == pytest.approx((0.25, 0.75))
        space.cursor_location = (-5, 32)
        with pytest.raises(RuntimeError, match="outside of the image"):
            bpy.ops.panorama.set_point(target="PICK", index=0)
        space.cursor_location = (5, 32)
        with pytest.raises(RuntimeError, match="point 5 is asked for"):
            bpy.ops.panorama.set_point(target="PICK", index=4)
        with pytest.raises(RuntimeError, match="only a shape has a top"):
            bpy.ops.panorama.set_point(target="PICK", index=-1)


def test_another_image_asks_for_another_calibration(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    write_exr(tmp_path / "other.exr", {name: picture()[..., 0] for name in "RGB"}, {})
    bpy.ops.panorama.load_image(filepath=str(tmp_path / "other.exr"))
    assert state.calibration_is_old
    bpy.ops.panorama.calibrate()
    assert bpy.context.scene.panorama_place.image.name == "other.exr"


def test_not_in_edit_mode(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    select(bpy, "floor")
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Only in Object Mode"):
        bpy.ops.panorama.store_coordinates()


def test_an_image_that_is_gone_is_named(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    (tmp_path / "room.exr").unlink()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    with pytest.raises(RuntimeError, match="room.exr"):
        bpy.ops.panorama.calibrate()


def test_uv_of_a_pole_that_must_not_be_divided(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    select(bpy, "table", "floor")
    with pytest.raises(RuntimeError, match="'floor': face 0 holds a pole"):
        bpy.ops.panorama.write_uv(divide=False)
    assert not bpy.data.objects["table"].data.uv_layers
