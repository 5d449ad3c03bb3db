"""Normals of a layer from its depth, and how fast they turn.

Source: thesis, section 7.4.2.6, eq. 7.9-7.15. ``depth`` and ``inside`` are sheets (sheets, rows, columns) of
the map of a `Corners`: depths [m], and whether a pixel is in the domain.
"""

import numpy as np

from ... import cube_map, equirectangular
from ..panorama import CUBE_MAP

_ROWS = 64  # handled at once: float64 points of a whole map of 8k would take 800 MB


def normals_from_depth(corners, depth, inside):
    """Unit normals (sheets, rows, columns, 3), float32, towards the origin; 0 outside of the domain.

    The mean of the four triangles round a pixel, weighted by area (eq. 7.11): that is the cross product of
    the vectors between its neighbours, as the pixel itself cancels out. A neighbour outside of the domain,
    or beyond a cube's face, is replaced by the pixel itself. In equirectangular maps the neighbours to the
    left and right are taken 1/cos(elevation) columns away: near a pole the next one is so near that the
    depth's rounding would tilt the normal. A pixel with no neighbours looks at the origin.
    """
    normals = np.zeros((*inside.shape, 3), dtype=np.float32)
    sheets, rows, _ = inside.shape
    for sheet in range(sheets):
        for start in range(0, rows, _ROWS):
            end = min(start + _ROWS, rows)
            known = inside[sheet, max(start - 1, 0) : end + 1]
            if known.any():
                block = slice(max(start - 1, 0), min(end + 1, rows))
                found = _block_normals(corners, sheet, block, depth[sheet, block], known)
                normals[sheet, start:end] = found[start - block.start : end - block.start]
    return normals


def normal_variation(corners, normals, inside):
    """V_N (sheets, rows, columns), float32: how much a normal differs from those to the left and above.

    Along the rims of a sheet it is compared with those beyond the rim, too.

    The root of the sum of squares of 1 - <n, n'> (eq. 7.12-7.15); a neighbour outside of the domain does
    not count. Eq. 7.12-7.13 have the absolute value of the dot product, for which the two sides of a fold
    are alike; here opposite normals differ most, by 2 instead of 0.
    """
    across, down = np.zeros(inside.shape, np.float32), np.zeros(inside.shape, np.float32)
    for start in range(0, inside.shape[1], _ROWS):
        here, last = slice(start, start + _ROWS), min(start + _ROWS, inside.shape[1] - 1)
        across[:, here, 1:] = _difference(normals, inside, np.s_[:, here, 1:], np.s_[:, here, :-1])
        above, below = slice(start, last), slice(start + 1, last + 1)
        down[:, below] = _difference(normals, inside, np.s_[:, below, :], np.s_[:, above, :])
    variation = np.hypot(across, down, out=across)
    for rim, beyond in corners.rims:
        variation[rim] = np.hypot(variation[rim], _difference(normals, inside, rim, beyond))
    return variation


def _difference(normals, inside, here, there):
    """1 - <n, n'>, as half the square of n - n': of nearly equal normals nothing is lost by rounding."""
    total = np.zeros(normals[here].shape[:-1], dtype=np.float32)
    for axis in range(3):
        total += (normals[(*here, axis)] - normals[(*there, axis)]) ** 2
    total *= 0.5
    total[~(inside[here] & inside[there])] = 0
    return total


def _block_normals(corners, sheet, block, depth, inside):
    """Normals (rows, columns, 3) of a block of rows; in planes, which numpy handles fastest."""
    rows, columns = np.arange(block.start, block.stop), np.arange(inside.shape[1])
    directions = _directions(corners, sheet, rows, columns)
    distance = np.where(inside, depth, 0.0)
    points = [direction * distance for direction in directions]
    right, left = (_beside(corners, inside, rows, columns, side) for side in (1, -1))
    below, above = _next_row(inside, 1), _next_row(inside, -1)
    across = [p.take(right) - p.take(left) for p in points]
    down = [p.take(below) - p.take(above) for p in points]
    normals = [down[i] * across[j] - down[j] * across[i] for i, j in ((1, 2), (2, 0), (0, 1))]
    length = np.sqrt(sum(n * n for n in normals))
    result = np.empty((*inside.shape, 3), dtype=np.float32)
    for axis, (normal, direction) in enumerate(zip(normals, directions, strict=True)):
        result[..., axis] = np.divide(normal, length, out=-direction * np.ones_like(length), where=length > 0)
    result[~inside] = 0
    return result


def _beside(corners, inside, rows, columns, side):
    """Flat indices of the neighbours to the right (1) or left (-1), or of the pixel itself."""
    if corners.wraps:
        elevation = (0.5 - (rows + 0.5) / corners.height) * np.pi
        step = np.minimum(np.rint(1 / np.cos(elevation)).astype(np.int64), len(columns) // 4)
        there = (columns + side * step[:, None]) % len(columns)
    else:
        there = np.broadcast_to(np.clip(columns + side, 0, len(columns) - 1), inside.shape)
    return _or_itself(np.arange(len(rows))[:, None] * len(columns) + there, inside)


def _next_row(inside, side):
    """Flat indices of the pixels of the domain one row further, or of the pixel itself."""
    rows, columns = inside.shape
    there = np.clip(np.arange(rows) + side, 0, rows - 1)[:, None] * columns + np.arange(columns)
    return _or_itself(there, inside)


def _or_itself(there, inside):
    known = inside.take(there)
    if known.all():
        return there
    return np.where(known, there, np.arange(inside.size).reshape(inside.shape))


def _directions(corners, sheet, rows, columns):
    """x, y and z of the directions of a block's pixels, each of a shape that broadcasts to it."""
    if corners.mapping == CUBE_MAP:
        size = len(columns)
        s, t = np.meshgrid(2 * (columns + 0.5) / size - 1, 2 * (rows + 0.5) / size - 1)
        points = np.moveaxis(cube_map.point_on_face(np.array(sheet), s, t), -1, 0)
        return points / np.sqrt(1 + s * s + t * t)
    u = (columns + 0.5) / corners.width
    v = (rows + 0.5) / corners.height
    level = equirectangular.direction_from_uv(np.stack([u, np.full_like(u, 0.5)], axis=1))
    upright = equirectangular.direction_from_uv(np.stack([np.full_like(v, 0.5), v], axis=1))
    horizontal = upright[:, :1]
    return horizontal * level[:, 0], horizontal * level[:, 1], upright[:, 2:]
