"""RGB-D shots from several places: a small JSON file names them and says where each was taken.

    {"version": 1,
     "shots": [{"image": "hall.exr", "origin": [0, 0, 1.5]},
               {"image": "door.exr", "origin": [2, 1, 1.4], "fov_deg": 70, "look_at": [3, 1, 1.2]}]}

With `fov_deg` (of the width) a shot is perspective, and either looks upright at a point, or has the axes
`forward` and `down` in the world. Without it is a panorama, equirectangular or a cube map by its size, turned
as an RGB-D panorama's attributes say, else level. All are OpenEXR with R G B, and Z in 32 bits: the distance
along the ray [m], +inf at infinity, NaN where it is not known. Paths are relative to the file.

Source: thesis, section 6.3.3, whose devices know where they are.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...images import DEFAULT_MAX_BYTES, exr, exr_header
from ...images.channel_names import channel_named, colour_channels
from ...images.checking import refuse_impossible_radiance
from ...images.rgbd import WORLD_FROM_PANORAMA
from ...set_fields import Fields, SetError
from ..panorama import refuse_other_place
from ..views.pinhole import Pinhole
from .grid import PixelGrid, mapping_of_size

VERSION = 1


@dataclass(frozen=True, eq=False)
class Shot:
    """What one shot saw: rays (n, 3) from its origin (3,), unit vectors in the world; distances (n,) [m]
    along them, +inf at infinity; colours (n, 3), linear."""

    origin: np.ndarray
    rays: np.ndarray
    distances: np.ndarray
    colours: np.ndarray


def is_shots_file(path) -> bool:
    """Whether a JSON file lists shots. False for what is no JSON; OSError when it cannot be opened."""
    try:
        document = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        return False
    return isinstance(document, dict) and "shots" in document


def read_shots(path) -> list[Shot]:
    """The shots of a JSON file and the images that it names.

    Raises: SetError naming the file and the key, or the image, where that cannot be read, has no depth, or
    one that is not above 0; OSError.
    """
    path = Path(path)
    try:
        fields = Fields(json.loads(path.read_text(encoding="utf-8")), "")
        version = fields.integer("version")
        if version != VERSION:
            newer = ": written by a newer program, update this one" if version > VERSION else ""
            raise SetError(f"version is {version}, must be {VERSION}{newer}")
        listed = fields.objects("shots")
        fields.finish()
        if not listed:
            raise SetError("shots is empty, must have one or more")
        return [_shot(shot, path.parent) for shot in listed]
    except (ValueError, RecursionError) as error:
        raise SetError(f"{path}: {error}") from error


def _shot(fields, folder):
    image, origin = folder / fields.text("image"), fields.vector("origin")
    fov_deg = fields.number("fov_deg", above=0, default=None)
    look_at, forward, down = (fields.vector(name, default=None) for name in ("look_at", "forward", "down"))
    fields.finish()
    if (fov_deg is None) != (look_at is None and forward is None):
        raise SetError(f"{fields.key('fov_deg')}: must be given with look_at, or forward and down, alone")
    if (forward is None) != (down is None) or (forward is not None and look_at is not None):
        raise SetError(f"{fields.key('forward')}: must be given with down, and without look_at")
    colours, distances, attributes = _read_picture(image)
    height, width = distances.shape
    if fov_deg is None:
        rays = _rays_of_panorama(image, width, height, attributes)
    elif look_at is not None:
        rays = Pinhole.looking_at(origin, look_at, fov_deg, width, height).directions()
    else:
        axes = np.stack([np.cross(down, forward), down, forward])
        rays = Pinhole(origin, axes, fov_deg, width, height).directions()
    known = ~np.isnan(distances)
    return Shot(origin, rays.astype(np.float32)[known], distances[known], colours[known])


def _rays_of_panorama(image, width, height, attributes):
    try:
        grid = PixelGrid(mapping_of_size(width, height), width, height)
        turn = np.array(attributes.get(WORLD_FROM_PANORAMA, np.eye(3)), dtype=np.float64).reshape(3, 3)
        refuse_other_place(turn, (0, 0, 0), 0)
    except ValueError as error:
        raise SetError(f"{image}: {error}") from None
    return grid.image(grid.directions @ turn.T)


def _read_picture(path):
    """Radiance (H, W, 3), depth (H, W), and the header."""
    parts = exr.refuse_unreadable(path, DEFAULT_MAX_BYTES)
    index, names = colour_channels(parts, path)
    part = parts[index]
    z = channel_named(part, "Z")
    if z is None or z.pixel_type != exr_header.FLOAT or z.sampling != (1, 1):
        raise SetError(f"{path}: a 32-bit float channel Z is needed for the depth")
    pixels, header = exr.decode(path, parts, index, (*names, z.name))
    depth = np.ascontiguousarray(pixels.pop(z.name))
    image = np.maximum(exr.stacked(pixels, names), 0)
    refuse_impossible_radiance(image, path)
    bad = depth <= 0
    if bad.any() or not (depth > 0).any():
        raise SetError(
            f"{path}: {np.count_nonzero(bad)} depths are not above 0; +inf means none, NaN unknown"
        )
    return image, depth, header
