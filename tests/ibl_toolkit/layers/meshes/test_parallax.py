"""The largest parallax between two depths, against eyes tried out one by one."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.meshes.parallax import parallax, pixel_angle
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer


def largest_angle(depths, radius):
    """Between two points on the z axis, seen from eyes in a half-plane: 200 distances in 7200 directions."""
    angle, distance = np.meshgrid(np.linspace(0, np.pi, 7201), np.linspace(0, radius, 201))
    eye = np.stack([distance * np.sin(angle), distance * np.cos(angle)])
    one, other = (np.arctan2(-eye[0], depth - eye[1]) for depth in depths)
    return np.abs(one - other).max()


@pytest.mark.parametrize("depths", [(2.0, 2.1), (1.2, 1.25), (1.06, 1.07), (5.0, 1e9)])
def test_no_eye_sees_more_and_one_sees_as_much(depths):
    """Both within 1/0.95 radii of the origin or farther."""
    bound = abs(np.diff(parallax(1 / np.array(depths), 1.0)))[0]
    seen = largest_angle(depths, 1.0)
    assert seen <= bound
    assert seen > bound * (1 - bound**2 / 6) - 1e-6


def test_within_the_radius_it_keeps_growing():
    near = np.linspace(0, 5, 1001)  # up to five times the radius's reciprocal
    steps = np.diff(parallax(near, 1.0))
    assert (steps > 0).all()
    assert (np.diff(steps) > -1e-12).all()


def test_without_a_radius_there_is_none():
    assert not parallax(np.array([0.0, 1.0, 50.0]), 0.0).any()


def test_pixels_of_both_mappings():
    """A right angle has as many pixels as a face is wide, and a quarter of an equirectangular map."""
    depth = np.ones((8, 16), np.float32)
    assert pixel_angle(Layer("a", "equirectangular", {"depth": depth})) == pytest.approx(np.pi / 8)
    assert pixel_angle(Layer("a", "cube map", {"depth": depth[:, :12]})) == pytest.approx(np.pi / 8)
