import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.layers.views.rendered_view import far_view

EYE = (0.3, 0.2, -0.4)


def sky_over_floor(height=64):
    """Above the horizon infinity, coloured by direction; below it a floor."""
    directions = equirectangular.pixel_directions(2 * height, height)
    depth = np.where(directions[..., 2] > 0, np.inf, 2.0).astype(np.float32)
    layer = Layer("all", "equirectangular", {"depth": depth, "radiance": (directions + 2).astype(np.float32)})
    return LayeredPanorama((layer,), np.eye(3), np.zeros(3), 0.5)


def test_infinity_has_no_parallax():
    camera = Pinhole.looking_at(EYE, np.add(EYE, (1, 0.5, 0.2)), 60, 48, 32)
    view = far_view(sky_over_floor(), camera)
    above = camera.directions()[..., 2] > 0.05
    assert np.isposinf(view.depth[above]).all()
    np.testing.assert_allclose(view.radiance[above], camera.directions()[above] + 2, atol=2e-3)


def test_what_is_near_is_a_hole_in_it():
    camera = Pinhole.looking_at(EYE, np.add(EYE, (1, 0.5, -0.2)), 60, 48, 32)
    view = far_view(sky_over_floor(), camera)
    below = camera.directions()[..., 2] < -0.05
    assert view.holes[below].all()
    assert not view.radiance[below].any()


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_the_rim_of_infinity_keeps_its_colours(share):
    """The floor's colour does not bleed into the sky, whatever it is."""
    panorama = sky_over_floor()
    layer = panorama.layers[0]
    near = np.isfinite(layer.depth)[..., None]
    radiance = np.where(near, np.float32(1e4 * share), layer.radiance)
    changed = Layer("all", "equirectangular", {"depth": layer.depth, "radiance": radiance})
    camera = Pinhole.looking_at(EYE, np.add(EYE, (1, 0, 0)), 60, 48, 32)
    view = far_view(LayeredPanorama((changed,), np.eye(3), np.zeros(3), 0.5), camera)
    assert view.radiance.max() < 3.1
