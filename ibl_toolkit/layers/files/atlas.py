"""The atlas of a layer: the rectangles of its map that hold something, moved together into a small image.

Source: thesis, section 6.2.3.1, eq. 6.16 and 6.17; beyond it, a rectangle may run over the seam.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np

from ..panorama import CUBE_MAP, EQUIRECTANGULAR, refuse_other_layout
from .packing import pack_rectangles

# Pixels of the domain closer than this share a rectangle [px]; doubled until there are few enough.
_BLOCK = 4
_MOST_PATCHES = 1024
# A rectangle is cut in two where that leaves out so many pixels and so large a part of it.
_WORTH_PIXELS, _WORTH_SHARE = 64, 0.05


class Patch(NamedTuple):
    """One rectangle, T = {(u, v), (x, y), (w, h)} of eq. 6.16 [px]: M(u + s, v + t) = A(x + s, y + t).

    Of an equirectangular map u + s is taken modulo the map's width.
    """

    u: int
    v: int
    x: int
    y: int
    w: int
    h: int


@dataclass(frozen=True)
class Atlas:
    """Where a map of size (W, H) went in an image of size (w, h) [px].

    Raises: ValueError naming the patch that leaves the map or the image.
    """

    map_size: tuple[int, int]
    size: tuple[int, int]
    mapping: str
    patches: tuple[Patch, ...]

    def __post_init__(self):
        refuse_other_layout(*self.map_size, self.mapping)
        for number, patch in enumerate(self.patches, 1):
            self._refuse_outside(patch, f"patch {number}, {tuple(patch)}")

    @property
    def share(self) -> float:
        """The image's area as a part of the map's."""
        return self.size[0] * self.size[1] / (self.map_size[0] * self.map_size[1])

    def packed(self, values: np.ndarray, fill=0) -> np.ndarray:
        """The atlas image (h, w, …) of a map (H, W, …); `fill` between the patches.

        >>> mask = np.zeros((2, 4), bool)
        >>> mask[1, [0, 3]] = True
        >>> atlas_of(mask, "equirectangular").packed(np.arange(8).reshape(2, 4))
        array([[7, 4]])
        """
        packed = np.full((self.size[1], self.size[0], *values.shape[2:]), fill, dtype=values.dtype)
        for patch in self.patches:
            columns = self._columns(patch)
            packed[_span(patch.y, patch.h), _span(patch.x, patch.w)] = values[
                _span(patch.v, patch.h), columns
            ]
        return packed

    def unpacked(self, packed: np.ndarray, fill=0) -> np.ndarray:
        """The map (H, W, …) of an atlas image (h, w, …): eq. 6.17; `fill` where no patch is.

        >>> mask = np.zeros((2, 4), bool)
        >>> mask[1, [0, 3]] = True
        >>> atlas_of(mask, "equirectangular").unpacked(np.array([[7, 4]]))
        array([[0, 0, 0, 0],
               [4, 0, 0, 7]])
        """
        values = np.full((self.map_size[1], self.map_size[0], *packed.shape[2:]), fill, dtype=packed.dtype)
        for patch in self.patches:
            columns = self._columns(patch)
            values[_span(patch.v, patch.h), columns] = packed[
                _span(patch.y, patch.h), _span(patch.x, patch.w)
            ]
        return values

    def _columns(self, patch):
        """A slice (a view, fast) where it can be one; the columns' numbers over the seam."""
        if patch.u + patch.w <= self.map_size[0]:
            return _span(patch.u, patch.w)
        return np.arange(patch.u, patch.u + patch.w) % self.map_size[0]

    def _refuse_outside(self, patch, what):
        width, height = self.map_size
        if min(patch) < 0 or patch.w < 1 or patch.h < 1:
            raise ValueError(f"{what} must have a size of 1 x 1 px or more and no offset below 0")
        right = patch.u + (1 if self.mapping == EQUIRECTANGULAR else patch.w)
        if patch.w > width or right > width or patch.v + patch.h > height:
            raise ValueError(f"{what} leaves the map of {width} x {height} px")
        if patch.x + patch.w > self.size[0] or patch.y + patch.h > self.size[1]:
            raise ValueError(f"{what} leaves the atlas of {self.size[0]} x {self.size[1]} px")


def atlas_of(mask: np.ndarray, mapping: str) -> Atlas:
    """The atlas of a domain (H, W), bool: each pixel of it lies in a patch.

    Connected parts get a rectangle each, cut in two as long as that leaves out much. An equirectangular map
    is cut open at the meridian that the domain meets least, so that what crosses the seam stays whole; a
    rectangle of a cube map stays in a face.

    Raises: ValueError for an empty mask or one of another layout.
    """
    height, width = mask.shape
    refuse_other_layout(width, height, mapping)
    if not mask.any():
        raise ValueError("the domain is empty: there is nothing to put into an atlas")
    if mapping == CUBE_MAP:
        n = height // 2
        tiles = [
            (i * n, j * n, mask[j * n : (j + 1) * n, i * n : (i + 1) * n]) for j in (0, 1) for i in range(3)
        ]
    else:
        cut = int(np.argmin(np.count_nonzero(mask, axis=0)))
        tiles = [(cut, 0, np.roll(mask, -cut, axis=1))]
    rectangles = _few_rectangles(tiles)
    rectangles[:, 0] %= width
    places, size = pack_rectangles(rectangles[:, 2:])
    patches = np.concatenate([rectangles[:, :2], places, rectangles[:, 2:]], axis=1)
    return Atlas((width, height), size, mapping, tuple(Patch(*patch) for patch in patches.tolist()))


def _few_rectangles(tiles):
    """Rectangles (n, 4) u, v, w, h of the tiles' domains, at most _MOST_PATCHES."""
    block = _BLOCK
    while True:
        rectangles = []
        for u, v, mask in tiles:
            found = np.array(_rectangles(mask, block), dtype=np.int64).reshape(-1, 4)
            rectangles.append(found + np.array([u, v, 0, 0]))
        rectangles = np.concatenate(rectangles)
        if len(rectangles) <= _MOST_PATCHES:
            return rectangles
        block *= 2


def _rectangles(mask, block):
    """(left, top, width, height) of the connected parts of a mask, seen in blocks, each cut where it pays."""
    height, width = mask.shape
    coarse = np.pad(mask, ((0, -height % block), (0, -width % block)))
    coarse = coarse.reshape(coarse.shape[0] // block, block, -1, block).any(axis=(1, 3))
    _, labels, stats, _ = cv2.connectedComponentsWithStats(coarse.astype(np.uint8), connectivity=8)
    rectangles = []
    for label, (left, top, w, h, _) in enumerate(stats[1:].tolist(), 1):
        own = labels[top : top + h, left : left + w] == label
        own = own.repeat(block, axis=0).repeat(block, axis=1)
        part = mask[top * block : (top + h) * block, left * block : (left + w) * block]
        part = part & own[: part.shape[0], : part.shape[1]]
        rectangles += _cut(part, left * block, top * block, block)
    return rectangles


def _cut(part, left, top, block):
    """Rectangles of one part at (left, top), cut in two as long as that leaves out much."""
    done, waiting = [], [(part, left, top)]
    while waiting:
        part, left, top = waiting.pop()
        rows, columns = np.flatnonzero(part.any(axis=1)), np.flatnonzero(part.any(axis=0))
        left, top = left + int(columns[0]), top + int(rows[0])
        part = part[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        area = part.size
        worth = max(_WORTH_PIXELS * (block // _BLOCK) ** 2, _WORTH_SHARE * area)
        (across, at_row), (along, at_column) = _best_cut(part), _best_cut(part.T)
        if area - min(across, along) < worth:
            done.append((left, top, part.shape[1], part.shape[0]))
        elif across <= along:
            waiting += [(part[:at_row], left, top), (part[at_row:], left, top + at_row)]
        else:
            waiting += [(part[:, :at_column], left, top), (part[:, at_column:], left + at_column, top)]
    return done


def _best_cut(part):
    """The least area of the two bounding rectangles when the rows are cut in two, and the row of the cut.

    The first and the last row of `part` are not empty; the area of one row is its bounds.
    """
    height, width = part.shape
    if height < 2:
        return part.size, 0
    some = part.any(axis=1)
    first = np.where(some, part.argmax(axis=1), width)
    last = np.where(some, width - 1 - part[:, ::-1].argmax(axis=1), -1)
    index = np.arange(height)
    above = _bounds(first, last) * (np.maximum.accumulate(np.where(some, index, 0)) + 1)
    below = _bounds(first[::-1], last[::-1]) * (np.maximum.accumulate(np.where(some[::-1], index, 0)) + 1)
    areas = above[:-1] + below[::-1][1:]
    best = int(np.argmin(areas))
    return int(areas[best]), best + 1


def _bounds(first, last):
    """Width of the bounding rectangle of all rows up to each."""
    return np.maximum.accumulate(last) - np.minimum.accumulate(first) + 1


def _span(start, length):
    return slice(start, start + length)
