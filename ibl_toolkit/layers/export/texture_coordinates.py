"""Where on a layer's texture the corners of triangles lie.

A texture coordinate belongs to a triangle's corner, not to a vertex: on the seam a vertex is at both ends of
the image, at a pole it is the whole row, on an edge of the cube it is on two faces. Each triangle gets
coordinates that are continuous on it: u may exceed 1, where the image repeats; at a pole u is the mean of the
other two corners'. Which corners can share a vertex all the same is found afterwards.

u runs from the left edge, v from the top edge, as in glTF and in `equirectangular`.
"""

from __future__ import annotations

import numpy as np

from ... import cube_map, equirectangular
from ...environment_uv import on_pole
from ..panorama import Layer
from ..views.rendered_view import sampled

_OFF_FACE = 1e-6  # how far beyond a cube's face a corner may lie by rounding, in half faces
_ROUNDING = 1e-9
_STEPS = 1 << 16  # texture coordinates nearer than this part of the image are one


class EquirectangularChart:
    """Texture coordinates on an equirectangular image of `width` px, or on some of its `rows`: first, count.

    >>> chart = EquirectangularChart(8)
    >>> chart.uv(np.array([[[-1, 0.1, 0], [-1, -0.1, 0], [0, 0, 1]]]))[0, :, 0].round(2).tolist()
    [1.02, 0.98, 1.0]
    """

    def __init__(self, width: int, rows: tuple[int, int] | None = None):
        self.pixels_per_radian = width / (2 * np.pi)
        first, count = rows or (0, width // 2)
        self._rows = slice(first, first + count)
        self._top, self._part = first / (width // 2), count / (width // 2)

    def texels(self, layer: Layer, values: np.ndarray) -> np.ndarray:
        """The texture (h, w, ...) that values (H, W, ...) of the layer's map give."""
        return values[self._rows]

    def uv(self, rays: np.ndarray) -> np.ndarray:
        """(n, k, 2) of the corners of triangles (k = 3), or of sides (k = 2), in the directions (n, k, 3).

        Raises: ValueError for a triangle with a pole inside, of which there is no continuous u.
        """
        uv, at_pole = equirectangular.uv_from_direction(rays), on_pole(rays)
        first = np.take_along_axis(uv[..., 0], np.argmin(at_pole, axis=1)[:, None], axis=1)
        steps = uv[..., 0] - first
        u = np.where(at_pole, 0, first + steps - np.round(steps))
        known = np.count_nonzero(~at_pole, axis=1).clip(1)
        u = np.where(at_pole, (u.sum(axis=1) / known)[:, None], u)
        wide = np.abs(np.roll(u, -1, axis=1) - u) > 0.5
        if wide.any():
            number = int(np.argmax(wide.any(axis=1)))
            raise ValueError(f"triangle {number} holds a pole of the image: it must be cut there")
        lowest = np.floor(u.min(axis=1, keepdims=True) + _ROUNDING)
        return np.stack([u - lowest, (uv[..., 1] - self._top) / self._part], axis=-1)

    def fits(self, rays: np.ndarray) -> np.ndarray:
        """Whether triangles with corners in the directions (n, 3, 3) lie on one piece: all do."""
        return np.ones(len(rays), dtype=bool)

    def direction(self, uv: np.ndarray) -> np.ndarray:
        """Unit directions (..., 3) of texture coordinates (..., 2)."""
        u, v = np.moveaxis(uv, -1, 0)
        return equirectangular.direction_from_uv(np.stack([u, v * self._part + self._top], axis=-1))


class CubeChart:
    """Texture coordinates on six faces of `face_size` px, 3 x 2 of them, each with a `border` round it [px].

    >>> chart = CubeChart(4, 2)
    >>> chart.uv(np.array([[[1.0, 1, 1], [1, -1, 1], [1, 1, -1]]]))[0].round(3).tolist()
    [[0.083, 0.125], [0.25, 0.125], [0.083, 0.375]]
    """

    planes = np.array([[1, -1, 0], [1, 1, 0], [1, 0, -1], [1, 0, 1], [0, 1, -1], [0, 1, 1]], dtype=float)
    """Normals (n, 3) of the planes through the origin in which the edges of the cube lie."""

    def __init__(self, face_size: int, border: int):
        self.pixels_per_radian = 2 * face_size / np.pi
        self._face = face_size, border, face_size + 2 * border

    def texels(self, layer: Layer, values: np.ndarray) -> np.ndarray:
        """The texture (h, w, ...) that values (H, W, ...) of the layer's map give: borders go on beyond
        faces."""
        _, _, whole = self._face
        u, v = ((np.arange(count * whole) + 0.5) / (count * whole) for count in (3, 2))
        return sampled(layer, values, self.direction(np.stack(np.meshgrid(u, v), axis=-1)))

    def uv(self, rays: np.ndarray) -> np.ndarray:
        """(n, k, 2) of the corners of triangles (k = 3), or of sides (k = 2), in the directions (n, k, 3).

        Raises: ValueError for a triangle that lies on more than one face.
        """
        fits, column, row, s, t = _on_faces(rays)
        if not fits.all():
            number = int(np.argmin(fits))
            raise ValueError(f"triangle {number} lies on several faces of the cube: it must be cut there")
        size, border, whole = self._face
        u, v = (
            (place[:, None] * whole + border + (coordinate + 1) / 2 * size) / (count * whole)
            for place, coordinate, count in ((column, s, 3), (row, t, 2))
        )
        return np.stack([u, v], axis=-1)

    def fits(self, rays: np.ndarray) -> np.ndarray:
        """Whether triangles with corners in the directions (n, 3, 3) lie on one face."""
        return _on_faces(rays)[0]

    def direction(self, uv: np.ndarray) -> np.ndarray:
        """Unit directions (..., 3) of texture coordinates (..., 2)."""
        size, border, whole = self._face
        place = np.floor(uv * (3, 2)).clip(0, (2, 1))
        st = ((uv * (3, 2) - place) * whole - border) / size * 2 - 1
        face = (3 * place[..., 1] + place[..., 0]).astype(np.int64)
        point = cube_map.point_on_face(face, st[..., 0], st[..., 1])
        return point / np.linalg.norm(point, axis=-1, keepdims=True)


def shared_vertices(triangles: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One vertex for all corners that are one point (triangles (T, 3)) with one texture coordinate (T, 3, 2).

    -> point (n,) of each such vertex, its coordinates (n, 2), and the triangles (T, 3) of these vertices.

    >>> point, uv, triangles = shared_vertices(
    ...     np.array([[0, 1, 2], [0, 2, 3]]),
    ...     np.array([[[1, 0], [0, 1], [1, 1]], [[0, 0], [1, 1], [1, 0]]]),
    ... )
    >>> point.tolist(), triangles.tolist()
    ([0, 0, 1, 2, 3], [[1, 2, 3], [0, 3, 4]])
    """
    # Modulo 4: the coordinates of one point are less than that apart.
    u, v = np.rint(uv.reshape(-1, 2) * _STEPS).astype(np.int64).T % (4 * _STEPS)
    key = (triangles.reshape(-1).astype(np.int64) * (4 * _STEPS) + u) * (4 * _STEPS) + v
    _, first, which = np.unique(key, return_index=True, return_inverse=True)
    return triangles.reshape(-1)[first], uv.reshape(-1, 2)[first], which.reshape(-1, 3)


def _on_faces(rays):
    """Of triangles (n, k, 3): whether each lies on the face of its middle; column and row of that face, (n,);
    and where on it its corners are, s to the right and t down, (n, k).
    """
    rays = np.asarray(rays, dtype=np.float64)
    middle = cube_map.uv_from_direction(rays.sum(axis=1)) * (3, 2)
    column, row = np.floor(middle).astype(np.int64).T
    forward, right, down = _axes(3 * row + column)
    along = np.einsum("nck,nk->nc", rays, forward)
    with np.errstate(divide="ignore", invalid="ignore"):  # far beyond the face
        s, t = (np.einsum("nck,nk->nc", rays, axis) / along for axis in (right, down))
    off = (along <= 0) | (np.maximum(np.abs(s), np.abs(t)) > 1 + _OFF_FACE)
    return ~off.any(axis=1), column, row, s, t


def _axes(face):
    """Forward, right and down (n, 3) each, of faces (n,)."""
    none, one = np.zeros(len(face)), np.ones(len(face))
    forward = cube_map.point_on_face(face, none, none)
    right = cube_map.point_on_face(face, one, none) - forward
    return forward, right, cube_map.point_on_face(face, none, one) - forward
