"""The picking tool fed with events, without a window, and what its operator makes of the scene."""

from types import SimpleNamespace

import numpy as np
import pytest
from room_job import calibrated

pytest.importorskip("bpy")

SIZE = np.array([1000.0, 500.0])
RUG = [(0.5738, 0.7323), (0.4262, 0.7323), (0.4737, 0.6011), (0.5263, 0.6011)]


class Flat:
    """A canvas that shows the whole image, v downwards."""

    def uv_at(self, xy):
        uv = np.asarray(xy, float) / SIZE
        return uv if ((uv >= 0) & (uv <= 1)).all() else None

    def pixels_of(self, uv):
        return np.asarray(uv, float) * SIZE


def event(kind, value="PRESS", *, unicode="", shift=False, ctrl=False):
    return SimpleNamespace(type=kind, value=value, unicode=unicode, shift=shift, ctrl=ctrl)


def key(tool, kind, **more):
    return tool.handle(Flat(), np.zeros(2), event(kind, **more))


def mouse(tool, uv, kind="MOUSEMOVE", value="PRESS", **more):
    return tool.handle(Flat(), np.array(uv) * SIZE, event(kind, value, **more))


def click(tool, uv, **more):
    mouse(tool, uv, "LEFTMOUSE", **more)
    mouse(tool, uv, "LEFTMOUSE", "RELEASE", **more)


def drag(tool, start, end, **more):
    mouse(tool, start, "LEFTMOUSE")
    mouse(tool, end, **more)
    mouse(tool, end, "LEFTMOUSE", "RELEASE")


def new_tool(kind="RECTANGLE", plane="FLOOR", picks=(), camera_height=1.5, image=None):
    from expanded_panoramas.operators.tools.pick_tool import PickTool
    from expanded_panoramas.operators.tools.picks_copy import PicksCopy
    from expanded_panoramas.operators.tools.picks_editing import PicksEditing

    editing = PicksEditing(PicksCopy("room.exr", list(picks), camera_height))
    editing.begin(kind, plane, "X")
    return PickTool(editing, (4096, 2048), image=image)


def with_rug():
    tool = new_tool()
    for uv in RUG:
        click(tool, uv)
    return tool


def points(tool, pick=-1):
    return [point.uv if point.picked else None for point in tool.editing.copied.picks[pick].points]


def test_clicks_fill_a_rectangle_and_the_result_is_there_at_once():
    tool = new_tool()
    for number, uv in enumerate(RUG):
        assert tool.live.calibration is None
        assert f"point {number + 1} of 4" in tool.live.missing
        click(tool, uv)
    assert points(tool) == [pytest.approx(uv) for uv in RUG]
    assert tool.live.calibration.tilt_deg < 0.1
    assert tool.live.missing == ""
    click(tool, (0.1, 0.1))
    assert "has all its points" in tool.problem
    assert len(tool.editing.copied.picks) == 1


def test_what_does_not_solve_is_said():
    tool = with_rug()
    drag(tool, RUG[2], (0.5, 0.72))
    assert "is not convex" in tool.live.problem
    assert tool.live.calibration is None


def test_drag_moves_live_and_escape_puts_the_point_back():
    tool = with_rug()
    before = tool.live.calibration
    mouse(tool, np.add(RUG[0], (0.003, 0)), "LEFTMOUSE")
    mouse(tool, np.add(RUG[0], (0.013, 0.02)))
    assert points(tool)[0] == pytest.approx(np.add(RUG[0], (0.01, 0.02)))  # by as much as the mouse moved
    assert tool.live.calibration is not before
    for kind in ("ESC", "RIGHTMOUSE"):
        assert mouse(tool, (0.6, 0.8), kind) == "RUNNING"
        assert points(tool) == [pytest.approx(uv) for uv in RUG]
        assert tool.editing.active == (0, 0)
        mouse(tool, RUG[0], "LEFTMOUSE")
        mouse(tool, (0.6, 0.8))
    mouse(tool, (0.6, 0.8), "LEFTMOUSE", "RELEASE")
    assert points(tool)[0] == pytest.approx((0.6, 0.8))
    assert mouse(tool, (0.6, 0.8), "ESC") == "CANCEL"


def test_a_drag_beyond_the_panorama_keeps_the_last_place():
    tool = with_rug()
    mouse(tool, RUG[0], "LEFTMOUSE")
    mouse(tool, (0.6, 0.8))
    mouse(tool, (1.2, 0.8))
    tool.handle(None, None, event("MOUSEMOVE"))
    tool.handle(None, None, event("LEFTMOUSE", "RELEASE"))
    assert tool.dragged is None
    assert points(tool)[0] == pytest.approx((0.6, 0.8))


def test_a_click_on_a_point_only_selects_it():
    tool = with_rug()
    steps = len(tool._past)
    click(tool, np.add(RUG[1], 0.002))
    assert tool.editing.active == (0, 1)
    assert points(tool) == [pytest.approx(uv) for uv in RUG]
    assert len(tool._past) == steps


def test_a_line_may_begin_at_another_picks_corner():
    """What serves twice is one click with one error; a drag moves it instead."""
    rug = with_rug().editing
    tool = new_tool("VERTICAL", picks=rug.copied.picks)
    click(tool, np.add(RUG[0], (0.003, 0.0)))
    assert points(tool) == [pytest.approx(RUG[0]), None]
    assert points(tool, 0) == [pytest.approx(uv) for uv in RUG]
    click(tool, np.add(RUG[0], (0.008, 0.0)))  # 8 px beside: a point of its own
    assert points(tool)[1] == pytest.approx(np.add(RUG[0], (0.008, 0.0)))
    tool.undo()
    drag(tool, RUG[1], (0.4, 0.75))
    assert points(tool, 0)[1] == pytest.approx((0.4, 0.75))
    assert points(tool) == [pytest.approx(RUG[0]), None]
    assert tool.editing.active == (0, 1)
    click(tool, (0.2, 0.3))  # the vertical is still the one that is filled
    assert points(tool)[1] == pytest.approx((0.2, 0.3))


def test_arrows_move_by_a_pixel_of_the_image():
    tool = with_rug()
    key(tool, "RIGHT_ARROW")
    key(tool, "UP_ARROW", shift=True)
    u, v = RUG[3]
    assert points(tool)[3] == pytest.approx((u + 1 / 4096, v - 0.1 / 2048), abs=1e-7)


def test_arrows_in_a_3d_view_move_as_it_is_seen():
    from expanded_panoramas.ibl_toolkit.equirectangular import direction_from_uv
    from expanded_panoramas.ibl_toolkit.views import View
    from expanded_panoramas.operators.canvas import ViewCanvas

    window = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])
    looking_down = np.diag([-1.0, -1, 1, 1])  # upside down, so that the image's left is the view's right
    canvas = ViewCanvas(View.from_matrices(window, looking_down, np.eye(3), 1.5, (500, 500)))
    tool = with_rug()
    tool.editing.point(tool.editing.active).set((0.47, 0.93))
    before = np.array(points(tool)[3])
    for kind, step in (("RIGHT_ARROW", (1, 0)), ("UP_ARROW", (0, 1))):
        tool.handle(canvas, np.zeros(2), event(kind))
        after = np.array(points(tool)[3])
        moved = canvas.pixels_of(after) - canvas.pixels_of(before)
        assert moved / np.linalg.norm(moved) == pytest.approx(step, abs=0.02)
        angle = np.linalg.norm(direction_from_uv(after) - direction_from_uv(before))
        assert angle == pytest.approx(np.pi / 2048, rel=1e-2)
        before = after


def test_delete_makes_a_point_missing_and_an_empty_new_pick_goes():
    tool = with_rug()
    key(tool, "X")
    assert points(tool)[3] is None
    key(tool, "X")  # nothing is selected any more
    click(tool, (0.53, 0.61))
    assert points(tool)[3] == pytest.approx((0.53, 0.61))
    tool = new_tool("VERTICAL")
    for uv in ((0.3, 0.4), (0.3, 0.6), (0.7, 0.4)):
        click(tool, uv)
    assert len(tool.editing.copied.picks) == 2
    key(tool, "DEL")
    assert len(tool.editing.copied.picks) == 1


def test_floor_lines_go_on_and_a_deleted_line_goes():
    tool = new_tool("PARALLELS")
    for uv in ((0.3, 0.7), (0.4, 0.7), (0.3, 0.8), (0.4, 0.8), (0.3, 0.9)):
        click(tool, uv)
    assert points(tool)[4:] == [pytest.approx((0.3, 0.9)), None]
    key(tool, "X")
    assert len(points(tool)) == 4


def test_p_turns_floor_into_ceiling_and_wall():
    tool = with_rug()
    seen = []
    for _ in range(3):
        key(tool, "P", unicode="p")
        seen.append(tool.editing.copied.picks[0].plane)
    assert seen == ["CEILING", "WALL", "FLOOR"]
    tool.undo()
    assert tool.editing.copied.picks[0].plane == "WALL"
    lines = new_tool("PARALLELS")
    key(lines, "P", unicode="p")
    assert lines.editing.copied.picks[0].axis == "Y"
    assert key(new_tool("VERTICAL"), "P", unicode="p") == "RUNNING"


def test_fast_clicks_are_clicks():
    tool = new_tool()
    for uv in RUG:
        mouse(tool, uv, "LEFTMOUSE", "DOUBLE_CLICK")
        mouse(tool, uv, "LEFTMOUSE", "RELEASE")
    assert points(tool) == [pytest.approx(uv) for uv in RUG]


def test_tab_goes_through_all_points():
    tool = with_rug()
    seen = []
    for _ in range(5):
        key(tool, "TAB")
        seen.append(tool.editing.active[1])
    assert seen == [0, 1, 2, 3, 0]
    key(tool, "TAB", shift=True)
    assert tool.editing.active == (0, 3)


def test_undo_within_the_tool():
    tool = with_rug()
    key(tool, "LEFT_ARROW")
    tool.undo()
    assert points(tool)[3] == pytest.approx(RUG[3])
    tool.undo()
    assert points(tool)[3] is None
    tool.undo(redo=True)
    assert points(tool)[3] == pytest.approx(RUG[3])
    mouse(tool, RUG[0], "LEFTMOUSE")
    tool.undo()  # in the midst of a drag
    assert mouse(tool, (0.6, 0.8)) == "RUNNING"
    assert points(tool)[0] == pytest.approx(RUG[0])


def test_typed_numbers_are_the_scale():
    tool = new_tool(camera_height=0.0)
    for uv in RUG:
        click(tool, uv)
    assert tool.live.missing == "Give the camera height or a known length"
    assert tool.live.calibration is not None  # the tilt needs no scale
    for character in ("1", ".", "6", "5"):
        key(tool, "PERIOD" if character == "." else "NUMPAD_0", unicode=character)
    assert tool.takes_numbers
    assert (tool.editing.copied.camera_height, tool.live.missing) == (1.65, "")
    key(tool, "BACK_SPACE")
    assert tool.editing.copied.camera_height == 1.6
    key(tool, "C", unicode="c")
    key(tool, "M", unicode="m")
    assert tool.editing.copied.camera_height == pytest.approx(0.016)
    tool.undo()
    assert tool.editing.copied.camera_height == 0
    tool = new_tool("LENGTH")
    key(tool, "TWO", unicode="2")
    assert (tool.editing.length.metres, tool.editing.copied.camera_height) == (2.0, 1.5)


def test_keys_that_are_blenders():
    tool = with_rug()
    assert key(tool, "G", unicode="g") == "RUNNING"
    assert key(tool, "N", unicode="n") == "PASS"
    assert key(tool, "F12") == "PASS"
    assert key(tool, "S", unicode="s", ctrl=True) == "PASS"
    assert tool.handle(None, None, event("X")) == "PASS"
    assert tool.handle(None, None, event("RET")) == "CONFIRM"


def test_clicks_snap_to_corners_unless_told_not_to():
    image = np.ones((128, 256, 3), np.float32)
    image[:64, :128] = image[64:, 128:] = 4
    for switched, ctrl, uv in (
        (0, 0, (0.5, 0.5)),
        (1, 0, (0.503, 0.506)),
        (1, 1, (0.5, 0.5)),
        (0, 1, (0.503, 0.506)),
    ):
        tool = new_tool(image=image)
        for _ in range(switched):
            key(tool, "S", unicode="s")
        click(tool, (0.503, 0.506), ctrl=bool(ctrl))
        assert points(tool)[0] == pytest.approx(uv, abs=1e-4)


# The operator


def operator(context, kind="SELECTED", plane="FLOOR"):
    from expanded_panoramas.operators.tools.pick_points import PANORAMA_OT_pick_points as Operator

    said = []
    this = SimpleNamespace(kind=kind, plane=plane, axis="X", report=lambda level, text: said.append(text))
    this._calibrate = lambda scene: Operator._calibrate(this, scene)
    this.tool = Operator.make_tool(this, context)
    this.confirm = lambda: Operator.work(this, context)
    this.said = said
    return this


def stored(state):
    from expanded_panoramas.operators.tools.picks_copy import PicksCopy

    return PicksCopy.of(state)


def test_the_scene_changes_on_confirmation_only(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    before = stored(state)
    this = operator(bpy.context)
    this.tool.editing.select((0, 1))
    key(this.tool, "RIGHT_ARROW")
    assert stored(state) == before
    assert not state.calibration_is_old
    assert "Tilt" in this.confirm()
    after = stored(state)
    assert after.picks[0].points[1].uv[0] == pytest.approx(before.picks[0].points[1].uv[0] + 1 / 256)
    assert not state.calibration_is_old
    before.picks[0].points[1] = after.picks[0].points[1]
    assert after == before


def test_a_new_pick_is_stored_even_if_it_is_not_complete(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    count = len(state.picks)
    assert "Tilt" in operator(bpy.context, "VERTICAL").confirm()
    assert len(state.picks) == count  # nothing was clicked
    this = operator(bpy.context, "RECTANGLE", "WALL")
    click(this.tool, (0.4, 0.4))
    assert "point 2 of 4 is not picked" in this.confirm()
    assert state.active_pick == count
    assert (state.picks[count].plane, state.calibration_is_old) == ("WALL", True)
    assert [point.picked for point in state.picks[count].points] == [True, False, False, False]
    again = operator(bpy.context)
    assert again.tool.editing.target == count
    click(again.tool, (0.45, 0.4))
    again.confirm()
    assert [point.picked for point in state.picks[count].points] == [True, True, False, False]


def test_picks_that_contradict_are_kept_and_the_calibration_stays(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    tilt = state.result.tilt_deg
    this = operator(bpy.context)
    this.tool.editing.point((0, 0)).set((0.3, 0.2))
    assert "do not calibrate yet" in this.confirm()
    assert this.said == [state.problem]
    assert (state.calibration_is_old, state.result.tilt_deg) == (True, tilt)


def test_it_follows_the_sidebar(fresh_blend, tmp_path):
    from expanded_panoramas.operators.tools.pick_points import _follow

    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    tool = operator(bpy.context).tool
    tool.editing.set_scale(2.5)
    _follow(tool, state)
    assert tool.editing.copied.camera_height == 2.5
    rectangle = next(k for k, pick in enumerate(state.picks) if pick.kind == "RECTANGLE")
    state.picks[rectangle].plane = "CEILING"
    state.camera_height = 1.75
    _follow(tool, state)
    assert tool.editing.copied.picks[rectangle].plane == "CEILING"
    assert tool.editing.copied.camera_height == 1.75


@pytest.mark.parametrize("channels", [1, 3])
def test_pixels_of_any_image(channels):
    from expanded_panoramas.operators.tools.pick_points import _give_pixels

    tool = new_tool()
    _give_pixels(tool, np.full((130, 260, channels), 1e9, np.float32))
    assert tool.image.shape == (130, 260, 3)
    assert np.isfinite(tool.image).all()


def test_it_says_why_it_cannot(fresh_blend, tmp_path):
    bpy = fresh_blend
    with pytest.raises(RuntimeError, match="Open a panorama first"):
        bpy.ops.panorama.pick_points()
    state = calibrated(bpy, tmp_path)
    with pytest.raises(RuntimeError, match="works with the mouse"):
        bpy.ops.panorama.pick_points()
    this = operator(bpy.context)
    bpy.context.scene.name = "Renamed"
    with pytest.raises(ValueError, match="is gone"):
        this.confirm()
    bpy.data.images.remove(state.image)
    with pytest.raises(ValueError, match="open it again"):
        operator(bpy.context)


def test_a_removed_image_does_not_stop_the_confirmation(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    this = operator(bpy.context)
    bpy.data.images.remove(state.image)
    key(this.tool, "TAB")
    key(this.tool, "RIGHT_ARROW")
    assert "Tilt" in this.confirm()
    assert state.image is not None


def test_picks_stay_as_they_are_while_a_tool_edits_a_copy(fresh_blend, tmp_path, monkeypatch):
    from expanded_panoramas.operators.tools import base

    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    count = len(state.picks)
    monkeypatch.setattr(base, "_active", operator(bpy.context).tool)
    for change in (
        bpy.ops.panorama.remove_item,
        bpy.ops.panorama.move_item,
        bpy.ops.panorama.add_pick,
        bpy.ops.panorama.pick_points,
    ):
        with pytest.raises(RuntimeError, match="Pick Points is running"):
            change()
    assert len(state.picks) == count
