"""The pixels of a map and who is whose neighbour: round the seam, over the poles, across edges of the cube.

Pixels have numbers, sheet by sheet and row by row; a sheet is a whole equirectangular map, or a face of a
cube map. Neighbours stand in four slots: to the right, to the left, below and above.
"""

from __future__ import annotations

from functools import cached_property

import cv2
import numpy as np

from ... import cube_map, equirectangular
from ..panorama import CUBE_MAP, EQUIRECTANGULAR, refuse_other_layout

RIGHT, LEFT, DOWN, UP = range(4)
_FEW = 1 / 16  # of a map's pixels: for no more, nothing is made of the whole map
_RIMS = ((UP, 0), (DOWN, 1), (LEFT, 2), (RIGHT, 3))  # slots, and their place in cube_map.border_texels


class PixelGrid:
    """Pixels of a map of (width, height) px in one of the two mappings.

    Raises: ValueError for a size that no map of the mapping has.

    >>> grid = PixelGrid("equirectangular", 4, 2)
    >>> grid.neighbours[:, 0].tolist()
    [1, 3, 4, 2]
    """

    def __init__(self, mapping: str, width: int, height: int):
        refuse_other_layout(width, height, mapping)
        self.mapping, self.width, self.height = mapping, width, height
        self.sheet_shape = (6, height // 2, width // 3) if mapping == CUBE_MAP else (1, height, width)
        self.size = width * height

    @property
    def is_cube(self) -> bool:
        """Whether the sheets are the faces of a cube."""
        return self.mapping == CUBE_MAP

    @property
    def pixel(self) -> float:
        """The side of a pixel [rad]: at the equator, or on average over a face."""
        return np.pi / 2 / self.sheet_shape[1] if self.is_cube else 2 * np.pi / self.width

    def flat(self, image: np.ndarray) -> np.ndarray:
        """An image (H, W, …) of the map by the pixels' numbers (size, …)."""
        if not self.is_cube:
            return image.reshape(self.size, *image.shape[2:])
        n = self.sheet_shape[1]
        faces = image.reshape(2, n, 3, n, *image.shape[2:]).swapaxes(1, 2)
        return faces.reshape(self.size, *image.shape[2:])

    def image(self, flat: np.ndarray) -> np.ndarray:
        """The image (H, W, …) of values (size, …)."""
        rest = flat.shape[1:]
        if not self.is_cube:
            return flat.reshape(self.height, self.width, *rest)
        n = self.sheet_shape[1]
        return flat.reshape(2, 3, n, n, *rest).swapaxes(1, 2).reshape(self.height, self.width, *rest)

    @cached_property
    def directions(self) -> np.ndarray:
        """Unit directions (size, 3), float32, of the pixels' centres."""
        if self.is_cube:
            return np.ascontiguousarray(self.flat(cube_map.pixel_directions(self.sheet_shape[1])))
        return self.flat(equirectangular.pixel_directions(self.width, self.height))

    def at(self, directions: np.ndarray) -> np.ndarray:
        """Numbers (…) of the pixels that hold directions (…, 3)."""
        mapping = cube_map if self.is_cube else equirectangular
        uv = mapping.uv_from_direction(directions)
        column = np.clip((uv[..., 0] * self.width).astype(np.int64), 0, self.width - 1)
        row = np.clip((uv[..., 1] * self.height).astype(np.int64), 0, self.height - 1)
        if not self.is_cube:
            return row * self.width + column
        n = self.sheet_shape[1]
        return ((row // n * 3 + column // n) * n + row % n) * n + column % n

    @cached_property
    def neighbours(self) -> np.ndarray:
        """Numbers (4, size), int32, of the pixels in the four slots."""
        numbers = np.arange(self.size, dtype=np.int32).reshape(self.sheet_shape)
        slots = np.empty((4, *self.sheet_shape), dtype=np.int32)
        slots[RIGHT], slots[LEFT] = np.roll(numbers, -1, axis=2), np.roll(numbers, 1, axis=2)
        slots[DOWN], slots[UP] = np.roll(numbers, -1, axis=1), np.roll(numbers, 1, axis=1)
        if self.is_cube:
            face, row, column = cube_map.border_texels(self.sheet_shape[1])
            for slot, edge in _RIMS:
                slots[slot][rim(slot)] = numbers[face[:, edge], row[:, edge], column[:, edge]]
        else:
            half = self.width // 2
            slots[UP][rim(UP)] = np.roll(numbers[:, 0], half, axis=1)
            slots[DOWN][rim(DOWN)] = np.roll(numbers[:, -1], half, axis=1)
        return slots.reshape(4, self.size)

    def beside(self, pixels: np.ndarray) -> np.ndarray:
        """The `neighbours` (4, n) of pixels (n,); of a few, without those of the whole map."""
        return np.stack([self.beside_in(slot, pixels) for slot in range(4)])

    def beside_in(self, slot: int, pixels: np.ndarray) -> np.ndarray:
        """The neighbours (n,) in one slot of pixels (n,); of a few, without those of the whole map."""
        if "neighbours" in self.__dict__ or not self._are_few(pixels):
            return self.neighbours[slot, pixels]
        row = pixels // self.width
        column = pixels - row * self.width
        if slot in (RIGHT, LEFT):
            return pixels - column + (column + (1 if slot == RIGHT else -1)) % self.width
        over_pole = row * self.width + (column + self.width // 2) % self.width
        if slot == DOWN:
            return np.where(row == self.height - 1, over_pole, pixels + self.width)
        return np.where(row == 0, over_pole, pixels - self.width)

    def directions_of(self, pixels: np.ndarray) -> np.ndarray:
        """The `directions` (n, 3) of pixels (n,); of a few, without those of the whole map."""
        if "directions" in self.__dict__ or not self._are_few(pixels):
            return self.directions[pixels]
        row, column = np.divmod(pixels, self.width)
        uv = equirectangular.uv_from_pixel(np.stack([column, row], axis=-1), self.width, self.height)
        return equirectangular.direction_from_uv(uv).astype(np.float32)

    def _are_few(self, pixels):
        return not self.is_cube and len(pixels) <= self.size * _FEW

    def rim_pixels(self, slot: int) -> np.ndarray:
        """Numbers (n,) of the pixels whose neighbour in `slot` is beyond their sheet's rim."""
        return self._rim_pixels[slot]

    @cached_property
    def _rim_pixels(self):
        sheets, rows, columns = self.sheet_shape
        first = np.arange(sheets)[:, None] * (rows * columns)
        down, across = np.arange(rows) * columns, np.arange(columns)
        found = {
            RIGHT: first + down + (columns - 1),
            LEFT: first + down,
            DOWN: first + (rows - 1) * columns + across,
            UP: first + across,
        }
        return [found[slot].reshape(-1) for slot in range(4)]

    def slots_back(self, slot: int) -> np.ndarray:
        """The slots (n,) by which the neighbours of `rim_pixels` have those pixels for neighbours."""
        pixel = self.rim_pixels(slot)
        return np.argmax(self.neighbours[:, self.neighbours[slot, pixel]] == pixel, axis=0)

    def pairs(self, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pixels and their neighbours, each (n,), of slots chosen (4, size): a pair from both sides."""
        pixels = [np.flatnonzero(chosen[slot]) for slot in range(4)]
        others = [self.beside_in(slot, pixels[slot]) for slot in range(4)]
        return np.concatenate(pixels), np.concatenate(others)

    def components(self, inside: np.ndarray, joined: np.ndarray) -> tuple[int, np.ndarray]:
        """How many connected parts `inside` (size,) has, and the part (size,) of every pixel, -1 outside.

        joined: (4, size), whether a pixel hangs together with that in its slot, the same seen from both.
        """
        labels, first = np.full(self.size, -1, dtype=np.int32), 0
        mask, across, down, by_sheet = (
            a.reshape(self.sheet_shape) for a in (inside, joined[RIGHT], joined[DOWN], labels)
        )
        for sheet in range(len(mask)):
            part = (sheet, *_bounds(mask[sheet]))
            count, found = _sheet_components(mask[part], across[part], down[part])
            found += first
            by_sheet[part][mask[part]] = found[mask[part]]
            first += count
        return _merged(labels, first, *self._rim_pairs(inside, joined))

    def _rim_pairs(self, inside, joined):
        pixels, others = [], []
        for slot in range(4):
            pixel = self.rim_pixels(slot)
            other = self.beside_in(slot, pixel)
            met = joined[slot, pixel] & inside[pixel] & inside[other]
            pixels.append(pixel[met])
            others.append(other[met])
        return np.concatenate(pixels), np.concatenate(others)


def rim(slot: int):
    """Index into sheets of the pixels whose neighbour in `slot` is beyond the sheet's rim."""
    return {UP: np.s_[:, 0, :], DOWN: np.s_[:, -1, :], LEFT: np.s_[:, :, 0], RIGHT: np.s_[:, :, -1]}[slot]


def grid_of(layer) -> PixelGrid:
    """The grid of a layer's map."""
    return PixelGrid(layer.mapping, *layer.size)


def mapping_of_size(width: int, height: int) -> str:
    """The mapping that a map of (width, height) px must have.

    Raises: ValueError for a size that is neither 2:1 nor 3:2.
    """
    if width == 2 * height and height > 0:
        return EQUIRECTANGULAR
    if 2 * width == 3 * height and height > 0 and height % 2 == 0:
        return CUBE_MAP
    raise ValueError(f"map of {width} x {height} px must be 2:1 (equirectangular) or 3N x 2N (cube map)")


def _bounds(mask):
    """Slices of the rows and the columns that hold all of a mask (rows, columns); of none if it is empty."""
    for_axes = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    return tuple(slice(k[0], k[-1] + 1) if len(k) else slice(0, 0) for k in for_axes)


def _sheet_components(mask, across, down):
    """Parts of one sheet, numbered from 0: where all neighbours are joined, those of the mask; else on a grid
    of twice the size, where the places between pixels are the joints."""
    rows, columns = mask.shape
    if not mask.size:
        return 0, np.zeros(mask.shape, dtype=np.int32)
    beside, below = mask[:, :-1] & mask[:, 1:], mask[:-1] & mask[1:]
    joints, step = mask.astype(np.uint8), 1
    if (beside & ~across[:, :-1]).any() or (below & ~down[:-1]).any():
        joints, step = np.zeros((2 * rows, 2 * columns), dtype=np.uint8), 2
        joints[::2, ::2] = mask
        joints[::2, 1:-1:2] = beside & across[:, :-1]
        joints[1:-1:2, ::2] = below & down[:-1]
    count, labels = cv2.connectedComponents(joints, connectivity=4, ltype=cv2.CV_32S)
    return count - 1, labels[::step, ::step] - 1


def _merged(labels, count, pixels, others):
    """Labels with those of (n,) pixels and their neighbours made one, numbered anew."""
    parents = list(range(count))

    def root(label):
        while parents[label] != label:
            parents[label] = parents[parents[label]]
            label = parents[label]
        return label

    for a, b in np.unique(np.stack([labels[pixels], labels[others]], axis=1), axis=0).tolist():
        low, high = sorted((root(a), root(b)))
        parents[high] = low
    roots = np.array([root(label) for label in range(count)], dtype=np.int64)
    names, renumbered = np.unique(roots, return_inverse=True)
    inside = labels >= 0
    labels[inside] = renumbered.reshape(-1)[labels[inside]]
    return len(names), labels
