"""What the picking tool says in each state of its picks."""

import pytest

pytest.importorskip("bpy")

RUG = [(0.5738, 0.7323), (0.4262, 0.7323), (0.4737, 0.6011), (0.5263, 0.6011)]


def tool(count=4, camera_height=1.5, kind="RECTANGLE"):
    from expanded_panoramas.operators.tools.pick_tool import PickTool
    from expanded_panoramas.operators.tools.picks_copy import PicksCopy
    from expanded_panoramas.operators.tools.picks_editing import PicksEditing

    editing = PicksEditing(PicksCopy("room.exr", [], camera_height))
    editing.begin(kind, "FLOOR", "X")
    for uv in RUG[:count]:
        editing.set_point(editing.next_missing(), uv)
    return PickTool(editing, (4096, 2048))


def said(a_tool, factor=0):
    from expanded_panoramas.ui.pick_texts import lines

    return "\n".join(line for line, _ in lines(a_tool, factor))


def test_it_says_what_to_click_and_what_the_picks_give():
    assert "Floor rectangle (P): click point 3 of 4. Snapping to corners" in said(tool(2))
    done = said(tool(), factor=20)
    assert "Enter to calibrate" in done
    assert "Tilt 0.0" in done
    assert "Residual 0.00 px" in done
    assert "drawn 20 times as large" in done
    assert "To calibrate" not in done


def test_it_says_what_is_missing_or_wrong():
    without = tool(camera_height=0.0)
    assert "Camera height: type it" in said(without)
    assert "To calibrate: Give the camera height" in said(without)
    without.typed = "1.6"
    assert "Camera height: 1.6_" in said(without)
    crossed = tool()
    crossed.editing.point((0, 2)).set(RUG[3])
    crossed.editing.point((0, 3)).set(RUG[2])
    assert "its sides cross" in said(crossed)
    crossed.problem = "nowhere to go"
    assert "nowhere to go" in said(crossed)


def test_lines_go_on_and_a_length_is_the_scale():
    assert "Vertical: click the next line, drag points" in said(tool(2, kind="VERTICAL"))
    assert "Known length: type it" in said(tool(2, kind="LENGTH"))
    with_none = tool(0)
    with_none.editing.copied.picks.clear()
    with_none.editing.target = -1
    assert "Drag points" in said(with_none)


def test_keys_have_icons():
    import bpy

    from expanded_panoramas.operators.tools.pick_tool import PickTool

    icons = bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
    assert all(icon in icons for icon, _ in PickTool.keys)
