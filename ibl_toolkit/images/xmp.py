"""XMP packets in JPEG and PNG files.

Source: Adobe, "XMP Specification Part 3: Storage in Files", sections 1.1.3 (JPEG: a marker segment APP1) and
1.1.5 (PNG: a chunk iTXt).
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

from .errors import ImageError
from .photo_sphere import LARGEST, PhotoSphere, sphere_from_xmp

_JPEG, _PNG = b"\xff\xd8", b"\x89PNG\r\n\x1a\n"
_APP0, _APP1, _SCAN = 0xE0, 0xE1, 0xDA
_NAMESPACE = b"http://ns.adobe.com/xap/1.0/\0"
_KEYWORD = b"XML:com.adobe.xmp\0"
_PLAIN = b"\0\0\0\0"  # not compressed; no language, no translated keyword


def read_photo_sphere(path) -> PhotoSphere | None:
    """What a JPEG or PNG file says of the panorama that it holds; None if nothing. Decodes no pixels.

    Raises: ImageError naming the file, for another format, a damaged one, and XMP that is not sound; OSError.
    """
    data = Path(path).read_bytes()
    try:
        packet = _packet_in(data)
        return None if packet is None else sphere_from_xmp(packet)
    except ImageError as error:
        raise ImageError(f"{path}: {error}") from error


def with_photo_sphere(data: bytes, sphere: PhotoSphere) -> bytes:
    """A JPEG or PNG file, as its encoder made it, with XMP that tells of the panorama.

    Raises: ImageError for another format.
    """
    packet = sphere.to_xmp()
    if data.startswith(_JPEG):
        at = 2
        if data[3] == _APP0:  # JFIF wants to be the first
            at += 2 + struct.unpack(">H", data[4:6])[0]
        content = _NAMESPACE + packet
        segment = struct.pack(">BBH", 0xFF, _APP1, 2 + len(content)) + content
        return data[:at] + segment + data[at:]
    if data.startswith(_PNG):
        at = len(_PNG) + 12 + struct.unpack(">I", data[8:12])[0]  # after the header, IHDR
        content = b"iTXt" + _KEYWORD + _PLAIN + packet
        chunk = struct.pack(">I", len(content) - 4) + content + struct.pack(">I", zlib.crc32(content))
        return data[:at] + chunk + data[at:]
    raise ImageError(f"neither JPEG nor PNG: it starts with {data[:8]!r}")


def _packet_in(data):
    if data.startswith(_JPEG):
        return _in_jpeg(data)
    if data.startswith(_PNG):
        return _in_png(data)
    raise ImageError(f"neither JPEG nor PNG: it starts with {data[:8]!r}")


def _in_jpeg(data):
    at = 2
    while at + 4 <= len(data):
        start, marker, length = struct.unpack(">BBH", data[at : at + 4])
        if start != 0xFF or length < 2:
            raise ImageError(f"damaged: no marker at byte {at}")
        if marker == _SCAN:
            return None
        content = data[at + 4 : at + 2 + length]
        if marker == _APP1 and content.startswith(_NAMESPACE):
            return content[len(_NAMESPACE) :]
        at += 2 + length
    raise ImageError(f"truncated: {len(data)} bytes, without a scan")


def _in_png(data):
    at = len(_PNG)
    while at + 12 <= len(data):
        length, name = struct.unpack(">I4s", data[at : at + 8])
        content = data[at + 8 : at + 8 + length]
        if name == b"iTXt" and content.startswith(_KEYWORD):
            return _text_of(content[len(_KEYWORD) :])
        if name == b"IEND":
            return None
        at += 12 + length
    raise ImageError(f"truncated: {len(data)} bytes, without an end")


def _text_of(content):
    """What follows an iTXt chunk's keyword: flag and method of compression, language, translation, text."""
    text = content[2:].partition(b"\0")[2].partition(b"\0")[2]
    if content[:1] != b"\1":
        return text
    try:
        return zlib.decompressobj().decompress(text, LARGEST + 1)
    except zlib.error as error:
        raise ImageError(f"damaged: its compressed XMP: {error}") from error
