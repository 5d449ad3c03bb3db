"""The part of a layer whose uniform mesh a camera may see: all else need not be made."""

from __future__ import annotations

import numpy as np

from ..panorama import CUBE_MAP, Layer
from ..views.pinhole import Pinhole
from ..views.texels import sheets_of
from ..views.visible_tiles import TILE, Tiles, frustum


def pixels_in_sight(layer: Layer, camera: Pinhole) -> np.ndarray:
    """(H, W) bool: pixels whose triangles may be in a camera's picture; the camera in the panorama's frame.

    Whole tiles of the layer are taken. A corner's depth is at least half of the least depth of the four
    pixels round it, and twice the largest at most (see `Corners.depths`); some may be of the tiles around.
    """
    tiles = Tiles(layer)
    wraps = layer.mapping != CUBE_MAP
    tiles.nearest = 0.5 * _over_neighbours(tiles.nearest, np.minimum, wraps)
    tiles.farthest = 2.0 * _over_neighbours(tiles.farthest, np.maximum, wraps)
    sheets = np.zeros(sheets_of(layer.mapping, *layer.size), dtype=bool)
    for sheet, row, column in tiles.in_view(camera, frustum(camera, (0, camera.height), 0)):
        sheets[sheet, row : row + TILE, column : column + TILE] = True
    if wraps:
        return sheets[0]
    return np.concatenate([np.concatenate(list(row), axis=1) for row in (sheets[:3], sheets[3:])])


def _over_neighbours(values, least_or_most, wraps):
    """The least or largest of each tile's and its neighbours', for values (sheets, rows, columns).

    A pole has all tiles of its row for neighbours. Beyond the edge of a face, whichever tile on an edge.
    """
    columns = ((0, 0), (0, 0), (1, 1))
    if wraps:
        values = np.concatenate([values[:, :1], values, values[:, -1:]], axis=1)
        for end in (0, -1):
            values[:, end] = least_or_most.reduce(values[:, end], axis=1, keepdims=True)
        padded = np.pad(values, columns, mode="wrap")
    else:
        rim = np.concatenate([values[:, [0, -1]].reshape(-1), values[:, :, [0, -1]].reshape(-1)])
        padded = np.pad(values, ((0, 0), (1, 1), (1, 1)), constant_values=least_or_most.reduce(rim))
    rows = [padded[:, k : padded.shape[1] - 2 + k] for k in range(3)]
    across = least_or_most.reduce(rows)
    return least_or_most.reduce([across[:, :, k : across.shape[2] - 2 + k] for k in range(3)])
