"""What a photo-sphere viewer is told of a panorama: its projection, its size, and how the camera was held.

Source: Google, "Photo Sphere XMP Metadata", namespace GPano.
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

import numpy as np

from .errors import ImageError

_GPANO = "http://ns.google.com/photos/1.0/panorama/"
LARGEST = 1 << 20
"""Bytes of an XMP packet that is read."""
_SIZES = (
    "FullPanoWidthPixels",
    "FullPanoHeightPixels",
    "CroppedAreaImageWidthPixels",
    "CroppedAreaImageHeightPixels",
    "CroppedAreaLeftPixels",
    "CroppedAreaTopPixels",
)
_UPRIGHT = 1e-9  # a cosine
_POSE = ("PoseHeadingDegrees", "PosePitchDegrees", "PoseRollDegrees")


@dataclass(frozen=True)
class PhotoSphere:
    """An equirectangular image, whole or a part of a whole one.

    full_size: (width, height) of the whole [px]; size: of what the image holds; corner: its left and top in
    the whole. pose_deg: heading of the whole image's middle, clockwise from north (+y of the world) from 0 to
    360; its pitch, up from level; and the roll, clockwise; None where it is not known.

    Raises: ImageError for a part that leaves the whole, and for a pose that is not finite.
    """

    full_size: tuple[int, int]
    size: tuple[int, int]
    corner: tuple[int, int] = (0, 0)
    pose_deg: tuple[float, float, float] | None = None

    def __post_init__(self):
        for full, part, start in zip(self.full_size, self.size, self.corner, strict=True):
            if not (part >= 1 and start >= 0 and start + part <= full):
                raise ImageError(
                    f"photo sphere: part of {self.size[0]} x {self.size[1]} px at {self.corner} must lie "
                    f"within {self.full_size[0]} x {self.full_size[1]} px"
                )
        if self.pose_deg is not None and not np.isfinite(self.pose_deg).all():
            raise ImageError(f"photo sphere: pose {self.pose_deg} must be three finite angles")

    @classmethod
    def whole(cls, width: int, height: int, world_from_panorama=None) -> PhotoSphere:
        """A whole panorama, and how it was turned: (3, 3), or None.

        >>> PhotoSphere.whole(8, 4, np.eye(3)).pose_deg
        (90.0, 0.0, 0.0)
        """
        pose = None if world_from_panorama is None else pose_of(world_from_panorama)
        return cls((width, height), (width, height), pose_deg=pose)

    @property
    def world_from_panorama(self) -> np.ndarray | None:
        """The rotation (3, 3) of the pose, or None."""
        if self.pose_deg is None:
            return None
        heading, pitch, roll = np.radians(self.pose_deg)
        return _about(2, np.pi / 2 - heading) @ _about(1, -pitch) @ _about(0, roll)

    def to_xmp(self) -> bytes:
        """The XMP packet."""
        sizes = (*self.full_size, *self.size, *self.corner)
        values = {"ProjectionType": "equirectangular", "UsePanoramaViewer": "True"}
        values |= {name: str(value) for name, value in zip(_SIZES, sizes, strict=True)}
        if self.pose_deg is not None:
            values |= {name: f"{angle:.4f}" for name, angle in zip(_POSE, self.pose_deg, strict=True)}
        listed = "\n".join(f"    GPano:{name}={quoteattr(value)}" for name, value in values.items())
        return (
            '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>\n'
            '<x:xmpmeta xmlns:x="adobe:ns:meta/">\n'
            ' <rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">\n'
            f'  <rdf:Description rdf:about="" xmlns:GPano="{_GPANO}"\n{listed}/>\n'
            ' </rdf:RDF>\n</x:xmpmeta>\n<?xpacket end="r"?>'
        ).encode()


def pose_of(world_from_panorama: np.ndarray) -> tuple[float, float, float]:
    """Heading from 0 to 360, pitch and roll [degrees] of a rotation (3, 3), as `PhotoSphere` has them.

    Where the middle is straight up or down, heading and roll are one turn: it is all given to the heading.
    """
    matrix = np.asarray(world_from_panorama, dtype=np.float64)
    forward, left, up = matrix.T
    level = np.hypot(*forward[:2])
    pitch = np.arctan2(forward[2], level)
    if level < _UPRIGHT:
        heading, roll = np.arctan2(left[1], -left[0]), 0.0
    else:
        heading, roll = np.arctan2(forward[0], forward[1]), np.arctan2(left[2], up[2])
    return tuple(float(angle) + 0.0 for angle in (np.degrees(heading) % 360, *np.degrees((pitch, roll))))


def sphere_from_xmp(packet: bytes) -> PhotoSphere | None:
    """The photo sphere that an XMP packet tells of, or None.

    Raises: ImageError for what is no XML, defines entities, or tells of another projection or no size.
    """
    values = _properties(packet)
    projection = values.get("ProjectionType")
    if projection is None:
        return None
    if projection != "equirectangular":
        raise ImageError(f"photo sphere: projection '{projection}' must be equirectangular")
    sizes = [_number(values, name, whole=True) for name in _SIZES]
    pose = None
    if _POSE[0] in values:
        pose = tuple(_number(values, name, default=0.0) for name in _POSE)
    return PhotoSphere((sizes[0], sizes[1]), (sizes[2], sizes[3]), (sizes[4], sizes[5]), pose)


def _properties(packet):
    """Text of each GPano property, be it an attribute or an element."""
    if len(packet) > LARGEST:
        raise ImageError(f"photo sphere: XMP of {len(packet)} bytes, the limit is {LARGEST}")
    values, current = {}, []
    parser = expat.ParserCreate(namespace_separator=" ")

    def name_of(name):
        space, _, local = name.rpartition(" ")
        return local if space == _GPANO else None

    def start(tag, attributes):
        values.update({name_of(key): value.strip() for key, value in attributes.items() if name_of(key)})
        current.append(name_of(tag))

    def text(content):
        if current and current[-1]:
            values[current[-1]] = (values.get(current[-1], "") + content).strip()

    def refuse(*_):
        raise ImageError("photo sphere: XMP with a DOCTYPE, which could define entities")

    parser.StartElementHandler, parser.CharacterDataHandler = start, text
    parser.EndElementHandler, parser.StartDoctypeDeclHandler = lambda _: current.pop(), refuse
    try:
        parser.Parse(packet, True)
    except (expat.ExpatError, LookupError) as error:
        raise ImageError(f"photo sphere: XMP that cannot be read: {error}") from error
    return values


def _number(values, name, whole=False, default=None):
    text = values.get(name, default)
    try:
        return int(text) if whole else float(text)
    except (TypeError, ValueError):
        right = "a whole number" if whole else "a number"
        raise ImageError(f"photo sphere: {name} is {text!r}, must be {right}") from None


def _about(axis, angle):
    """Rotation (3, 3) about x, y or z, right-handed [rad]."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[one, one] = matrix[other, other] = np.cos(angle)
    matrix[other, one] = np.sin(angle)
    matrix[one, other] = -np.sin(angle)
    return matrix
