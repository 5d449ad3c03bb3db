"""PLY, binary, with a colour for each vertex: the pixels as points, or meshes.

In the world, z up, as it is usual of point clouds and as Blender's importer takes it.

Source: G. Turk, "The PLY Polygon File Format", 1994.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ... import cube_map, equirectangular
from ...images import replacing
from ...images.png import srgb_codes
from ..panorama import CUBE_MAP, LayeredPanorama
from .obj import world_points
from .pieces import Piece, checked_far, parts_of

_VERTEX = np.dtype([("place", "<f4", 3), ("colour", "u1", 3)])
_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])


@dataclass(frozen=True, eq=False)
class Points:
    """What one layer gives to a PLY file, in the panorama's frame.

    points: (n, 3) [m]; colours: (n, 3) uint8, sRGB; triangles: (T, 3), none in a cloud of points.
    """

    name: str
    points: np.ndarray
    colours: np.ndarray
    triangles: np.ndarray


def points_of_pixels(panorama: LayeredPanorama, exposure: float, far: float | None = None) -> list[Points]:
    """A point for each pixel of each layer's domain; what lies at infinity at `far` [m], as in `pieces_of`.

    Raises: ValueError for a layer without radiance, and a `far` nearer than a surface.
    """
    far, clouds = checked_far(panorama, far), []
    for layer in panorama.layers:
        if layer.radiance is None:
            raise ValueError(f"{layer} has no radiance, so its points have no colour")
        width, height = layer.size
        if layer.mapping == CUBE_MAP:
            directions = cube_map.pixel_directions(width // 3)
        else:
            directions = equirectangular.pixel_directions(width, height)
        for part in parts_of(layer, far):
            inside = part.mask
            points = directions[inside] * part.depth[inside][:, None]
            colours = srgb_codes(layer.radiance[inside], exposure)
            clouds.append(Points(part.name, points, colours, np.empty((0, 3), np.uint32)))
    return clouds


def points_of_piece(piece: Piece) -> Points:
    """The mesh of a piece with its texture at the vertices."""
    return Points(piece.name, piece.points, _looked_up(piece.texture.pixels, piece.uv), piece.triangles)


def write_ply(path, panorama: LayeredPanorama, parts: list[Points]):
    """Write all parts as one PLY file, all or nothing."""
    vertices = np.empty(sum(len(part.points) for part in parts), _VERTEX)
    faces = np.empty(sum(len(part.triangles) for part in parts), _FACE)
    faces["count"] = 3
    v, f = 0, 0
    for part in parts:
        here = slice(v, v + len(part.points))
        vertices["place"][here] = world_points(part.points, panorama)
        vertices["colour"][here] = part.colours
        faces["corners"][f : f + len(part.triangles)] = part.triangles.astype(np.int64) + v
        v, f = v + len(part.points), f + len(part.triangles)
    with replacing(Path(path)) as temporary, open(temporary, "wb") as file:
        file.write(_header(len(vertices), len(faces)))
        vertices.tofile(file)
        faces.tofile(file)


def bytes_of(points: int, triangles: int) -> int:
    """What so many points and triangles take in a PLY file, without its header.

    >>> bytes_of(3, 1)
    58
    """
    return points * _VERTEX.itemsize + triangles * _FACE.itemsize


def _header(vertices, faces):
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {vertices}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"property uchar {colour}" for colour in ("red", "green", "blue")]
    if faces:
        lines += [f"element face {faces}", "property list uchar int vertex_indices"]
    return "\n".join([*lines, "end_header", ""]).encode()


def _looked_up(pixels, uv):
    """Colours (n, 3) uint8 of a texture between its texels; it repeats in u."""
    height, width = pixels.shape[:2]
    place = uv.astype(np.float64) * (width, height) - 0.5
    corner = np.floor(place)
    right, down = (place - corner).T[..., None]
    i, j = corner.astype(np.int64).T

    def texel(column, row):
        return pixels[np.clip(row, 0, height - 1), column % width, :3].astype(np.float64)

    above = texel(i, j) * (1 - right) + texel(i + 1, j) * right
    below = texel(i, j + 1) * (1 - right) + texel(i + 1, j + 1) * right
    return np.round(above * (1 - down) + below * down).astype(np.uint8)
