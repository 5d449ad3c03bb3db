"""What can be uncovered behind boxes and walls, against lines of sight drawn one by one."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.making.uncovered import can_be_seen, uncovered_reach, usual_radius

WIDTH, RADIUS = 256, 0.5
DIRECTIONS = equirectangular.pixel_directions(WIDTH, WIDTH // 2).astype(np.float64)
WALL, CARD = 6.0, 2.0


def card(turn=0.0, tilt=0.0):
    """Whether a ray meets a square card, 40° across, before the wall; turned about z, then tilted about x."""
    x, y, z = np.moveaxis(DIRECTIONS @ rotation(turn, tilt), -1, 0)
    return (x > 0) & (np.maximum(np.abs(y), np.abs(z)) < np.tan(np.radians(20)) * x)


def rotation(turn, tilt):
    c, s, k, t = np.cos(turn), np.sin(turn), np.cos(tilt), np.sin(tilt)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[k, 0, -t], [0, 1, 0], [t, 0, k]])


@pytest.mark.parametrize(("turn", "tilt"), [(0, 0), (np.pi, 0), (1, 0.9), (0.3, np.pi / 2)])
def test_behind_a_card_a_strip_as_wide_as_the_parallax_can_be_seen(turn, tilt):
    front = np.where(card(turn, tilt), CARD, WALL)
    behind = np.where(card(turn, tilt), WALL, np.inf)
    seen = can_be_seen(uncovered_reach(front, RADIUS, behind), behind, RADIUS)
    assert not (seen & (front == WALL)).any()
    strip = np.arcsin(RADIUS / CARD) - np.arcsin(RADIUS / WALL)
    local = DIRECTIONS @ rotation(turn, tilt)
    edge = np.radians(20) - np.arctan2(np.abs(local[..., 1:]).max(axis=-1), local[..., 0])
    pixel = 2 * np.pi / WIDTH
    inside = front == CARD
    assert seen[inside & (edge < 0.9 * strip)].all()
    assert not seen[inside & (edge > 1.1 * strip + 3 * pixel)].any()


@pytest.mark.parametrize("radius", [2.5, 7.0])
def test_behind_a_card_within_the_radius_all_can_be_seen(radius):
    """Whether the wall is within the radius, too, or not: an eye goes round the card."""
    front, behind = np.where(card(), CARD, WALL), np.where(card(), WALL, np.inf)
    seen = can_be_seen(uncovered_reach(front, radius, behind), behind, radius)
    np.testing.assert_array_equal(seen, card())


def test_a_room_within_the_radius_is_not_opened_by_a_box_on_its_floor():
    x, _, z = np.moveaxis(DIRECTIONS, -1, 0)
    room = 3 / np.abs(DIRECTIONS).max(axis=-1)
    with np.errstate(divide="ignore"):
        is_box = card() & (2 * z / x > -3)
    front, behind = np.where(is_box, 2 / x, room), np.where(is_box, room, np.inf)
    seen = can_be_seen(uncovered_reach(front, 4.0, behind), behind, 4.0)
    assert not (seen & ~is_box).any()
    assert seen[is_box].mean() > 0.9


def test_far_things_behind_are_seen_deeper_in():
    front = np.where(card(), CARD, WALL)
    reach = uncovered_reach(front, RADIUS)
    counts = [np.count_nonzero(can_be_seen(reach, depth, RADIUS) & card()) for depth in (2.5, 4.0, np.inf)]
    assert counts == sorted(counts)
    assert counts[0] < 0.6 * counts[2]


def test_no_line_of_sight_passes_under_the_floor_on_which_a_box_stands():
    down = DIRECTIONS[..., 2]
    with np.errstate(divide="ignore"):
        floor = np.where(down < 0, -1.2 / down, np.inf)
        face = np.where(card() & (2 * down / DIRECTIONS[..., 0] > -1.2), 2 / DIRECTIONS[..., 0], np.inf)
    front, behind = np.minimum(floor, face), np.where(face < floor, floor, np.inf)
    seen = can_be_seen(uncovered_reach(front, 0.8, behind), behind, 0.8)
    assert seen.any()
    assert not (seen & (face >= floor)).any()


def test_a_wall_hides_all_and_so_does_a_radius_of_nothing():
    corner = 3 / np.abs(DIRECTIONS).max(axis=-1)
    assert not np.isfinite(uncovered_reach(corner, 1.0)).any()
    assert not np.isfinite(uncovered_reach(np.where(card(), CARD, WALL), 0.0)).any()


def test_the_usual_radius_is_half_of_what_is_near():
    depth = np.full((64, 128), 4.0)
    depth[30:34, :] = 1.0
    assert usual_radius(depth) == 0.5
    depth[:] = 4.0
    depth[32, 7] = 0.1
    assert usual_radius(depth) == 2.0
    with pytest.raises(ValueError, match="give the radius"):
        usual_radius(np.full((4, 8), np.inf))
