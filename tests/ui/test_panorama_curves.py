"""Curves go where their directions are seen: across the seam of a flat image, and in any 3D view."""

import numpy as np
import pytest

pytest.importorskip("bpy")

SIZE = np.array([400.0, 200.0])


def image_canvas():
    from expanded_panoramas.operators.canvas import ImageCanvas

    return ImageCanvas(np.array([10.0, 20.0]), SIZE)


def view_canvas(view_matrix):
    from expanded_panoramas.ibl_toolkit.views import View
    from expanded_panoramas.operators.canvas import ViewCanvas

    window = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])
    return ViewCanvas(View.from_matrices(window, view_matrix, np.eye(3), 1.5, (300, 300)))


def steps(pixels):
    """Lengths of the drawn pieces, without breaks."""
    lengths = np.linalg.norm(np.diff(pixels, axis=0), axis=1)
    return lengths[np.isfinite(lengths)]


def test_a_great_circle_on_the_flat_image_reaches_both_borders():
    from expanded_panoramas.ui.panorama_curves import circle, curve_pixels

    tilted = np.array([0, np.cos(0.4), np.sin(0.4)])
    pixels = curve_pixels(image_canvas(), circle(np.array([1.0, 0, 0]), tilted))
    shown = pixels[np.isfinite(pixels).all(axis=1)]
    assert steps(pixels).max() < 3
    assert shown[:, 0].min() < 12
    assert shown[:, 0].max() > 407
    top, bottom = shown[:, 1].max(), shown[:, 1].min()
    middle = 20 + SIZE[1] / 2 - 0.5
    assert (top - middle, middle - bottom) == pytest.approx((0.4 / np.pi * 200,) * 2, abs=0.1)


def test_sides_across_the_seam_do_not_cross_the_image():
    from expanded_panoramas.ui.panorama_curves import curve_pixels, segments

    corners = np.array([[-3.0, 0.5, 0.2], [-3.0, -0.5, 0.2], [-3.0, -0.5, -0.2]])
    corners /= np.linalg.norm(corners, axis=1)[:, None]
    pixels = curve_pixels(image_canvas(), segments(corners, np.roll(corners, -1, axis=0)))
    x = pixels[np.isfinite(pixels).all(axis=1)][:, 0] - 10
    assert ((x < 15) | (x > 385)).all()
    assert x.min() < 2
    assert x.max() > 397
    assert steps(pixels).max() < 3  # nothing joins one side's end with the next one's start


@pytest.mark.parametrize("turn", [0.0, 0.5, 2.0, 4.0])
def test_straight_lines_are_straight_in_a_view(turn):
    from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector
    from expanded_panoramas.ui.panorama_curves import circle, curve_pixels

    view = np.eye(4)
    view[:3, :3] = rotation_from_vector([turn, 0.3, 0.2])
    pixels = curve_pixels(view_canvas(view), circle(np.array([1.0, 0, 0]), np.array([0, 1.0, 0])))
    shown = pixels[np.isfinite(pixels).all(axis=1)]
    assert 100 < len(shown) < len(pixels)  # half of it is behind
    offsets = shown - shown.mean(axis=0)
    assert np.linalg.svd(offsets, compute_uv=False)[1] < 1e-6 * np.abs(offsets).max() * len(shown)


def test_segments_end_where_they_should():
    from expanded_panoramas.ui.panorama_curves import segments

    first = np.array([[1.0, 0, 0], [0, 0, 1]])
    second = np.array([[0, 0.6, -0.8], [0, 0, 1]])
    lines = segments(first, second)
    assert lines[:, 0] == pytest.approx(first)
    assert lines[:, -1] == pytest.approx(second)
    assert np.linalg.norm(lines, axis=-1) == pytest.approx(1)
