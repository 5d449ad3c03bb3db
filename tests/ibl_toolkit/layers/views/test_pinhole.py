import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole

ASKEW = Pinhole.looking_at((1.0, 2.0, 3.0), (-2.0, 2.5, 2.0), 70, 64, 36)


def test_what_a_pixels_ray_meets_is_seen_at_the_pixels_centre():
    points = ASKEW.eye + 4.0 * ASKEW.directions()
    xy, distance = ASKEW.project(points)
    i, j = np.meshgrid(np.arange(64) + 0.5, np.arange(36) + 0.5)
    np.testing.assert_allclose(xy, np.stack([i, j], axis=2), atol=1e-9)
    np.testing.assert_allclose(
        distance, np.linalg.norm(points - ASKEW.eye, axis=2) * (ASKEW.directions() @ ASKEW.axes[2])
    )


def test_the_picture_spans_its_field_of_view_and_stands_upright():
    camera = Pinhole.looking_at((0, 0, 1), (5, 0, 1), 90, 200, 100)
    xy, _ = camera.project(np.array([[1, 1, 1], [1, -1, 1], [1, 0, 1.5]]))
    np.testing.assert_allclose(xy, [[0, 50], [200, 50], [100, 0]], atol=1e-9)


def test_behind_the_eye_nothing_is_seen():
    xy, distance = ASKEW.project(ASKEW.eye - ASKEW.axes[2])
    assert np.isnan(xy).all()
    assert distance == pytest.approx(-1)


def test_in_the_panoramas_frame_the_same_is_seen():
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    layer = Layer("all", "equirectangular", {"depth": np.ones((2, 4), np.float32)})
    panorama = LayeredPanorama((layer,), quarter, np.array([0.5, -1, 2]), 1.0)
    in_panorama = np.array([[3.0, 1, 0], [4, -0.5, 1]])
    world = in_panorama @ quarter.T + panorama.origin
    camera = Pinhole.looking_at((0, 0, 2), (0.5, 2, 2), 80, 40, 30)
    np.testing.assert_allclose(camera.in_panorama(panorama).project(in_panorama)[0], camera.project(world)[0])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"look_at": (0, 0, 5)}, "nothing is upright"),
        ({"look_at": (0, 0, 0)}, "another point than its own"),
        ({"fov_deg": 180}, "between 0 and 180"),
        ({"width": 0}, "1 x 1 or more"),
        ({"eye": (0, np.nan, 0)}, "another point|three finite numbers"),
    ],
)
def test_impossible_cameras_are_refused(change, message):
    camera = {"eye": (0, 0, 0), "look_at": (1, 0, 0), "fov_deg": 60, "width": 4, "height": 3} | change
    with pytest.raises(ValueError, match=message):
        Pinhole.looking_at(**camera)
