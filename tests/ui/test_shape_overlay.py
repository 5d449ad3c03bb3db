"""What is drawn over the panorama while a shape is drawn: its curves, its sizes, and why it can't be."""

from types import SimpleNamespace

import numpy as np
import pytest
from room_job import built

pytest.importorskip("bpy")
from drawing_hand import FLAT, STAND, Hand, look_from


@pytest.fixture
def drawn(fresh_blend, monkeypatch):
    """Draws the overlay on a canvas and gives what was drawn: lists of lines, dots and texts."""
    from expanded_panoramas.operators.tools import base
    from expanded_panoramas.ui import drawing, shape_overlay

    found = SimpleNamespace(lines=[], dots=[], texts=[])
    monkeypatch.setattr(drawing, "lines", lambda points, *_: found.lines.append(np.array(points)))
    monkeypatch.setattr(drawing, "dots", lambda points, *_: found.dots.append(points))
    monkeypatch.setattr(drawing, "text", lambda at, string, *_, **__: found.texts.append(string))

    def draw(tool, canvas):
        monkeypatch.setattr(base, "_active", tool)
        for kind in (found.lines, found.dots, found.texts):
            kind.clear()
        space = SimpleNamespace(overlay=SimpleNamespace(show_overlays=True))
        region = SimpleNamespace(as_pointer=lambda: 7, x=0, y=0, width=9999, height=9999)
        area = SimpleNamespace(regions=[])
        scene = fresh_blend.context.scene
        context = SimpleNamespace(scene=scene, space_data=space, area=area, region=region)
        shape_overlay.draw(context, canvas)
        return found

    return draw


def test_a_side_is_a_curve_of_the_flat_image(drawn):
    """Its middle on the floor is on the line, which is far from the straight one between its ends."""
    hand = Hand("polygon")
    hand.click((1, -1), (1, 1), (3, 1))
    hand.move((3, -1))
    found = drawn(hand.tool, FLAT)
    middle, ends = hand.pixels((1, 0, 0)), [hand.pixels((1, y, 0)) for y in (-1, 1)]
    assert np.nanmin(np.linalg.norm(found.lines[0] - middle, axis=1)) < 8  # px: a step is half a degree
    assert np.linalg.norm(np.mean(ends, axis=0) - middle) > 100
    assert len(found.dots) == 3
    assert found.texts == ["2 m"] * 4


def test_across_the_seam_the_line_breaks(drawn):
    hand = Hand("square")
    hand.click((-2, 0.5))
    hand.move((-3, -1))
    steps = np.abs(np.diff(drawn(hand.tool, FLAT).lines[0][:, 0]))
    assert np.nanmax(steps) < FLAT.size[0] / 2


def test_text_at_the_mouse_is_in_its_region_only(drawn):
    hand = Hand("square")
    hand.move((1.0, 0.0, 2.0))
    hand.tool.xy = hand.xy
    assert "above the horizon: the floor lies below it" not in drawn(hand.tool, FLAT).texts
    hand.tool.region = 7
    assert "above the horizon: the floor lies below it" in drawn(hand.tool, FLAT).texts


def test_it_says_where_the_picture_does_not_lie_on_the_floor(drawn):
    beside = look_from((4.0, -7.0, 5.0), (0.5, 0.0, 0.5))
    at_origin = look_from((0, 0, STAND.camera_height), (1.0, 0, 0))
    for canvas, astray in ((beside, True), (at_origin, False), (FLAT, False)):
        hand = Hand("square", on=canvas)
        hand.move((1.2, 0.1))
        hand.tool.xy, hand.tool.region = hand.xy, 7
        assert any("Look Around" in text for text in drawn(hand.tool, canvas).texts) == astray


def test_height_and_typed_text(drawn):
    hand = Hand("box")
    hand.click((1, -0.5), (1, 0.5), (2, 0.5))
    hand.type("75c")
    hand.tool.xy, hand.tool.region = hand.xy, 7
    assert "75c" in drawn(hand.tool, FLAT).texts
    hand.type("m")
    found = drawn(hand.tool, FLAT)
    assert {"75 cm", "75cm"} <= set(found.texts)
    assert np.nanmin(np.linalg.norm(found.lines[0] - hand.pixels((1, 0.5, 0.75)), axis=1)) < 1


def test_built_shapes_are_outlined_where_they_are_not_seen(drawn, fresh_blend, tmp_path):
    built(fresh_blend, tmp_path)
    fresh_blend.context.view_layer.update()
    beside = look_from((4.0, -7.0, 5.0), (0.5, 0.0, 0.5))
    assert len(drawn(None, FLAT).lines) == 2  # of two roles
    assert not drawn(None, beside).lines
    assert len(drawn(Hand("square").tool, beside).lines) == 3


def test_the_panorama_covers_meshes_only_where_a_tool_sees_them_on_it(fresh_blend, monkeypatch):
    from expanded_panoramas.operators.tools import base
    from expanded_panoramas.ui.background import painting

    at_origin = look_from((0, 0, STAND.camera_height), (1, 0, 0)).view
    beside = look_from((0.2, 0, STAND.camera_height), (1, 0, 0)).view
    assert not painting.covers_meshes(at_origin)
    monkeypatch.setattr(base, "_active", Hand("square").tool)
    assert painting.covers_meshes(at_origin)
    assert not painting.covers_meshes(beside)
    solid = SimpleNamespace(type="SOLID", show_xray=False, xray_alpha=0.5)
    covering = [("LESS_EQUAL", "NONE", 1.0), ("GREATER", "NONE", 1.0)]
    assert painting.passes(solid, 0.3, painting.covers_meshes(at_origin)) == covering
