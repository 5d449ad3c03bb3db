"""Wavefront OBJ with its materials (.mtl) and a PNG texture for each layer.

In the world, y up as most programs take an OBJ to be: our (x, y, z) is written as (x, z, -y), which Blender's
importer turns back. OBJ has no unlit materials: the texture is the diffuse colour (map_Kd).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...images import replacing
from ..panorama import LayeredPanorama
from .gltf import Y_UP
from .pieces import Piece

_ROWS = 1 << 16  # lines that are put together at once


def write_obj(path, panorama: LayeredPanorama, pieces: list[Piece]) -> tuple[list[Path], list[int]]:
    """Write pieces as `path`, the .mtl file of the same name and textures beside them.

    -> these files, and the bytes of each piece's geometry. The textures are written first and the .obj last,
    each all or nothing.
    """
    path = Path(path)
    materials, textures = path.with_suffix(".mtl"), _write_textures(path, pieces)
    text = "\n".join(map(_material, range(len(pieces)), pieces, textures))
    with replacing(materials) as temporary:
        temporary.write_text(text, encoding="utf-8")
    sizes, first = [], 1
    with replacing(path) as temporary, open(temporary, "wb") as file:
        file.write(f"mtllib {materials.name}\n".encode())
        for number, piece in enumerate(pieces):
            start = file.tell()
            _write_piece(file, number, piece, panorama, first)
            first += len(piece.points)
            sizes.append(file.tell() - start)
    return [*dict.fromkeys(textures), materials, path], sizes


def _write_textures(path, pieces):
    """The texture's path for each piece; pieces of one layer share one."""
    written = {}
    for number, piece in enumerate(pieces):
        key = id(piece.texture), piece.masked
        if key in written:
            continue
        plain = re.sub(r"[^A-Za-z0-9-]+", "_", piece.name)[:60].strip("_")
        written[key] = path.with_name(f"{path.stem}_{number}_{plain}.png")
        with replacing(written[key]) as temporary:
            temporary.write_bytes(piece.texture.png(piece.masked))
    return [written[id(piece.texture), piece.masked] for piece in pieces]


def _material(number, piece, texture):
    lines = [f"newmtl {_name(number, piece)}", "Kd 1 1 1", "Ks 0 0 0", "illum 1", f"map_Kd {texture.name}"]
    if piece.masked:
        lines.append(f"map_d -imfchan m {texture.name}")
    return "\n".join(lines) + "\n"


def _write_piece(file, number, piece, panorama, first):
    world = world_points(piece.points, panorama) @ Y_UP.T
    uv = np.column_stack([piece.uv[:, 0], 1 - piece.uv[:, 1]])  # v from the bottom edge
    name = _name(number, piece)
    file.write(f"o {name}\nusemtl {name}\n".encode())
    _write_rows(file, b"v %.7g %.7g %.7g\n", world)
    _write_rows(file, b"vt %.7g %.7g\n", uv)
    corners = np.repeat(piece.triangles.astype(np.int64) + first, 2, axis=1)
    _write_rows(file, b"f %d/%d %d/%d %d/%d\n", corners)


def _write_rows(file, line, values):
    for start in range(0, len(values), _ROWS):
        rows = values[start : start + _ROWS]
        file.write(line * len(rows) % tuple(rows.ravel().tolist()))


def _name(number, piece):
    """Without blanks, which end a name."""
    return f"{number}_" + re.sub(r"\s+", "_", piece.name)


def world_points(points: np.ndarray, panorama: LayeredPanorama) -> np.ndarray:
    """Points (n, 3) of the panorama's frame in the world [m], float64."""
    rotation = np.asarray(panorama.world_from_panorama, dtype=np.float64)
    return points.astype(np.float64) @ rotation.T + np.asarray(panorama.origin, dtype=np.float64)
