"""Normals of a layer from its depth, and how fast they turn.

Source: thesis, section 7.4.2.6, eq. 7.9-7.15. ``depth`` and ``inside`` are sheets (sheets, rows, columns) of
the map of a `Corners`: depths [m], and whether a pixel is in the domain.
"""

import numpy as np

from .. import cube_map, equirectangular
from .panorama import CUBE_MAP

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

    Along the rims of a cube's faces it is compared with those of the other faces, too.

    The root of the sum of squares of 1 - <n, n'> (eq. 7.12-7.15); a neighbour outside of the domain does
    not count. Eq. 7.12-7.13 have the absolute value of the dot product, for which the two sides of a fold
    are alike; here opposite normals differ most, by 2 instead of 0.
    """
    across, down = np.zeros(inside.shape, np.float32), np.zeros(inside.shape, np.float32)
    across[:, :, 1:] = _difference(normals, inside, np.s_[:, :, 1:], np.s_[:, :, :-1])
    if corners.wraps:
        across[:, :, :1] = _difference(normals, inside, np.s_[:, :, :1], np.s_[:, :, -1:])
    down[:, 1:] = _difference(normals, inside, np.s_[:, 1:, :], np.s_[:, :-1, :])
    variation = np.hypot(across, down, out=across)
    if corners.mapping == CUBE_MAP:
        _add_other_faces(variation, normals, inside)
    return variation


def _add_other_faces(variation, normals, inside):
    there = cube_map.border_texels(inside.shape[1])
    rims = (np.s_[:, 0, :], np.s_[:, -1, :], np.s_[:, :, 0], np.s_[:, :, -1])
    for side, here in enumerate(rims):
        beyond = tuple(axis[:, side] for axis in there)
        variation[here] = np.hypot(variation[here], _difference(normals, inside, here, beyond))


def _difference(normals, inside, here, there):
    """1 - <n, n'>, as half the square of n - n': of nearly equal normals nothing is lost by rounding."""
    total = np.zeros(normals[here].shape[:-1], dtype=np.float32)
    for axis in range(3):
        total += (normals[(*here, axis)] - normals[(*there, axis)]) ** 2
    total *= 0.5
    total[~(inside[here] & inside[there])] = 0
    return total


def _block_normals(corners, sheet, block, depth, inside):
    rows = np.arange(block.start, block.stop)
    columns = np.arange(inside.shape[1])
    directions = _directions(corners, sheet, rows, columns)
    points = directions * np.where(inside, depth, 0.0)[..., None]
    across = np.zeros_like(points)
    for side in (1, -1):
        if corners.wraps:
            elevation = (0.5 - (rows + 0.5) / corners.height) * np.pi
            step = np.minimum(np.rint(1 / np.cos(elevation)).astype(np.int64), len(columns) // 4)
            there = (columns + side * step[:, None]) % len(columns)
        else:
            there = np.broadcast_to(np.clip(columns + side, 0, len(columns) - 1), inside.shape)
        row = np.arange(len(rows))[:, None]
        known = inside[row, there][..., None]
        across += side * np.where(known, points[row, there], points)
    down = np.zeros_like(points)
    down[:-1] += np.where(inside[1:, :, None], points[1:], points[:-1])
    down[1:] -= np.where(inside[:-1, :, None], points[:-1], points[1:])
    down[-1] += points[-1]
    down[0] -= points[0]
    normals = _cross(down, across)
    length = np.sqrt(np.einsum("...k,...k", normals, normals))[..., None]
    normals = np.divide(normals, length, out=-directions, where=length > 0)
    normals[~inside] = 0
    return normals


def _directions(corners, sheet, rows, columns):
    if corners.mapping == CUBE_MAP:
        size = len(columns)
        s, t = np.meshgrid(2 * (columns + 0.5) / size - 1, 2 * (rows + 0.5) / size - 1)
        points = cube_map.point_on_face(np.array(sheet), s, t)
        return points / np.linalg.norm(points, axis=-1, keepdims=True)
    ij = np.stack(np.meshgrid(columns, rows), axis=-1)
    uv = equirectangular.uv_from_pixel(ij, corners.width, corners.height)
    return equirectangular.direction_from_uv(uv)


def _cross(a, b):
    """Cross product of (..., 3), faster than numpy's."""
    result = np.empty_like(a)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        result[..., k] = a[..., i] * b[..., j] - a[..., j] * b[..., i]
    return result
