"""A layered panorama as a file of another program: which format, which surface, and how large it became."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...images import exposure_for
from ..panorama import LayeredPanorama
from .gltf import write_glb
from .obj import write_obj
from .pieces import MESHES, TEXTURE_ERROR_PX, pieces_of
from .ply import bytes_of, points_of_piece, points_of_pixels, write_ply

POINTS = "points"
SURFACES = (*MESHES, POINTS)
FORMATS = {".glb": "mesh", ".obj": "quadtree", ".ply": POINTS}
"""By their suffixes, and the surface of each: that with the fewest triangles needs transparency, which only
the first of them is sure to have."""
_ROWS = 512


@dataclass(frozen=True)
class ExportedLayer:
    """bytes: of its geometry and, where it has one of its own, its texture, as they are stored."""

    name: str
    vertices: int
    triangles: int
    bytes: int


@dataclass(frozen=True)
class Exported:
    """What was written: the layers, the factor that radiance was multiplied with, the files.

    clipped: share of the layers' pixels that are brighter than what 8 bits hold then, 0 to 1.
    """

    layers: tuple[ExportedLayer, ...]
    exposure: float
    files: tuple[Path, ...]
    clipped: float


def export_layers(
    panorama: LayeredPanorama,
    path,
    *,
    surface: str | None = None,
    exposure: float | None = None,
    far: float | None = None,
    texture_error_px: float = TEXTURE_ERROR_PX,
) -> Exported:
    """Write the layers as `path`: .glb, .obj (with .mtl and textures beside it), or .ply.

    surface: of SURFACES; that of FORMATS if None.
    exposure: what radiance is multiplied with before it is clipped to 8 bits; if None, so that the median of
    all layers becomes mid grey. far: radius [m] of the sphere that stands for infinity, see
    `pieces.far_radius`. texture_error_px: by how many pixels a texture may be off in the middle of a
    triangle's side.

    Raises: ValueError for another suffix or surface, points in a file that isn't .ply, a surface in a .ply
    that goes beyond a layer's domain, an exposure that is not finite and above 0, and what `pieces_of`
    refuses; OSError.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    _refuse_other(path, suffix, surface, exposure)
    surface = surface or FORMATS[suffix]
    exposure = exposure or exposure_of(panorama)
    if surface == POINTS:
        return _write_ply(path, panorama, points_of_pixels(panorama, exposure, far), exposure)
    pieces = pieces_of(panorama, exposure, MESHES[surface], far, texture_error_px)
    if suffix == ".ply":
        _refuse_masked(path, pieces, surface)
        return _write_ply(path, panorama, [points_of_piece(piece) for piece in pieces], exposure)
    if suffix == ".obj":
        files, sizes = write_obj(path, panorama, pieces)
    else:
        write_glb(path, panorama, pieces, exposure)
        files = [path]
        sizes = [piece.points.nbytes + piece.uv.nbytes + piece.triangles.nbytes for piece in pieces]
    written = tuple(map(_textured, pieces, sizes, _first_uses(pieces)))
    return Exported(written, exposure, tuple(files), clipped_share(panorama, exposure))


def exposure_of(panorama: LayeredPanorama) -> float:
    """The factor that brings the median luminance of all layers' domains to mid grey."""
    shown = [np.zeros((0, 3), np.float32)]
    for layer in panorama.layers:
        if layer.radiance is not None:
            some = (slice(None, None, max(1, layer.size[1] // _ROWS)),) * 2  # a median needs no more
            shown.append(layer.radiance[some][layer.mask[some]])
    return exposure_for(np.concatenate(shown)[None])


def clipped_share(panorama: LayeredPanorama, exposure: float) -> float:
    """Share of the layers' pixels of which radiance times `exposure` is above 1 in any colour."""
    inside = [layer.radiance[layer.mask].max(axis=1) for layer in panorama.layers]
    clipped = sum(np.count_nonzero(brightest * exposure > 1) for brightest in inside)
    return clipped / sum(map(len, inside))


def _write_ply(path, panorama, parts, exposure):
    write_ply(path, panorama, parts)
    sizes = [(len(part.points), len(part.triangles)) for part in parts]
    layers = [
        ExportedLayer(part.name, *size, bytes_of(*size)) for part, size in zip(parts, sizes, strict=True)
    ]
    return Exported(tuple(layers), exposure, (path,), clipped_share(panorama, exposure))


def _textured(piece, size, has_texture):
    texture = len(piece.texture.png(piece.masked)) if has_texture else 0
    return ExportedLayer(piece.name, len(piece.points), len(piece.triangles), size + texture)


def _first_uses(pieces):
    """Whether each piece is the first with its texture, and so the one that it counts with."""
    keys = [(id(piece.texture), piece.masked) for piece in pieces]
    return [keys.index(key) == number for number, key in enumerate(keys)]


def _refuse_other(path, suffix, surface, exposure):
    if suffix not in FORMATS:
        raise ValueError(f"{path}: must end in {', '.join(FORMATS)}")
    if surface is not None and surface not in SURFACES:
        raise ValueError(f"surface '{surface}' must be one of {', '.join(SURFACES)}")
    if surface == POINTS and suffix != ".ply":
        raise ValueError(f"{path}: points can be written as .ply only, not as {suffix}")
    if exposure is not None and not 0 < exposure < np.inf:
        raise ValueError(f"exposure {exposure} must be finite and above 0")


def _refuse_masked(path, pieces, surface):
    masked = next((piece.name for piece in pieces if piece.masked), None)
    if masked is not None:
        others = ", ".join(name for name in SURFACES if name != surface)
        raise ValueError(
            f"{path}: the surface '{surface}' of layer '{masked}' goes beyond its domain, which a .ply "
            f"cannot cut off; take {others}"
        )
