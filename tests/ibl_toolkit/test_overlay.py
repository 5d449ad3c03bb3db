"""Lines over a panorama go where the points they join are seen, across the seam and under the pole."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular as er
from expanded_panoramas.ibl_toolkit import overlay
from expanded_panoramas.ibl_toolkit.false_colour import depth_colours

WIDTH, HEIGHT = 512, 256
WHITE = (255, 255, 255)
NEAR = 1.5  # [px] between a drawn pixel and the true curve


def blank():
    return np.zeros((HEIGHT, WIDTH, 3), np.uint8)


def drawn(picture):
    """Pixels (n, 2) that are more than half covered, as (column, row)."""
    return np.argwhere(picture[..., 0] > 127)[:, ::-1]


def farthest_from_curve(pixels, points):
    """Largest distance [px] from drawn pixels to the projection of points (n, 3), round the seam."""
    curve = er.pixel_from_uv(er.uv_from_direction(points), WIDTH, HEIGHT)
    offsets = pixels[:, None] - curve[None]
    offsets[..., 0] = (offsets[..., 0] + WIDTH / 2) % WIDTH - WIDTH / 2
    return np.linalg.norm(offsets, axis=2).min(axis=1).max()


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ((2.0, 1.0, -1.0), (2.0, -1.0, -1.0)),
        ((-2.0, 1.0, 0.5), (-2.0, -1.0, 0.5)),  # across the seam
        ((-1.0, 0.3, -1.3), (2.0, 0.2, -1.3)),  # close below the origin
        ((0.5, 3.0, -1.0), (0.5, 0.1, 1.4)),
    ],
)
def test_a_segment_lies_on_its_curve_from_end_to_end(first, second):
    picture, first, second = blank(), np.array(first), np.array(second)
    overlay.draw_segment(picture, first, second, WHITE, thickness=1)
    line = first + np.linspace(0, 1, 4000)[:, None] * (second - first)
    pixels = drawn(picture)
    assert farthest_from_curve(pixels, line) < NEAR
    ends = er.pixel_from_uv(er.uv_from_direction(np.stack([first, second])), WIDTH, HEIGHT)
    assert np.linalg.norm(pixels[:, None] - ends, axis=2).min(axis=0).max() < NEAR


def test_a_segment_across_the_seam_does_not_cross_the_picture():
    picture = blank()
    overlay.draw_segment(picture, np.array([-3.0, 0.5, 0.0]), np.array([-3.0, -0.5, 0.0]), WHITE)
    columns = drawn(picture)[:, 0]
    assert columns.min() < 5
    assert columns.max() > WIDTH - 5
    assert not ((columns > 40) & (columns < WIDTH - 40)).any()


def test_what_the_depth_hides_is_not_drawn():
    """A wall at 2 m to the left of the middle, none to the right; the line runs behind it at 3 m."""
    depth = np.full((HEIGHT, WIDTH), np.inf, np.float32)
    depth[:, : WIDTH // 2] = 2.0
    picture = blank()
    overlay.draw_segment(picture, np.array([3.0, 2.0, 0.0]), np.array([3.0, -2.0, 0.0]), WHITE, depth=depth)
    columns = drawn(picture)[:, 0]
    assert columns.min() >= WIDTH // 2 - 4
    assert columns.max() > WIDTH // 2 + 40


def test_the_horizon_of_a_tilted_panorama_is_level_in_the_world():
    tilt = np.radians(20)
    world_from_panorama = np.array(
        [[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]]
    )
    picture = blank()
    overlay.draw_axis_planes(picture, world_from_panorama, thickness=3)
    blue = np.argwhere((picture == overlay.HORIZON_COLOUR).all(axis=2))[:, ::-1]
    directions = er.direction_from_uv(er.uv_from_pixel(blue, WIDTH, HEIGHT)) @ world_from_panorama.T
    assert len(blue) > WIDTH / 2
    assert np.degrees(np.abs(np.arcsin(directions[:, 2]))).max() < 2 * NEAR * 180 / HEIGHT


def test_depth_colours_rank_depths_and_refuse_an_empty_range():
    depth = np.geomspace(1.0, 8.0, 32)[None]
    luminance = depth_colours(depth, 1.0, 8.0)[0] @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(luminance) < 0).all()
    with pytest.raises(ValueError, match="from 2 m to 1 m"):
        depth_colours(depth, 2, 1)
