import numpy as np
import pytest
from box_layers import BOTH, box_layer, directions, layer_of

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.layers.views.visible_tiles import TILE, Tiles, frustum


def rough_layer(mapping, width, seed):
    """A layer of depths that differ from tile to tile, with pixels that are missing and some at infinity."""
    random = np.random.default_rng(seed)
    rays = directions(mapping, width)
    depth = 1 + 2 * np.abs(np.sin(7 * rays + 5 * random.random(3)).sum(axis=2))
    depth *= random.uniform(0.7, 1.4, depth.shape)
    depth[random.random(depth.shape) < 0.2] = np.inf
    depth[(rays @ random.normal(size=3)) > 0.9] = np.nan
    return layer_of(mapping, depth.astype(np.float32))


def tile_of_pixels(mapping, height, width):
    """Sheet, first row and first column (H, W, 3) of each pixel's tile."""
    row, column = np.mgrid[:height, :width]
    if mapping == "cube map":
        size = height // 2
        sheet, row, column = row // size * 3 + column // size, row % size, column % size
    else:
        sheet = np.zeros_like(row)
    return np.stack([sheet, row // TILE * TILE, column // TILE * TILE], axis=-1)


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("seed", range(4))
def test_no_tile_is_left_out_that_is_seen_and_few_others_are_kept(mapping, seed):
    random = np.random.default_rng(seed)
    width = 300 if mapping == "cube map" else 400  # no multiples of TILE
    layer = rough_layer(mapping, width, seed)
    camera = Pinhole.looking_at(random.uniform(-2, 2, 3), random.uniform(-2, 2, 3), 50, 64, 48)
    kept = {tuple(tile) for tile in Tiles(layer).in_view(camera, frustum(camera, (0, 48), 0.0))}
    points = layer.depth[..., None] * directions(mapping, width)
    with np.errstate(invalid="ignore"):
        xy, _ = camera.project(points)
        seen = np.isfinite(layer.depth) & ((xy >= 0) & (xy <= (64, 48))).all(axis=-1)
    tiles = tile_of_pixels(mapping, *layer.depth.shape)
    assert {tuple(tile) for tile in tiles[seen]} <= kept
    assert len(kept) < 0.9 * len(np.unique(tiles.reshape(-1, 3), axis=0))


@pytest.mark.parametrize("mapping", BOTH)
def test_from_the_centre_little_more_than_the_picture_is_kept(mapping):
    """60 x 40 degrees are 5 % of the sphere."""
    width = 768 if mapping == "cube map" else 1024
    camera = Pinhole.looking_at((0, 0, 0), (1, 0.3, 0.1), 60, 96, 64)
    tiles = Tiles(box_layer(mapping, width))
    assert len(tiles.in_view(camera, frustum(camera, (0, 64), 1.0))) < 0.15 * tiles.nearest.size


def test_rows_of_a_picture_take_the_tiles_behind_them():
    layer = rough_layer("equirectangular", 400, 1)
    camera = Pinhole.looking_at((0, 0, 0), (1, 0, 0), 60, 64, 64)
    top, bottom = (
        Tiles(layer).in_view(camera, frustum(camera, rows, 0.0))[:, 1] for rows in ((0, 10), (54, 64))
    )
    assert top.max() < 100 + TILE
    assert bottom.min() > 100 - TILE


def test_a_mask_and_infinity_leave_nothing_to_see():
    depth = np.ones((32, 64), np.float32)
    inside = np.zeros((32, 64), dtype=bool)
    inside[0, 0] = True
    depth[0, 0] = np.inf
    tiles = Tiles(Layer("sky", "equirectangular", {"depth": depth, "mask": inside}))
    camera = Pinhole.looking_at((0, 0, 0), (1, 0, 0), 170, 64, 64)
    assert len(tiles.in_view(camera, frustum(camera, (0, 64), 1.0))) == 0
