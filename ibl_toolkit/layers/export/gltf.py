"""glTF 2.0 in one file (.glb): unlit, textured meshes below a node that is the panorama's origin.

Source: Khronos, "glTF 2.0 Specification", ISO/IEC 12113:2022, and the extension KHR_materials_unlit.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from ...glb import FLOAT, VERTICES, Y_UP, GlbBinary, glb_bytes
from ...images import replacing
from ..panorama import LayeredPanorama
from .pieces import Piece

UNLIT = "KHR_materials_unlit"
_LINEAR, _MIPMAPS, _REPEAT, _CLAMP = 9729, 9987, 10497, 33071
_CUTOFF = 0.5


def write_glb(path, panorama: LayeredPanorama, pieces: list[Piece], exposure: float):
    """Write pieces as a .glb file, all or nothing.

    Colours are 8-bit sRGB of the radiance times `exposure`; each material says so in its extras, so that
    radiance can be had back up to where it was clipped: colour (linear) / exposure.
    """
    binary = GlbBinary()
    meshes = [_mesh(piece, number, binary) for number, piece in enumerate(pieces)]
    materials, textures, images = _materials(pieces, exposure, binary)
    first = 1  # node 0 is the panorama's
    nodes = [{"name": piece.name, "mesh": number} for number, piece in enumerate(pieces)]
    document = {
        "asset": {"version": "2.0", "generator": "Expanded Panoramas"},
        "extensionsUsed": [UNLIT],
        "scene": 0,
        "scenes": [{"name": "Panorama", "nodes": [0]}],
        "nodes": [_root(panorama, list(range(first, first + len(nodes)))), *nodes],
        "meshes": meshes,
        "materials": materials,
        "textures": textures,
        "samplers": [
            {"magFilter": _LINEAR, "minFilter": _MIPMAPS, "wrapS": _REPEAT, "wrapT": _CLAMP},
        ],
        "images": images,
    }
    with replacing(Path(path)) as temporary:
        temporary.write_bytes(glb_bytes(document, binary))


def _mesh(piece, material, binary):
    position = binary.add_vectors(piece.points, with_bounds=True)
    uv = binary.add_array(piece.uv.astype("<f4"), "VEC2", FLOAT, VERTICES)
    triangles = binary.add_triangles(piece.triangles)
    primitive = {
        "attributes": {"POSITION": position, "TEXCOORD_0": uv},
        "indices": triangles,
        "material": material,
    }
    return {"name": piece.name, "primitives": [primitive]}


def _materials(pieces, exposure, binary):
    """Materials, one a piece; textures and images, one for each that differs."""
    materials, numbers, images = [], {}, []
    for piece in pieces:
        key = id(piece.texture), piece.masked
        if key not in numbers:
            numbers[key] = len(images)
            view = binary.add_bytes(piece.texture.png(piece.masked))
            images.append({"name": piece.texture.name, "bufferView": view, "mimeType": "image/png"})
        material = {
            "name": piece.name,
            "pbrMetallicRoughness": {
                "baseColorTexture": {"index": numbers[key]},
                "metallicFactor": 0,
                "roughnessFactor": 1,
            },
            "extensions": {UNLIT: {}},
            "extras": {"exposure": exposure},
        }
        if piece.masked:
            material |= {"alphaMode": "MASK", "alphaCutoff": _CUTOFF}
        if piece.two_sided:
            material["doubleSided"] = True
        materials.append(material)
    return materials, [{"sampler": 0, "source": k} for k in range(len(images))], images


def _root(panorama, children):
    rotation = Y_UP @ np.asarray(panorama.world_from_panorama, dtype=np.float64) @ Y_UP.T
    node = {"name": "Panorama", "children": children, "extras": {"radius": float(panorama.radius)}}
    quaternion = _quaternion(rotation)
    if not np.allclose(quaternion, (0, 0, 0, 1), atol=1e-9):
        node["rotation"] = quaternion.tolist()
    origin = Y_UP @ np.asarray(panorama.origin, dtype=np.float64)
    if origin.any():
        node["translation"] = (origin + 0.0).tolist()
    return node


def _quaternion(rotation):
    """(x, y, z, w) of a rotation (3, 3)."""
    axis = cv2.Rodrigues(rotation)[0][:, 0]
    angle = float(np.linalg.norm(axis))
    vector = axis / angle * np.sin(angle / 2) if angle else axis
    quaternion = np.array([*vector, np.cos(angle / 2)])
    return quaternion / np.linalg.norm(quaternion)
