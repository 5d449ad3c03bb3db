"""Which pixels of a map are neighbours: across the seam, over the poles, and beyond the rim of a face."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import CUBE_MAP

_border_texels = lru_cache(maxsize=4)(cube_map.border_texels)


def sheets_of(mapping: str, width: int, height: int) -> tuple[int, int, int]:
    """How many sheets a map has, and the rows and columns of each: six faces, or the whole map.

    >>> sheets_of("cube map", 12, 8)
    (6, 4, 4)
    """
    return (6, height // 2, width // 3) if mapping == CUBE_MAP else (1, height, width)


def texel_index(mapping: str, width: int, height: int, sheet, row, column) -> np.ndarray:
    """Row-major index (...) into a map (height, width) of pixels of its sheets, -1 where there is none.

    sheet, row, column: (...) whole numbers; row and column may lie one pixel outside of the sheet: then it is
    the pixel there on the sphere. None is beyond a corner of the cube, where three pixels meet.
    """
    sheet, row, column = np.broadcast_arrays(sheet, row, column)
    if mapping != CUBE_MAP:
        return equirectangular.texel_index(column, row, width, height)
    size = height // 2
    index = _on_face(sheet, row, column, size)
    past = np.stack([row < 0, row >= size, column < 0, column >= size])
    sides = past.sum(axis=0)
    for side in range(4):
        there = past[side] & (sides == 1)
        along = (column if side < 2 else row)[there]
        index[there] = _on_face(*(axis[sheet[there], side, along] for axis in _border_texels(size)), size)
    index[sides > 1] = -1
    return index


def _on_face(face, row, column, size):
    return ((face // 3) * size + row) * (3 * size) + (face % 3) * size + column
