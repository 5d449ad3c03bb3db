"""glTF 2.0 in one file (.glb): unlit, textured meshes below a node that is the panorama's origin.

glTF is y up: our (x, y, z) becomes (x, z, -y), so that a program that is z up, as Blender is, has our axes
again.

Source: Khronos, "glTF 2.0 Specification", ISO/IEC 12113:2022, and the extension KHR_materials_unlit.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path

import cv2
import numpy as np

from ...images import replacing
from ..panorama import LayeredPanorama
from .pieces import Piece

UNLIT = "KHR_materials_unlit"
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
"""Leads from z up to y up."""
_FLOAT, _UINT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963  # targets of buffer views
_LINEAR, _MIPMAPS, _REPEAT, _CLAMP = 9729, 9987, 10497, 33071
_CUTOFF = 0.5


def write_glb(path, panorama: LayeredPanorama, pieces: list[Piece], exposure: float):
    """Write pieces as a .glb file, all or nothing.

    Colours are 8-bit sRGB of the radiance times `exposure`; each material says so in its extras, so that
    radiance can be had back up to where it was clipped: colour (linear) / exposure.
    """
    binary = _Binary()
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
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.data)}],
    }
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    with replacing(Path(path)) as temporary:
        temporary.write_bytes(_container(text, bytes(binary.data)))


class _Binary:
    """The binary part of the file, and what says where each array is in it."""

    def __init__(self):
        self.data, self.views, self.accessors = bytearray(), [], []

    def add_bytes(self, content, target=None):
        """A view of bytes, its number; each begins at a multiple of 4."""
        self.data.extend(bytes(-len(self.data) % 4))
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content)}
        self.views.append(view if target is None else {**view, "target": target})
        self.data.extend(content)
        return len(self.views) - 1

    def add_array(self, values, kind, component, target, with_bounds=False):
        """An accessor of an array, its number."""
        accessor = {"componentType": component, "count": len(values), "type": kind}
        if with_bounds:
            accessor |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        accessor["bufferView"] = self.add_bytes(np.ascontiguousarray(values).tobytes(), target)
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _mesh(piece, material, binary):
    points = (piece.points @ Y_UP.T).astype("<f4") + np.float32(
        0
    )  # no -0.0, which a JSON reader may not keep
    position = binary.add_array(points, "VEC3", _FLOAT, _VERTICES, with_bounds=True)
    uv = binary.add_array(piece.uv.astype("<f4"), "VEC2", _FLOAT, _VERTICES)
    triangles = binary.add_array(piece.triangles.astype("<u4").reshape(-1), "SCALAR", _UINT, _INDICES)
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


def _container(text, binary):
    """The chunks of a .glb file, each filled up to a multiple of 4 bytes."""
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    length = 12 + 8 + len(text) + 8 + len(binary)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, length),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(binary), b"BIN\0"),
            binary,
        ]
    )
