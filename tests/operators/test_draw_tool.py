"""Shapes drawn with the mouse are the set's: of the sizes clicked or typed, and refused with reasons."""

import numpy as np
import pytest
from known_room import seen

from expanded_panoramas.ibl_toolkit.calibration import CalibrationPicks
from expanded_panoramas.ibl_toolkit.panorama_set import PanoramaSet
from expanded_panoramas.ibl_toolkit.reconstruction import reconstruct

pytest.importorskip("bpy")
from drawing_hand import CALIBRATION, METRES, STAND, Hand, elevation, look_from

CORNERS = np.array([[3.0, 2.0], [-2.0, 2.0], [-2.0, -2.5], [3.0, -2.5]])
CEILING = 2.7
DRAWN = 1e-9  # [m]: nothing is rounded before the set is stored
BESIDE = look_from((4.0, -7.0, 5.0), (0.5, 0.0, 0.5))


def pieces(hand):
    """What the set's own reconstruction makes of what was drawn, by name."""
    shapes = hand.tool.result(lambda name: name)
    return {p.name: p for p in reconstruct(PanoramaSet("x", CalibrationPicks(), shapes), CALIBRATION)}


def drawn_room(**keywords):
    hand = Hand("room", **keywords)
    hand.click(*CORNERS, CORNERS[0])
    return hand


def test_a_room_has_the_size_of_its_corners():
    hand = drawn_room()
    assert hand.answer == "RUNNING"
    assert hand.click((3.0, 0.5, CEILING)) == "CONFIRM"
    floor, walls = pieces(hand).values()
    assert (floor.kind, floor.role, walls.kind, walls.role) == ("polygon", "SUPPORT", "walls", "ENVIRONMENT")
    assert floor.size_m == pytest.approx((5, 4.5, 0), abs=DRAWN)
    assert walls.size_m == pytest.approx((5, 4.5, CEILING), abs=DRAWN)
    assert len(walls.mesh.faces) == 5


def test_from_beside_the_panorama_it_is_the_same_room():
    """In such a view the floor lies elsewhere than the picture's: points are taken in the world."""
    hand = drawn_room(on=BESIDE)
    hand.click((1.0, -2.5, CEILING))  # the wall nearest to the eye
    assert pieces(hand)["walls"].size_m == pytest.approx((5, 4.5, CEILING), abs=DRAWN)


def test_a_height_is_taken_from_an_elevation():
    hand = Hand("box")
    hand.click((1.0, -0.5), (1.0, 0.5), (2.0, 0.2))
    hand.on = elevation()
    assert hand.click((1.4, -0.5, 0.8)) == "CONFIRM"
    assert pieces(hand)["box"].size_m == pytest.approx((1, 1, 0.8), abs=DRAWN)


def test_a_double_click_does_not_raise_what_it_closes():
    hand = Hand("box")
    hand.click((1.0, -0.5), (1.0, 0.5), (2.0, 0.2))
    hand.event("LEFTMOUSE", "DOUBLE_CLICK")
    assert hand.event("LEFTMOUSE", "RELEASE") == "PASS"
    assert hand.click((1.0, 0.1, 0.8)) == "CONFIRM"


@pytest.mark.parametrize("over", ["middle of a side", "corner", "beside"])
def test_the_upper_edge_of_a_box_follows_the_mouse(over):
    hand = Hand("box")
    hand.click((1.0, -0.5), (1.0, 0.5), (2.0, 0.2))
    top = {"middle of a side": (1.0, 0.1, 0.8), "corner": (1.0, 0.5, 0.8), "beside": (1.0, 0.6, 0.8)}[over]
    assert hand.click(top) == "CONFIRM"
    found = pieces(hand)["box"]
    assert found.size_m == pytest.approx((1, 1, 0.8), abs=0.05 if over == "beside" else DRAWN)
    assert found.residual_m == pytest.approx(0, abs=DRAWN)


def test_a_cylinder_from_beside_stands_as_high_as_it_is_seen():
    hand = Hand("cylinder", on=BESIDE)
    hand.click((1.5, 0), (2.5, 0), (2, 0.5), (1.5, 0))
    eye, centre = np.array([4.0, -7.0]), np.array([2.0, 0.0])
    edge = centre + 0.5 * (eye - centre) / np.linalg.norm(eye - centre)
    hand.click((*edge, 1.2))
    assert pieces(hand)["cylinder"].size_m == pytest.approx((1, 1, 1.2), abs=DRAWN)


@pytest.mark.parametrize(
    ("kind", "points", "typed", "size"),
    [
        ("rectangle", [(1, 0)], ["2.5", "1,25"], (2.5, 1.25, 0)),
        ("square", [(1, 0)], ["80cm"], (0.8, 0.8, 0)),
        ("circle", [(2, 1)], ["0.35"], (0.7, 0.7, 0)),
        ("circle", [(2, 1), (2.3, 1)], ["0.35"], (0.7, 0.7, 0)),
        ("circle", [(2, 1), (2.3, 1), (2.1, 1.2)], ["0.35"], (0.7, 0.7, 0)),
        ("box", [(1, 0)], ["1", "2", "0.72 m"], (1, 2, 0.72)),
        ("cylinder", [(2, 1)], ["0.35", "6'"], (0.7, 0.7, 1.8288)),
    ],
)
def test_typed_lengths_are_kept(kind, points, typed, size):
    hand = Hand(kind)
    hand.click(*points)
    for number in typed:
        hand.move((1.7, 1.3))
        hand.type(number)
        hand.enter()
    assert hand.answer == "CONFIRM"
    assert pieces(hand)[kind].size_m == pytest.approx(size, abs=1e-6)


def test_typed_and_squared_sides_of_a_polygon():
    hand = Hand("polygon")
    hand.click((1, 0))
    for towards, length in (((3, 0.1), "2"), ((3.1, 3), "1.5"), ((0, 1.6), "2")):
        hand.move(towards, shift=True)
        hand.type(length, shift=True)
        hand.event("LEFT_SHIFT", "RELEASE")
        hand.enter()
    assert np.array(hand.tool.shape.points) == pytest.approx(
        np.array([[1, 0], [3, 0], [3, 1.5], [1, 1.5]]), abs=DRAWN
    )
    assert hand.enter() == "CONFIRM"


def test_a_squared_side_ends_where_the_room_closes():
    hand = Hand("polygon")
    hand.click((1, 0), (2, 2), (-2, 4))
    hand.click((-2.9, 1.9), shift=True)  # square to the sides before; (-3, 2) makes a rectangle
    assert hand.tool.shape.points[-1] == pytest.approx((-3, 2), abs=DRAWN)


def test_what_is_not_on_the_floor_is_refused():
    hand = Hand("room")
    hand.click((3.0, 0.0, 1.6))
    assert "above the horizon" in hand.tool.problem
    hand.click((400.0, 0.0))
    assert "below the horizon: at least 0.5°" in hand.tool.problem
    assert not hand.tool.shape.points
    hand.click(*CORNERS[:2])
    hand.enter()
    assert hand.tool.problem == "1 more point needed"
    hand.click((3, -2.5), CORNERS[2])  # its sides cross
    hand.click(CORNERS[0])
    assert "meet" in hand.tool.problem
    assert hand.tool.shape.base is None


def test_a_number_that_is_none_is_refused():
    hand = Hand("square")
    hand.click((1, 0))
    hand.move((2, 1))
    hand.type("0")
    assert hand.enter() == "RUNNING"
    assert "above 0" in hand.tool.problem
    hand.event("BACK_SPACE")
    hand.type("1c")
    hand.enter()
    assert "'1c' is no length" in hand.tool.problem


def test_three_points_on_a_line_take_the_last_back():
    hand = Hand("rectangle")
    hand.click((1, 0), (3, 0), (2, 0))
    assert "third point" in hand.tool.problem
    assert len(hand.tool.shape.points) == 2
    assert hand.click((2, 1)) == "CONFIRM"


def test_points_are_dragged_and_taken_back():
    hand = Hand("polygon")
    hand.click(*CORNERS)
    hand.drag(CORNERS[1], (-1.5, 1.0))
    assert hand.tool.shape.points[1] == pytest.approx((-1.5, 1.0), abs=DRAWN)
    hand.tool.undo()
    assert hand.tool.shape.points[1] == pytest.approx(CORNERS[1], abs=DRAWN)
    hand.event("BACK_SPACE")
    assert len(hand.tool.shape.points) == 3
    hand.tool.undo()
    assert len(hand.tool.shape.points) == 4
    hand.tool.undo(redo=True)
    assert len(hand.tool.shape.points) == 3


def test_a_click_does_not_move_a_point_by_its_tremble():
    hand = Hand("polygon")
    hand.click(*CORNERS)
    hand.move(CORNERS[0])
    hand.event("LEFTMOUSE")
    hand.xy = hand.xy + 1
    hand.event("MOUSEMOVE", "NOTHING")
    assert hand.event("LEFTMOUSE", "RELEASE") == "CONFIRM"
    assert hand.tool.shape.points[0] == pytest.approx(CORNERS[0], abs=DRAWN)


def test_roles_and_ceiling_are_chosen_while_drawing():
    hand = drawn_room()
    hand.event("C")
    hand.event("R")
    hand.move((3.0, 0.5, CEILING))
    hand.event("BACK_SPACE")  # down to the floor again
    hand.event("R")
    hand.enter()
    hand.click((3.0, 0.5, CEILING))
    floor, walls = pieces(hand).values()
    assert (floor.role, walls.role, len(walls.mesh.faces)) == ("ENVIRONMENT", "SUPPORT", 4)


def test_undo_goes_back_through_the_stages():
    hand = drawn_room()
    assert hand.tool.shape.base is not None
    hand.tool.undo()
    assert (hand.tool.shape.base, len(hand.tool.shape.points)) == (None, 4)
    hand = Hand("box")
    hand.click((1, 0), (2, 0), (2, 1))
    hand.tool.undo()
    assert (hand.tool.shape.base, len(hand.tool.shape.points)) == (None, 2)


def test_keys_end_it_and_others_are_blenders():
    hand = Hand("room")
    assert hand.event("X") == "PASS"  # the mouse is elsewhere
    hand.click(CORNERS[0])
    assert hand.event("X") == "RUNNING"
    assert hand.event("TIMER", "NOTHING") == "PASS"
    assert hand.event("ESC") == "CANCEL"
    assert hand.event("RIGHTMOUSE") == "CANCEL"


def test_the_preview_shows_what_a_click_would_make():
    hand = Hand("rectangle")
    hand.click((1, 0), (3, 0))
    hand.move((2, 1))
    _, base, height, problem = hand.tool.preview()
    assert base.size_m == pytest.approx((2, 1), abs=DRAWN)
    assert (height, problem) == (None, "")
    hand.type("4")
    assert hand.tool.preview()[1].size_m == pytest.approx((2, 4), abs=DRAWN)
    hand = drawn_room()
    hand.move((3.0, 0.5, CEILING))
    assert hand.tool.preview()[2] == pytest.approx(CEILING)
    assert "Ceiling: yes" in dict(hand.tool.keys).values()


def test_digits_are_read_with_shift_held():
    hand = Hand("square")
    hand.click((1, 0))
    hand.move((2, 1))
    hand.event("TWO", unicode="@", shift=True)
    hand.event("NUMPAD_PERIOD")
    hand.event("NUMPAD_5")
    assert hand.tool.typed == "2.5"


def test_the_scenes_units():
    from expanded_panoramas.operators.tools.lengths import Lengths

    inches = Lengths("IMPERIAL", "in", 1.0)
    assert inches.value("10") == pytest.approx(0.254)
    assert inches.text(0.254) == "10.000 in"
    assert METRES.value("2,5") == 2.5
    assert METRES.value("6'2\"") == pytest.approx(1.8796)
    for typed in ("", "2.5.1", "2e", "2*3", "2 m 3", "."):
        with pytest.raises(ValueError, match="is no length"):
            METRES.value(typed)
    assert METRES.text(2.5) == "2.5 m"
    assert Lengths("METRIC", "cm", 0.1).value("25") == pytest.approx(2.5)


def test_picks_of_the_room_are_those_of_its_corners():
    hand = drawn_room()
    hand.click((3.0, 0.5, CEILING))
    floor, walls = hand.tool.result(lambda name: name)
    assert floor.points == pytest.approx(seen(np.column_stack([CORNERS, np.zeros(4)])), abs=1e-12)
    assert walls.top == pytest.approx(seen([3.0, 0.5, CEILING]), abs=1e-12)
    assert STAND.uv_of([3.0, 0.5, CEILING]) == pytest.approx(walls.top)
