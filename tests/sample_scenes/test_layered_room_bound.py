"""The bound of views of layered panoramas, from surfaces that are known."""

import numpy as np
import pytest

pytest.importorskip("bpy")

from box_layers import HALF, box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.sample_scenes.layered_room import capture, scene, views
from expanded_panoramas.sample_scenes.layered_room.bound import bound_view

CAMERA = Pinhole.looking_at((-0.5, 0.4, 0.2), (1.0, -0.2, 0.0), 80, 64, 48)


def colour(points):
    return (0.5 + 0.1 * points).astype(np.float32)


def room(scale=1.0, name="room", inside=True, mapping="equirectangular", width=512):
    """A room whose walls are ``scale`` times as far away, of the true one's colours; black if scaled."""
    rays = directions(mapping, width)
    depth = box_depth(mapping, width) * np.float32(scale)
    radiance = colour(rays * depth[..., None]) * (scale == 1)
    depth = np.where(inside, depth, np.float32(np.nan))
    radiance[np.isnan(depth)] = np.nan
    return Layer(name, mapping, {"depth": depth, "radiance": radiance})


def panorama(*layers):
    return LayeredPanorama(layers, np.eye(3), np.zeros(3), 1.0)


def true_distance():
    rays = CAMERA.directions()
    depth = np.min((np.where(rays > 0, HALF, -HALF) - CAMERA.eye) / rays, axis=2)
    return depth * (rays @ CAMERA.axes[2]), CAMERA.eye + rays * depth[..., None]


@pytest.mark.parametrize("others", [(), (0.8,), (0.9, 1.15)])
def test_each_point_has_the_colour_of_the_layer_whose_surface_it_is_on(others):
    layers = [room(), *(room(scale, str(scale)) for scale in others)]
    distance, points = true_distance()
    for order in (layers, layers[::-1]):
        view = bound_view(panorama(*order), CAMERA, distance)
        np.testing.assert_allclose(view.radiance, colour(points), atol=4e-3)
        np.testing.assert_allclose(view.depth, np.linalg.norm(points - CAMERA.eye, axis=2), rtol=1e-5)


def test_a_cube_map_is_looked_up_over_its_edges():
    distance, points = true_distance()
    view = bound_view(panorama(room(mapping="cube map", width=384)), CAMERA, distance)
    np.testing.assert_allclose(view.radiance, colour(points), atol=4e-3)


def test_in_a_layer_that_jumps_each_side_keeps_its_colour():
    """Pixels of a nearer, black surface beside a direction have no say in the wall's colour."""
    card = np.abs(directions("equirectangular", 512)[..., 1]) < 0.2
    wall, black = room(), room(0.5, "black")
    both = {
        name: np.where(card if name == "depth" else card[..., None], black.attributes[name], values)
        for name, values in wall.attributes.items()
    }
    distance, points = true_distance()
    view = bound_view(panorama(Layer("all", "equirectangular", both)), CAMERA, distance)
    seen = view.radiance.any(axis=2)
    assert 0.2 < seen.mean() < 0.9
    np.testing.assert_allclose(view.radiance[seen], colour(points)[seen], atol=0.02)


def test_where_no_layer_looks_is_a_hole():
    inside = directions("equirectangular", 512)[..., 1] < 0
    distance, points = true_distance()
    view = bound_view(panorama(room(inside=inside)), CAMERA, distance)
    sure = np.abs(points[..., 1]) > 0.05
    np.testing.assert_array_equal(view.holes[sure], (points[..., 1] > 0)[sure])


def test_what_no_layer_has_gets_the_nearest_guess():
    distance, _ = true_distance()
    view = bound_view(panorama(room(2.0, "far")), CAMERA, distance)
    assert not view.holes.any()
    assert not view.radiance.any()


@pytest.mark.parametrize(
    ("distance", "message"),
    [(np.ones((4, 5)), "\\(5, 4\\) px, must be 64 x 48"), (np.zeros((48, 64)), "above 0")],
)
def test_other_distances_are_refused(distance, message):
    with pytest.raises(ValueError, match=message):
        bound_view(panorama(room()), CAMERA, distance)


def test_cycles_depth_is_along_the_forward_axis_of_the_same_camera(fresh_blend):
    """Points of the wall straight on, the floor and the ceiling of the sample room lie on them."""
    view = views.View("test", (-0.6, 0.6, 1.15), (-0.2, 0.97, 0.0))
    camera = views.pinhole(view, 48, 48)
    distance = capture.render_view_distance(scene.new_room(), view, (48, 48))
    rays = camera.directions()
    points = camera.eye + rays * (distance / (rays @ camera.axes[2]))[..., None]
    assert points[..., 1].max() == pytest.approx(3.6, abs=1e-3)
    assert np.mean(np.abs(points[..., 1] - 3.6) < 1e-3) > 0.3
    assert (points[..., 2] > -1e-3).all()
