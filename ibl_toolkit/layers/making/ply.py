"""Points and their colours in from a PLY file, ascii or binary.

Source: the format as G. Turk describes it ("The PLY Polygon File Format", 1994).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...images.png import linear_from_srgb
from ..errors import LayersError

_HEADER_BYTES = 1 << 16
_FORMATS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
DEFAULT_MAX_POINTS = 1 << 28


@dataclass(frozen=True, eq=False)
class PointCloud:
    """points: (n, 3) float64, in the file's frame and unit. colours: (n, 3) float32, linear."""

    points: np.ndarray
    colours: np.ndarray


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list  # (name, numpy type); None for a list


def read_ply(path, *, max_points=DEFAULT_MAX_POINTS) -> PointCloud:
    """The vertices x y z and red green blue of a PLY file; other elements and properties are passed over.

    Colours of type uchar are taken for sRGB and made linear; float and double ones are linear as they are.

    Raises: LayersError naming the file and what would be right: for what is no PLY, a header that is too long
    or not understood, vertices without these six properties, with lists, or behind an element with lists, of
    colours of another type, fewer or more than can be, and for a file that ends too soon; OSError.
    """
    path = Path(path)
    data = path.read_bytes()
    try:
        order, elements, start = _header(data)
        vertex = _vertex(elements, max_points)
        before = elements[: elements.index(vertex)]
        values = _ascii if order is None else _binary
        columns = values(data, start, before, vertex, order)
        return PointCloud(_points(columns), _colours(columns))
    except LayersError as error:
        raise LayersError(f"{path}: {error}") from None


def _header(data):
    """Byte order, elements, and where the data begin."""
    end = data.find(b"end_header", 0, _HEADER_BYTES)
    if not data.startswith((b"ply\n", b"ply\r")):
        raise LayersError("is no PLY file: must begin with a line 'ply'")
    if end < 0 or b"\n" not in data[end : end + 16]:
        raise LayersError(f"no line 'end_header' in the first {_HEADER_BYTES} bytes")
    order, elements = "", []
    for line in data[:end].decode("latin-1").splitlines()[1:]:
        words = line.split()
        if words[:1] == ["format"] and len(words) == 3 and words[1] in _FORMATS:
            order = _FORMATS[words[1]]
        elif words[:1] == ["element"] and len(words) == 3 and words[2].isdecimal():
            _refuse_more_than(len(data), words)
            elements.append(_Element(words[1], int(words[2]), []))
        elif words[:1] == ["property"] and elements and _property(words) is not None:
            elements[-1].properties.append(_property(words))
        elif words and words[0] not in ("comment", "obj_info"):
            raise LayersError(f"line '{line[:80]}' of its header is not understood")
    if order == "":
        raise LayersError(f"its header has no format: must be one of {', '.join(_FORMATS)}")
    return order, elements, data.index(b"\n", end) + 1


def _refuse_more_than(most, words):
    """Each of an element's things takes a byte or more, in either kind of file; digits are counted first,
    since Python reads no number of thousands of them."""
    if len(words[2].lstrip("0")) > len(str(most)) or int(words[2]) > most:
        raise LayersError(
            f"its header tells of {words[2][:20]} of element '{words[1][:80]}', more than its {most} bytes "
            "can hold"
        )


def _property(words):
    if len(words) == 5 and words[1] == "list" and words[2] in _TYPES and words[3] in _TYPES:
        return words[4], None
    return (words[2], _TYPES[words[1]]) if len(words) == 3 and words[1] in _TYPES else None


def _vertex(elements, max_points):
    vertex = next((element for element in elements if element.name == "vertex"), None)
    if vertex is None:
        raise LayersError("has no element 'vertex'")
    names = [name for name, _ in vertex.properties]
    missing = [name for name in ("x", "y", "z", "red", "green", "blue") if name not in names]
    if missing:
        raise LayersError(f"its vertices have no {', '.join(missing)}: must have x y z and red green blue")
    if len(set(names)) < len(names) or any(kind is None for _, kind in vertex.properties):
        raise LayersError("its vertices have a list, or two properties of one name: must have neither")
    if not 1 <= vertex.count <= max_points:
        raise LayersError(f"has {vertex.count} vertices, must have 1 to {max_points}")
    return vertex


def _binary(data, start, before, vertex, order):
    for element in before:
        start += element.count * _record(element, order).itemsize
    record = _record(vertex, order)
    if start + vertex.count * record.itemsize > len(data):
        there = max(len(data) - start, 0) // record.itemsize
        raise LayersError(f"ends after {there} vertices, its header tells of {vertex.count}")
    return np.frombuffer(data, record, vertex.count, start)


def _record(element, order):
    if any(kind is None for _, kind in element.properties):
        raise LayersError(f"element '{element.name}' with lists is before the vertices: must be behind them")
    return np.dtype(
        [
            (f"{number}" if element.name != "vertex" else name, order + kind)
            for number, (name, kind) in enumerate(element.properties)
        ]
    )


def _ascii(data, start, before, vertex, _order):
    skipped = sum(element.count for element in before)
    lines = data[start:].split(b"\n", skipped + vertex.count)[skipped : skipped + vertex.count]
    words = b" ".join(lines).split()
    width = len(vertex.properties)
    if len(words) != vertex.count * width:
        raise LayersError(
            f"has {len(words)} numbers of vertices, its header tells of {vertex.count} times {width}"
        )
    try:
        table = np.array(words, dtype=np.float64).reshape(vertex.count, width)
    except ValueError as error:
        raise LayersError(f"a number of its vertices can't be read: {error}") from None
    return {name: (table[:, k].astype(kind)) for k, (name, kind) in enumerate(vertex.properties)}


def _points(columns):
    return np.stack([columns[name].astype(np.float64) for name in "xyz"], axis=1)


def _colours(columns):
    channels = [columns[name] for name in ("red", "green", "blue")]
    kinds = {channel.dtype.kind + str(channel.dtype.itemsize) for channel in channels}
    if kinds == {"u1"}:
        return linear_from_srgb(np.stack(channels, axis=1).astype(np.float32) / 255)
    if kinds <= {"f4", "f8"}:
        return np.stack(channels, axis=1).astype(np.float32)
    raise LayersError("its colours are neither all uchar nor all float or double")
