"""The container of glTF 2.0 in one file (.glb): its arrays, its two chunks, and its axes.

glTF is y up: our (x, y, z) becomes (x, z, -y), so that a program that is z up, as Blender is, has our axes
again.

Source: Khronos, "glTF 2.0 Specification", ISO/IEC 12113:2022.
"""

import json
import struct

import numpy as np

Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
"""Leads from z up to y up."""
FLOAT, UINT = 5126, 5125
VERTICES, INDICES = 34962, 34963  # targets of buffer views


class GlbBinary:
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

    def add_vectors(self, vectors, with_bounds=False):
        """An accessor of points or directions (n, 3) in our axes, its number."""
        turned = (vectors @ Y_UP.T).astype("<f4") + np.float32(0)  # no -0.0, which a JSON reader may not keep
        return self.add_array(turned, "VEC3", FLOAT, VERTICES, with_bounds)

    def add_triangles(self, triangles):
        """An accessor of the corners' numbers of triangles (T, 3), its number."""
        return self.add_array(triangles.astype("<u4").reshape(-1), "SCALAR", UINT, INDICES)


def glb_bytes(document: dict, binary: GlbBinary) -> bytes:
    """A .glb file: the document, to which what is in the binary part is added, and that part."""
    document = {
        **document,
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.data)}],
    }
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    return _container(text, bytes(binary.data))


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
