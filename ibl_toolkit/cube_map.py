"""Directions <-> pixels of a 3 x 2 cube map, faces +x +y +z above -x -y -z.

Every face of N x N pixels is what a camera of 90 degrees sees from inside the cube; the image is 3N wide
and 2N high.  u runs from the left edge of the whole image, v from its top edge, as in `equirectangular`.

Source: thesis, appendix A.3, eq. A.11-A.34; pixels have their centres at ((i + 1/2)/3N, (j + 1/2)/2N),
where eq. A.35 has their corners.  The directions are made unit length.
"""

from functools import lru_cache

import numpy as np

from . import equirectangular
from .equirectangular import pixel_from_uv, uv_from_pixel  # the same formula for any layout

__all__ = [
    "border_texels",
    "direction_from_uv",
    "from_equirectangular",
    "pixel_directions",
    "pixel_from_uv",
    "point_on_face",
    "sample",
    "solid_angles",
    "to_equirectangular",
    "uv_from_direction",
    "uv_from_pixel",
]

# Per face, in the order +x +y +z -x -y -z: the directions of its centre, of its right (s) and down (t)
# side.  Read off eq. A.29-A.34.
_FORWARD = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], dtype=np.float64)
_RIGHT = np.array([[0, -1, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [-1, 0, 0], [1, 0, 0]], dtype=np.float64)
_DOWN = np.array([[0, 0, -1], [0, 0, -1], [0, -1, 0], [0, 0, -1], [0, 0, -1], [0, -1, 0]], dtype=np.float64)

# A direction on the far edge of a face would get the u of the next face of the layout, which is no
# neighbour on the cube.  Stay this far inside (in face widths; the direction errs by as little).
_INSIDE = 1e-12
_BLOCK = 1 << 17


def direction_from_uv(uv):
    """Unit directions (..., 3), float64, of image points (..., 2) in [0, 1].

    >>> direction_from_uv([0.5, 0.25])
    array([0., 1., 0.])
    """
    column, row = np.moveaxis(np.asarray(uv, dtype=np.float64) * (3, 2), -1, 0)
    column_face, row_face = np.clip(np.floor(column), 0, 2), np.clip(np.floor(row), 0, 1)
    face = (3 * row_face + column_face).astype(np.int64)
    return _direction_from_face(face, 2 * (column - column_face) - 1, 2 * (row - row_face) - 1)


def uv_from_direction(direction):
    """Image points (..., 2) of directions (..., 3) of any length but zero.

    A direction on an edge of the cube belongs to the first of its faces in the order x, y, z.

    Raises: ValueError for a direction of length zero or one that is not finite.

    >>> uv_from_direction([0, 0, -3]).round(6)
    array([0.833333, 0.75    ])
    """
    face, s, t = _face_from_direction(direction)
    s, t = (np.clip((coordinate + 1) / 2, 0, 1 - _INSIDE) for coordinate in (s, t))
    return np.stack([(face % 3 + s) / 3, (face // 3 + t) / 2], axis=-1)


@lru_cache(maxsize=4)
def pixel_directions(face_size):
    """Directions (2N, 3N, 3), float32, of all pixel centres; read-only, and kept for the next call.

    >>> pixel_directions(1)[0, 1]
    array([0., 1., 0.], dtype=float32)
    """
    directions = np.empty((2 * face_size, 3 * face_size, 3), dtype=np.float32)
    centres = (2 * np.arange(face_size) + 1) / face_size - 1
    for face in range(6):
        s, t = np.meshgrid(centres, centres)
        _face_view(directions, face)[...] = _direction_from_face(np.array(face), s, t)
    directions.flags.writeable = False
    return directions


def solid_angles(face_size):
    """Exact solid angle [sr] of every pixel, (2N, 3N).  Together they make 4 pi.

    The rectangle from a face's centre to (s, t) spans atan(s t / sqrt(1 + s^2 + t^2)).

    >>> bool(np.isclose(solid_angles(4).sum(), 4 * np.pi, rtol=1e-12))
    True
    """
    edges = 2 * np.arange(face_size + 1) / face_size - 1
    s, t = np.meshgrid(edges, edges)
    from_centre = np.arctan2(s * t, np.sqrt(1 + s * s + t * t))
    return np.tile(np.diff(np.diff(from_centre, axis=0), axis=1), (2, 3))


def sample(cube, directions):
    """Bilinear look-up of `cube` (2N, 3N, C) or (2N, 3N) at `directions` (..., 3); -> (..., C) or (...).

    Beyond an edge of the cube it goes on with the neighbouring face's texels, so that the look-up is
    continuous everywhere.  At a corner of the cube, where three texels meet and the fourth is missing,
    their mean stands for it.  Since the grid bends at an edge, a smooth field errs by up to a quarter of
    a texel of its gradient between two faces, and to second order inside them.

    Raises: ValueError for an image that is not 3:2.

    >>> sample(np.arange(6.0).reshape(2, 3), [[1, 0, 0], [1, 1, 0]])
    array([0. , 0.5])
    """
    cube, directions = np.asarray(cube), np.asarray(directions)
    face_size = _face_size(cube)
    texels = _padded_faces(cube).reshape(6 * (face_size + 2) ** 2, -1)
    flat = directions.reshape(-1, 3)
    result = np.empty((len(flat), texels.shape[1]), dtype=texels.dtype)
    for start in range(0, len(flat), _BLOCK):
        block = slice(start, start + _BLOCK)
        result[block] = _bilinear(texels, face_size, *_face_from_direction(flat[block]))
    return result.reshape(directions.shape[:-1] + cube.shape[2:])[()]


def from_equirectangular(image, face_size):
    """Cube map (2N, 3N, C) of an equirectangular image: its bilinear look-up at every pixel centre.

    Choose N >= W/4, or small bright things fall between the samples.

    >>> from_equirectangular(np.ones((4, 8, 3)), 2).shape
    (4, 6, 3)
    """
    return equirectangular.sample(image, pixel_directions(face_size))


def to_equirectangular(cube, width, height):
    """Equirectangular image (H, W, C) of a cube map: its bilinear look-up at every pixel centre.

    >>> to_equirectangular(np.ones((4, 6, 3)), 8, 4).shape
    (4, 8, 3)
    """
    return sample(cube, equirectangular.pixel_directions(width, height))


def point_on_face(face, s, t):
    """Points (..., 3) on the cube from -1 to 1, of places s to the right and t down, both (...) from -1 to 1.

    face: (...) numbers of the faces in the order +x +y +z -x -y -z. Source: eq. A.29-A.34.

    >>> point_on_face(np.array([1]), np.array([0.5]), np.array([1.0]))
    array([[ 0.5,  1. , -1. ]])
    """
    return _FORWARD[face] + s[..., None] * _RIGHT[face] + t[..., None] * _DOWN[face]


def _direction_from_face(face, s, t):
    direction = point_on_face(face, s, t)
    return direction / np.linalg.norm(direction, axis=-1, keepdims=True)


def _face_from_direction(direction):
    """Face number (...), and s to the right and t down, each (...) in [-1, 1]: eq. A.11-A.24."""
    direction = np.stack(equirectangular.direction_components(direction), axis=-1)
    axis = np.argmax(np.abs(direction), axis=-1)
    along = np.take_along_axis(direction, axis[..., None], axis=-1)[..., 0]
    face = axis + 3 * (along < 0)
    on_cube = direction / np.abs(along)[..., None]
    return face, np.sum(on_cube * _RIGHT[face], axis=-1), np.sum(on_cube * _DOWN[face], axis=-1)


def _bilinear(padded_texels, face_size, face, s, t):
    stride = face_size + 2
    # Column of the padded face: texel centres at 1 .. N, the borrowed ones at 0 and N + 1.
    i, j = ((coordinate + 1) / 2 * face_size + 0.5 for coordinate in (s, t))
    left, top = (np.clip(np.floor(k), 0, face_size).astype(np.int64) for k in (i, j))
    first = (face * stride + top) * stride + left
    indices = (first, first + 1, first + stride, first + stride + 1)
    return equirectangular.weighted_texels(
        padded_texels, indices, equirectangular.bilinear_weights(i - left, j - top)
    )


def _padded_faces(cube):
    """The six faces with a border of one texel from their neighbours, (6, N + 2, N + 2, ...)."""
    n = _face_size(cube)
    faces = np.stack([_face_view(cube, face) for face in range(6)])
    faces = faces.astype(np.result_type(cube.dtype, np.float32), copy=False)
    padded = np.empty((6, n + 2, n + 2, *cube.shape[2:]), dtype=faces.dtype)
    padded[:, 1:-1, 1:-1] = faces
    neighbour, j, i = border_texels(n)
    side = slice(1, n + 1)
    for k, place in enumerate(((0, side), (n + 1, side), (side, 0), (side, n + 1))):
        padded[(slice(None), *place)] = faces[neighbour[:, k], j[:, k], i[:, k]]
    for row, row_inside in ((0, 1), (n + 1, n)):
        for column, column_inside in ((0, 1), (n + 1, n)):
            meeting = (row_inside, column_inside), (row, column_inside), (row_inside, column)
            padded[:, row, column] = sum(padded[:, a, b] for a, b in meeting) / 3
    return padded


@lru_cache(maxsize=8)
def border_texels(face_size):
    """Face, row and column, each (6, 4, N), of the texels beyond the top, bottom, left and right edges.

    >>> face, row, column = border_texels(2)
    >>> face[0, 0].tolist(), row[0, 0].tolist(), column[0, 0].tolist()
    ([2, 2], [0, 1], [0, 0])
    """
    centres = (2 * np.arange(face_size) + 1) / face_size - 1
    beyond = np.full(face_size, 1 + 1e-3 / face_size)  # so little that it stays beside the same texel
    edges_s = np.stack([centres, centres, -beyond, beyond])
    edges_t = np.stack([-beyond, beyond, centres, centres])
    own_face = np.arange(6)[:, None, None]
    face, s, t = _face_from_direction(_direction_from_face(own_face, edges_s[None], edges_t[None]))
    i, j = (np.clip(((c + 1) / 2 * face_size).astype(np.int64), 0, face_size - 1) for c in (s, t))
    return face, j, i


def _face_view(cube, face):
    n = cube.shape[0] // 2
    row, column = divmod(face, 3)
    return cube[row * n : (row + 1) * n, column * n : (column + 1) * n]


def _face_size(cube):
    height, width = cube.shape[:2]
    if height < 2 or height % 2 or 2 * width != 3 * height:
        raise ValueError(
            f"cube map of {width} x {height} px is not made of 3 x 2 square faces: it must be 3N x 2N"
        )
    return height // 2
