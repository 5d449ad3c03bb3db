import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer
from expanded_panoramas.ibl_toolkit.layers.points.neighbourhoods import Neighbourhoods
from expanded_panoramas.ibl_toolkit.layers.points.subsampling import counts_needed, samples_within
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole

CAMERA = Pinhole.looking_at((0, 0, 0), (1, 0, 0), 90, 200, 200)
_GRID = [(dx, dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]


def flat_pixel(u, v, middle=(100.0, 100.0)):
    """A pixel whose neighbours to the right and below are seen u and v (2,) [px] away; all 1 m ahead."""
    xy = np.array([np.array(middle) + dx * np.array(u) + dy * np.array(v) for dx, dy in _GRID])
    points = np.empty((9, 4, 1), np.float32)
    points[:, :2, 0], points[:, 2:] = (xy - 100) / CAMERA.focal, 1.0
    return Neighbourhoods(points, np.zeros((9, 1), np.int64))


@pytest.mark.parametrize(
    ("u", "v", "counts"),
    [
        ((5, 0), (0, 3), (5, 3)),  # as printed: m_h, m_v
        ((0, 3), (5, 0), (3, 5)),  # the map on its side: across the map is down in the picture
        ((2, 2), (-2, 2), (4, 4)),  # as printed: the neighbours at 45 degrees are 4 px away in x and in y
        ((0.3, 0.1), (0, 0.4), (1, 1)),
    ],
)
def test_as_many_samples_as_the_neighbours_are_away(u, v, counts):
    found = counts_needed(flat_pixel(u, v), CAMERA, 1.0)
    assert tuple(int(count[0]) for count in found) == counts


@pytest.mark.parametrize("seed", range(20))
def test_no_pixel_of_the_picture_is_left_without_a_sample(seed):
    """Of a plane of pixels at any angle, squeezed or stretched in any way."""
    random = np.random.default_rng(seed)
    u, v = random.uniform(-7, 7, (2, 2))
    counts = [int(count[0]) for count in counts_needed(flat_pixel(u, v), CAMERA, 1.0)]
    steps = [(np.arange(-40 * n, 40 * n) + 0.5) / n for n in counts]
    xy = steps[0][:, None, None] * u + steps[1][None, :, None] * v
    pixels = np.floor(xy.reshape(-1, 2)).astype(int)
    inverse = np.linalg.inv(np.stack([u, v], axis=1))
    i, j = np.meshgrid(np.arange(-60, 60), np.arange(-60, 60))
    on_plane = (np.abs(np.stack([i + 0.5, j + 0.5], axis=-1) @ inverse.T) < 38).all(axis=-1)
    hit = np.zeros((120, 120), dtype=bool)
    inside = (np.abs(pixels + 0.5) < 60).all(axis=1)
    hit[pixels[inside, 1] + 60, pixels[inside, 0] + 60] = True
    assert on_plane.any()
    assert hit[on_plane].all()


def test_behind_the_eye_there_are_many_but_not_endlessly():
    pixel = flat_pixel((1, 0), (0, 1))
    pixel.points[5, 2] = -0.5
    assert [int(count[0]) for count in counts_needed(pixel, CAMERA, 1.0)] == [28, 28]


def test_samples_lie_evenly_over_the_pixel_with_the_colours_between():
    radiance = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    layer = Layer("any", "equirectangular", {"depth": np.ones((2, 4), np.float32), "radiance": radiance})
    pixel = flat_pixel((8, 0), (0, 4))
    pixel.texels[:, 0] = [0, 1, 2, 0, 1, 2, 0, 1, 2]
    (samples,) = samples_within(layer, pixel, CAMERA, np.array([4]), np.array([2]))
    x, y = np.meshgrid([97, 99, 101, 103], [99, 101])
    np.testing.assert_allclose(samples.xy, [x.ravel(), y.ravel()], atol=1e-4)
    np.testing.assert_allclose(samples.near, 1, rtol=1e-6)
    np.testing.assert_allclose(samples.colours[0], 3 + 3 * (x.ravel() - 100) / 8, atol=1e-5)
    assert (samples.sources == 0).all()


def test_none_is_behind_the_eye():
    layer = Layer(
        "any", "equirectangular", {"depth": np.ones((2, 4), np.float32), "radiance": np.ones((2, 4, 3))}
    )
    pixel = flat_pixel((1, 0), (0, 1))
    pixel.points[:, 2] -= np.array([[dx] for dx, _ in _GRID]) * 4
    (samples,) = samples_within(layer, pixel, CAMERA, np.array([20]), np.array([1]))
    assert 10 <= len(samples) < 20
    assert (samples.near > 0).all()
