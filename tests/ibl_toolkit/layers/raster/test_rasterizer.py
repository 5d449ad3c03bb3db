import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.layers.raster.camera_space import NEAR
from expanded_panoramas.ibl_toolkit.layers.raster.rasterizer import rasterize
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole

AHEAD = Pinhole.looking_at((0, 0, 0), (1, 0, 0), 90, 40, 30)
ASKEW = Pinhole.looking_at((0.3, -0.2, 0.1), (1.0, 0.5, 0.3), 75, 64, 48)


def behind_pixels(xy, distance, camera=AHEAD):
    """Points at places (n, 2) [px] of the picture."""
    xy = (np.asarray(xy, dtype=float) - (camera.width / 2, camera.height / 2)) / camera.focal
    distance = np.broadcast_to(distance, len(xy))
    return camera.eye + np.column_stack([xy, np.ones(len(xy))]) * distance[:, None] @ camera.axes


def ray_cast(points, triangles, camera):
    """Number and distance along forward of the nearest triangle in each pixel, ray by ray.

    Also whether that is certain: no ray passes within 1e-9 of a side, and no two triangles are equally near.
    """
    rays = camera.directions() / (camera.directions() @ camera.axes[2])[..., None]
    a, b, c = (points[triangles[:, k]] - camera.eye for k in range(3))
    sides = [np.einsum("hwk,tk->hwt", rays, np.cross(p, q)) for p, q in ((a, b), (b, c), (c, a))]
    normal = np.cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.einsum("tk,tk->t", normal, a) / (rays @ normal.T)
    hit = np.all([s > 0 for s in sides], axis=0) | np.all([s < 0 for s in sides], axis=0)
    distance = np.where(hit & (distance > NEAR), distance, np.inf)
    least = np.sort(distance, axis=2)
    certain = (np.min(np.abs(sides), axis=(0, 3)) > 1e-9) & ~(least[..., 1] < least[..., 0] + 1e-5)
    nearest = least[..., 0]
    return np.where(np.isfinite(nearest), distance.argmin(axis=2), -1), nearest, certain


@pytest.mark.parametrize(("count", "size"), [(40, 3.0), (300, 0.5), (4000, 0.03)])
def test_the_nearest_triangle_is_seen_as_rays_find_it(count, size):
    """Before, behind, beside and around the eye; some fill the picture, some are smaller than a pixel."""
    random = np.random.default_rng(count)
    spread = 0.6 if size < 0.1 else 1.5
    middles = random.normal(size=(count, 1, 3)) * spread + ASKEW.axes[2] * (0.8 if size < 0.1 else 0.3)
    points = (middles + random.normal(size=(count, 3, 3)) * size).reshape(-1, 3)
    triangles = (
        random.permutation(3 * count).reshape(-1, 3) if size > 2 else np.arange(3 * count).reshape(-1, 3)
    )
    camera = ASKEW if count < 1000 else Pinhole(ASKEW.eye, ASKEW.axes, 75, 24, 18)
    raster = rasterize(points, triangles, camera)
    triangle, distance, certain = ray_cast(points, triangles, camera)
    assert certain.mean() > 0.95
    np.testing.assert_array_equal(raster.triangle[certain], triangle[certain])
    np.testing.assert_allclose(raster.distance[certain], distance[certain], rtol=1e-5)


@pytest.mark.parametrize("cell", [0.4, 1.0, 3.7, 12.5, 90.0])
@pytest.mark.parametrize("moved", [0.0, 0.3])
def test_each_pixel_belongs_to_one_of_the_triangles_that_part_a_plane(cell, moved):
    """Corners lie on centres and sides of pixels, on straight lines through them, and anywhere."""
    columns = np.arange(-0.5, 40 + 2 * cell, cell)
    rows = np.arange(-0.5, 30 + 2 * cell, cell)
    xy = np.stack(np.meshgrid(columns, rows), axis=-1)
    random = np.random.default_rng(int(10 * cell))
    xy[1:-1, 1:-1] += random.uniform(-moved, moved, xy[1:-1, 1:-1].shape) * cell
    number = np.arange(xy.shape[0] * xy.shape[1]).reshape(xy.shape[:2])
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (c, d, a))])
    points = behind_pixels(xy.reshape(-1, 2), 2.0)
    shares = [
        rasterize(points, part, AHEAD).triangle >= 0
        for part in np.array_split(triangles, len(triangles))[:600]
    ]
    drawn = np.sum(shares, axis=0)
    assert drawn.max() == 1
    if len(triangles) <= 600:
        assert drawn.min() == 1
    assert (rasterize(points, triangles, AHEAD).triangle >= 0).all()


def test_a_floor_under_the_eye_is_cut_without_cracks():
    """Two of its triangles reach behind the eye; their sides are cut at the same places."""
    camera = Pinhole.looking_at((0.2, 0.1, 1.5), (1.0, 0.0, 1.0), 100, 60, 60)
    random = np.random.default_rng(0)
    square = np.array([[-7.0, -9, 0], [8, -7, 0], [9, 8, 0], [-8, 9, 0], [0.3, 0.05, 0]])
    triangles = np.array([[random.permutation([4, k, (k + 1) % 4])] for k in range(4)]).reshape(-1, 3)
    raster = rasterize(square, triangles, camera)
    rays = camera.directions()
    below = rays[..., 2] < -0.3
    expected = 1.5 / -rays[below][:, 2] * (rays[below] @ camera.axes[2])
    np.testing.assert_allclose(raster.distance[below], expected, rtol=1e-5)
    assert (raster.triangle[rays[..., 2] > 0] == -1).all()


def test_distance_is_right_all_over_a_slanted_triangle():
    points = behind_pixels([[-900, -500], [1100, -300], [20, 2000]], (0.5, 3.0, 80.0))
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    rays = AHEAD.directions() / (AHEAD.directions() @ AHEAD.axes[2])[..., None]
    raster = rasterize(points, np.array([[0, 1, 2]]), AHEAD)
    np.testing.assert_allclose(raster.distance, normal @ points[0] / (rays @ normal), rtol=1e-6)


def test_what_is_not_kept_hides_nothing():
    points = np.concatenate([behind_pixels([[-50, -50], [90, -50], [20, 200]], z) for z in (1.0, 2.0)])
    raster = rasterize(points, np.arange(6).reshape(2, 3), AHEAD, lambda p: (p[:, 0] > 1.5) | (p[:, 1] > 0))
    left = AHEAD.directions()[..., 1] > 0
    assert (raster.triangle[left] == 0).all()
    assert (raster.triangle[~left] == 1).all()


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1)])
def test_both_sides_are_drawn(order):
    points = behind_pixels([[-50, -50], [90, -50], [20, 200]], 1.0)
    assert (rasterize(points, np.array([order]), AHEAD).triangle == 0).all()


@pytest.mark.parametrize("points", [np.zeros((0, 3)), behind_pixels([[1, 1], [2, 1], [1, 2]], -1.0)])
def test_nothing_in_sight(points):
    raster = rasterize(points, np.arange(len(points)).reshape(-1, 3), AHEAD)
    assert (raster.triangle == -1).all()
    assert np.isposinf(raster.distance).all()


def test_lines_and_points_cover_nothing():
    points = behind_pixels([[0, 0], [40, 30], [20, 15], [5, 5]], 1.0)
    assert (rasterize(points, np.array([[0, 1, 2], [3, 3, 3], [0, 1, 1]]), AHEAD).triangle == -1).all()


def test_points_that_are_nowhere_are_refused():
    with pytest.raises(ValueError, match="must be finite"):
        rasterize(np.array([[1.0, 0, np.inf]]), np.array([[0, 0, 0]]), AHEAD)


def test_pictures_too_large_are_refused():
    camera = Pinhole.looking_at((0, 0, 0), (1, 0, 0), 90, 1, 40000)
    with pytest.raises(ValueError, match="1 x 40000 px, at most 65535 x 32767"):
        rasterize(np.zeros((3, 3)), np.array([[0, 1, 2]]), camera)
