"""The header of an OpenEXR file, read without decoding or allocating anything.

The OpenEXR library allocates what the header asks for before it finds a file too short, and reports a
truncated one by printing.  Here the header is judged first: sizes, channels, and whether the file is long
enough for its chunks.

Source: "OpenEXR File Layout", openexr.com/en/latest/OpenEXRFileLayout.html
"""

import os
import struct
from dataclasses import dataclass

import numpy as np

from .errors import ImageError

MAGIC = b"\x76\x2f\x31\x01"
_TILED, _MULTIPART = 0x200, 0x1000
UINT, HALF, FLOAT = 0, 1, 2
_PIXEL_BYTES = {UINT: 4, HALF: 2, FLOAT: 4}
_FLAT, _DEEP = (b"scanlineimage", b"tiledimage"), (b"deepscanline", b"deeptile")
# Rows per chunk of the compressions 0 to 9: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
_CHUNK_ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
_LONGEST_NAME = 256


@dataclass(frozen=True)
class ExrChannel:
    """One channel: pixel_type UINT, HALF or FLOAT; sampling (x, y) of 1 where every pixel has a value."""

    name: str
    pixel_type: int
    sampling: tuple[int, int]


@dataclass(frozen=True)
class ExrPart:
    """One part; windows are (left, top, right, bottom) [px], both ends included; no tile_size: scanlines."""

    channels: tuple[ExrChannel, ...]
    data_window: tuple[int, int, int, int]
    display_window: tuple[int, int, int, int]
    attributes: dict[str, tuple[str, bytes]]
    deep: bool
    tile_size: tuple[int, int] | None

    @property
    def pixel_count(self):
        """Number of pixels of the data window."""
        return window_width(self.data_window) * window_height(self.data_window)

    @property
    def decoded_bytes(self):
        """Bytes of all channels once decoded, or of one tile if that is larger: the decoder holds both."""
        tile_pixels = self.tile_size[0] * self.tile_size[1] if self.tile_size else 0
        return max(self.pixel_count, tile_pixels) * sum(_PIXEL_BYTES[c.pixel_type] for c in self.channels)


def window_width(window):
    """Width [px] of a window (left, top, right, bottom).

    >>> window_width((0, 0, 127, 63))
    128
    """
    return window[2] - window[0] + 1


def window_height(window):
    """Height [px] of a window (left, top, right, bottom).

    >>> window_height((0, 0, 127, 63))
    64
    """
    return window[3] - window[1] + 1


def read_header(path):
    """All parts of the file at `path`, as a tuple of ExrPart.

    Raises: ImageError if it is no OpenEXR file or ends within its header.
    """
    with open(path, "rb") as file:
        return _read_parts(file, path)[0]


def refuse_truncated(path):
    """Raise ImageError if the file ends before its last chunk does, or was never finished."""
    with open(path, "rb") as file:
        parts, multipart = _read_parts(file, path)
        length = os.fstat(file.fileno()).st_size
        tables = [_read_chunk_table(file, path, part) for part in parts]
        end = file.tell()
        for part, table in zip(parts, tables, strict=True):
            if table.size == 0:
                continue
            # A zero offset is what a writer leaves that died before it came back to fill in the table.
            if table.min() < end:
                raise ImageError(f"{path}: the file was not finished: a chunk's offset is {int(table.min())}")
            if table.max() >= length:
                raise ImageError(
                    f"{path}: truncated: {length} bytes, but a chunk starts at {int(table.max())}"
                )
            end_of_last = _chunk_end(file, path, int(table.max()), part, multipart)
            if end_of_last > length:
                raise ImageError(f"{path}: truncated: {length} bytes, must be {end_of_last} or more")


def _read_parts(file, path):
    preamble = file.read(8)
    if preamble[:4] != MAGIC:
        raise ImageError(f"{path}: not an OpenEXR file: it starts with {preamble[:4]!r}")
    if len(preamble) < 8:
        raise ImageError(f"{path}: truncated within its header, at {len(preamble)} bytes")
    flags = struct.unpack("<I", preamble[4:])[0]
    multipart = bool(flags & _MULTIPART)
    parts = []
    while attributes := _read_attributes(file, path):
        parts.append(_part(attributes, bool(flags & _TILED), path))
        if not multipart:
            break
    if not parts:
        raise ImageError(f"{path}: its header has no parts")
    return tuple(parts), multipart


def _read_attributes(file, path):
    attributes = {}
    while name := _read_name(file, path):
        kind = _read_name(file, path)
        size = struct.unpack("<i", _read_exactly(file, 4, path))[0]
        attributes[name] = (kind, _read_exactly(file, size, path))
    return attributes


def _read_name(file, path):
    start = file.tell()
    name, end, _ = file.read(_LONGEST_NAME + 1).partition(b"\0")
    if not end:
        raise ImageError(f"{path}: truncated or damaged within its header, in a name at byte {start}")
    file.seek(start + len(name) + 1)
    return name.decode("utf-8", "replace")


def _read_exactly(file, size, path):
    left = os.fstat(file.fileno()).st_size - file.tell()
    if not 0 <= size <= left:
        raise ImageError(f"{path}: truncated within its header: {size} bytes wanted where {left} are left")
    return file.read(size)


def _part(attributes, tiled, path):
    for name in ("channels", "dataWindow", "displayWindow", "compression"):
        if name not in attributes:
            raise ImageError(f"{path}: damaged header: it has no {name}")
    if len(attributes["compression"][1]) != 1 or len(attributes.get("chunkCount", ("", bytes(4)))[1]) != 4:
        raise ImageError(f"{path}: damaged header: its compression or its count of chunks has a wrong size")
    kind = attributes.get("type", ("", b""))[1].rstrip(b"\0")
    windows = [_window(attributes[name][1], name, path) for name in ("dataWindow", "displayWindow")]
    if kind not in (b"", *_FLAT, *_DEEP):
        raise ImageError(f"{path}: damaged header: type {kind!r}, must be one of {(*_FLAT, *_DEEP)}")
    tiled = kind == b"tiledimage" if kind else tiled
    channels = tuple(_channels(attributes["channels"][1], path))
    return ExrPart(
        channels, *windows, attributes, kind in _DEEP, _tile_size(attributes, path) if tiled else None
    )


def _tile_size(attributes, path):
    value = attributes.get("tiles", ("", b""))[1]
    if len(value) != 9:
        raise ImageError(f"{path}: damaged header: tiled, but without a description of its tiles")
    width, height, _ = struct.unpack("<2IB", value)
    if width < 1 or height < 1:
        raise ImageError(f"{path}: damaged header: tiles of {width} x {height} px")
    return width, height


def _window(value, name, path):
    if len(value) != 16:
        raise ImageError(f"{path}: damaged header: {name} has {len(value)} bytes, must be 16")
    window = struct.unpack("<4i", value)
    if window_width(window) < 1 or window_height(window) < 1:
        raise ImageError(f"{path}: damaged header: {name} {window} is empty")
    return window


def _channels(value, path):
    start = 0
    while start < len(value) and value[start : start + 1] != b"\0":
        end = value.find(b"\0", start)
        if end < 0 or end + 17 > len(value):
            raise ImageError(f"{path}: damaged header: its list of channels ends within a channel")
        pixel_type, _, x, y = struct.unpack_from("<iI2i", value, end + 1)
        if pixel_type not in _PIXEL_BYTES:
            raise ImageError(
                f"{path}: damaged header: a channel has pixel type {pixel_type}, must be 0, 1 or 2"
            )
        yield ExrChannel(value[start:end].decode("utf-8", "replace"), pixel_type, (x, y))
        start = end + 17


def _read_chunk_table(file, path, part):
    count = _chunk_count(part)
    return np.frombuffer(_read_exactly(file, 8 * count, path), dtype="<u8")


def _chunk_count(part):
    if "chunkCount" in part.attributes:
        return max(0, struct.unpack("<i", part.attributes["chunkCount"][1])[0])
    width, height = window_width(part.data_window), window_height(part.data_window)
    if not part.tile_size:
        compression = part.attributes["compression"][1][0]
        # Of a compression newer than this list, leave the check to the library.
        return -(-height // _CHUNK_ROWS[compression]) if compression < len(_CHUNK_ROWS) else 0
    # The finest level's tiles come first; coarser ones are not read.
    return -(-width // part.tile_size[0]) * -(-height // part.tile_size[1])


def _chunk_end(file, path, offset, part, multipart):
    # part number (multipart only), then y, or tile x, y and levels; then the size of what follows
    leader = 4 * (multipart + (4 if part.tile_size else 1))
    file.seek(offset + leader)
    size = file.read(4)
    if len(size) < 4:
        return offset + leader + 5
    return offset + leader + 4 + max(0, struct.unpack("<i", size)[0])
