"""Rays of views meet the floor and what stands on it, from the panorama's origin and from beside it."""

import numpy as np
import pytest
from known_room import CAMERA_HEIGHT, WORLD_FROM_PANORAMA

from expanded_panoramas.ibl_toolkit.floor_shapes import circle, polygon, square
from expanded_panoramas.ibl_toolkit.stand import Stand

STAND = Stand(WORLD_FROM_PANORAMA, CAMERA_HEIGHT)
EYES = [(0.0, 0.0, CAMERA_HEIGHT), (4.0, -5.0, 3.0), (0.2, 0.1, 0.4)]
BASE = square([[2.0, -1.0], [4.0, 1.0]])


def ray(eye, target):
    """From a point (3,) of the world to another, in the panorama frame."""
    start = STAND.from_origin(np.array(eye))
    return start, STAND.from_origin(np.array(target, float)) - start


@pytest.mark.parametrize("eye", EYES)
def test_the_floor_is_met(eye):
    assert STAND.floor_under(*ray(eye, (2.0, -1.0, 0.0))) == pytest.approx([2, -1], abs=1e-12)
    with pytest.raises(ValueError, match="above the horizon"):
        STAND.floor_under(*ray(eye, (9.0, 0.0, eye[2] + 0.1)))


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("base", [BASE, polygon(BASE.outline)])
def test_the_nearest_side_gives_the_height(eye, base):
    edge = (2.0, 0.3, 1.1) if eye[1] == 0 or eye[2] < 1 else (2.7, -1.0, 1.1)
    assert STAND.above_base(*ray(eye, edge), base) == pytest.approx(edge, abs=1e-9)


def test_beside_the_base_its_corner_gives_the_height():
    """A ray over the corner and one just beside it agree: the edge follows the mouse without a jump."""
    over = STAND.above_base(*ray(EYES[0], (2.0, 0.999, 1.1)), BASE)
    beside = STAND.above_base(*ray(EYES[0], (2.0, 1.001, 1.1)), BASE)
    assert beside[:2] == pytest.approx([2, 1])
    assert beside == pytest.approx(over, abs=2e-3)


def test_a_round_base_is_met_exactly_not_its_corners():
    base = circle([[2, 0], [4, 0], [3, 1]], CAMERA_HEIGHT)
    azimuth = np.pi + 0.05
    edge = (3 + np.cos(azimuth), np.sin(azimuth), 0.7)
    assert STAND.above_base(*ray(EYES[0], edge), base) == pytest.approx(edge, abs=1e-9)


@pytest.mark.parametrize(
    ("target", "reason"),
    [((1.9, 0.0, 0.0), "below the floor"), ((-3.0, 0.0, 1.0), "behind"), ((0, 0, 0), "straight above")],
)
def test_what_tells_no_height(target, reason):
    with pytest.raises(ValueError, match=reason):
        STAND.above_base(*ray(EYES[0], target), BASE)


def test_a_top_is_picked_where_the_origin_first_meets_the_base():
    assert STAND.upper_edge(BASE, (4.0, 0.4)) == pytest.approx([2, 0.2])
    inside = STAND.upper_edge(BASE, (-1.0, 0.0))  # nothing there: somewhere on the near side
    assert inside[0] == pytest.approx(2)
    assert abs(inside[1]) < 1
