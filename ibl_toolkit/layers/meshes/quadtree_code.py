"""Triangulations as bits: a layer's mesh is what its quadtree and its depth map make of each other.

A quadtree is stored as one bit per cell that could be split, level by level and row by row: 1 where it is
split. A mesh that is no quadtree's is stored as the corner number of each vertex and the indices of each
triangle. Neither holds a position: these follow from the depth map.

Source: thesis, section 7.4.2.7. There a single pixel has a bit, too; here it has none, as it can't be split.
All numbers are little-endian.
"""

import struct

import numpy as np

from .quadtree import Quadtree, level_cells, number_of_levels, spread

_TREE = struct.Struct("<4sIII")  # magic, sheets, width, height
_TREE_MAGIC = b"XPQ1"
_TRIANGLES = struct.Struct("<4sII")  # magic, vertices, triangles
_TRIANGLES_MAGIC = b"XPT1"
_MOST_SHEETS, _MOST_PIXELS = 6, 1 << 29  # so that a few hostile bytes can't ask for all memory


def encode_quadtree(tree: Quadtree) -> bytes:
    """Header of 16 bytes, then a bit for each cell of more than one pixel.

    >>> from .quadtree import build_quadtree
    >>> encode_quadtree(build_quadtree(1, 4, 4, lambda cells: cells.x0 + cells.y0 == 0))[16:].hex()
    'c0'
    """
    bits = []
    exists = np.ones((tree.sheets, 1, 1), dtype=bool)
    for level, split in enumerate(tree.splits):
        where, divisible = _divisible(tree.width, tree.height, level, exists)
        bits.append(split[where][divisible])
        exists = spread(split, tree.width, tree.height, level)
    packed = np.packbits(np.concatenate(bits)).tobytes() if bits else b""
    return _TREE.pack(_TREE_MAGIC, tree.sheets, tree.width, tree.height) + packed


def decode_quadtree(data: bytes) -> Quadtree:
    """The quadtree of `encode_quadtree`.

    Raises: ValueError for data that begins otherwise, is too short or too long, or says it is of more than
    six sheets or 2^29 pixels.
    """
    sheets, width, height = _header(data, _TREE, _TREE_MAGIC, "quadtree")
    if not (0 < sheets <= _MOST_SHEETS and 0 < sheets * width * height <= _MOST_PIXELS):
        raise ValueError(
            f"quadtree of {sheets} sheets of {width} x {height} px: must be 1 to 6 of 1 to 2^29 px in all"
        )
    bits = np.unpackbits(np.frombuffer(data, np.uint8, offset=_TREE.size)).astype(bool)
    splits, read = [], 0
    exists = np.ones((sheets, 1, 1), dtype=bool)
    for level in range(number_of_levels(width, height)):
        where, divisible = _divisible(width, height, level, exists)
        count = np.count_nonzero(divisible)
        if read + count > len(bits):
            raise ValueError(f"quadtree data ends after {len(bits)} bits, in level {level}")
        split = np.zeros(exists.shape, dtype=bool)
        split[tuple(axis[divisible] for axis in where)] = bits[read : read + count]
        splits.append(split)
        read += count
        exists = spread(split, width, height, level)
    if len(bits) - read >= 8 or bits[read:].any():
        raise ValueError(f"quadtree data goes on after its last bit, {read}")
    return Quadtree(sheets, width, height, tuple(splits))


def encode_triangles(vertices: np.ndarray, triangles: np.ndarray) -> bytes:
    """Header of 12 bytes, corner numbers (V,) and triangles (T, 3) of indices: four bytes each.

    >>> len(encode_triangles(np.array([0, 5, 6]), np.array([[0, 1, 2]])))
    36
    """
    header = _TRIANGLES.pack(_TRIANGLES_MAGIC, len(vertices), len(triangles))
    return header + vertices.astype("<u4").tobytes() + triangles.astype("<u4").tobytes()


def decode_triangles(data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Corner numbers (V,) int64 and triangles (T, 3) int32 of `encode_triangles`.

    Raises: ValueError for data that begins otherwise, is of another length, or has an index that no vertex
    has.
    """
    vertices, triangles = _header(data, _TRIANGLES, _TRIANGLES_MAGIC, "triangles")
    right = _TRIANGLES.size + 4 * (vertices + 3 * triangles)
    if len(data) != right:
        raise ValueError(
            f"data of {vertices} vertices, {triangles} triangles has {len(data)} bytes, not {right}"
        )
    numbers = np.frombuffer(data, "<u4", offset=_TRIANGLES.size)
    indices = numbers[vertices:].reshape(-1, 3)
    if indices.size and indices.max() >= vertices:
        raise ValueError(f"triangles have vertex {indices.max()}, but there are only {vertices}")
    return numbers[:vertices].astype(np.int64), indices.astype(np.int32)


def _header(data, layout, magic, name):
    if len(data) < layout.size or not data.startswith(magic):
        raise ValueError(f"data is no {name}: it must begin with {magic.decode()}, not {bytes(data[:4])!r}")
    return layout.unpack_from(data)[1:]


def _divisible(width, height, level, exists):
    """Where cells of a level exist, (sheet, row, column), and which of these have more than one pixel."""
    where = np.nonzero(exists)
    return where, level_cells(width, height, level, where).area > 1
