"""LIGHTS.json: the lights of a map, for other programs and for Blender.

    {"version": 1, "image": "room.exr", "method": "hybrid", "threshold": 0.61, "share": 0.61, "reason": "…",
     "residual": "rest.exr",
     "lights": [{"direction": [x, y, z], "irradiance": [r, g, b], "solid_angle": 0.01,
                 "position": [x, y, z]}]}

Directions and positions [m] are in the panorama frame; irradiance is the radiance of a light's region,
integrated over its solid angle [sr], so that the sum over all lights and the residual's integral are the
map's. Paths are relative to the file. A light without depth has no `position`, a map that was not split no
`threshold`, and a file without a residual image no `residual`.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..images.atomic import replacing
from ..set_fields import Fields, SetError
from .extraction import METHODS

VERSION = 1
_UNIT = 1e-6
_WHOLE_SPHERE = 4 * np.pi * (1 + 1e-6)


class LightsError(ValueError):
    """A lights file that is not valid; the message names the file, the key and what would be right."""


@dataclass(frozen=True, eq=False)
class Light:
    """One light; position (3,) [m] is None where its depth is not known."""

    direction: np.ndarray
    """(3,) unit vector towards it, panorama frame."""
    irradiance: np.ndarray
    """(3,) RGB radiance of its region, integrated over solid angle."""
    solid_angle: float
    """Of its region [sr]."""
    position: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class LightsFile:
    """What a lights file says."""

    image: Path
    method: str
    share: float
    """The lights' part of the map's light, in [0, 1]."""
    lights: tuple[Light, ...]
    threshold: float | None = None
    reason: str = ""
    residual: Path | None = None


def lights_of(extraction):
    """The lights of an `Extraction`, a tuple of Light, the strongest first.

    >>> from .extraction import extract_lights
    >>> image = np.full((16, 32, 3), 0.01, np.float32)
    >>> image[4, 10] = 500
    >>> [light.position for light in lights_of(extract_lights(image))]
    [None]
    """
    samples, positions = extraction.samples, extraction.positions
    if positions is None:
        positions = np.full_like(samples.directions, np.nan)
    return tuple(
        Light(direction, irradiance, float(solid_angle), None if np.isnan(position).any() else position)
        for direction, irradiance, solid_angle, position in zip(
            samples.directions, samples.irradiance, samples.solid_angles, positions, strict=True
        )
    )


def write_lights(path, lights_file):
    """Write a LightsFile; an existing file is replaced in one step."""
    path = Path(path)
    text = json.dumps(_to_dict(lights_file, path.parent), indent=2, ensure_ascii=False, allow_nan=False)
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


def read_lights(path):
    """Read a lights file -> LightsFile, its paths resolved against the file's folder.

    Raises: LightsError naming the file and the key; OSError when it cannot be opened.
    """
    path = Path(path)
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(document, dict):
            raise SetError(f"a {type(document).__name__} stands where the object with the lights must be")
        return _from_fields(Fields(document, ""), path.parent)
    except (ValueError, RecursionError) as error:  # JSON and UTF-8 errors are ValueErrors
        raise LightsError(f"{path}: {error}") from error


def _to_dict(lights_file, folder):
    document = {
        "version": VERSION,
        "image": _relative(lights_file.image, folder),
        "method": lights_file.method,
        "share": float(lights_file.share),
        "reason": lights_file.reason,
        "lights": [_light_to_dict(light) for light in lights_file.lights],
    }
    if lights_file.threshold is not None:
        document["threshold"] = float(lights_file.threshold)
    if lights_file.residual is not None:
        document["residual"] = _relative(lights_file.residual, folder)
    return document


def _light_to_dict(light):
    entry = {
        "direction": light.direction.tolist(),
        "irradiance": light.irradiance.tolist(),
        "solid_angle": float(light.solid_angle),
    }
    if light.position is not None:
        entry["position"] = light.position.tolist()
    return entry


def _from_fields(fields, folder):
    version = fields.integer("version")
    if version != VERSION:
        newer = ": written by a newer program, update this one" if version > VERSION else ""
        raise SetError(f"version is {version}, must be {VERSION}{newer}")
    residual = fields.text("residual", default=None)
    found = LightsFile(
        image=folder / fields.text("image"),
        method=fields.choice("method", METHODS),
        share=fields.number("share", least=0, most=1 + _UNIT),
        lights=tuple(_light(entry) for entry in fields.objects("lights")),
        threshold=fields.number("threshold", least=0, most=1, default=None),
        reason=fields.text("reason"),
        residual=None if residual is None else folder / residual,
    )
    fields.finish()
    return found


def _light(fields):
    direction, irradiance = fields.vector("direction"), fields.vector("irradiance")
    if abs(np.linalg.norm(direction) - 1) > _UNIT:
        raise SetError(f"{fields.key('direction')} is {direction.tolist()}, must have length 1")
    if (irradiance < 0).any():
        raise SetError(f"{fields.key('irradiance')} is {irradiance.tolist()}, must not be below 0")
    solid_angle = fields.number("solid_angle", above=0)
    if solid_angle > _WHOLE_SPHERE:
        raise SetError(f"{fields.key('solid_angle')} is {solid_angle}, must be at most 4π")
    light = Light(direction, irradiance, solid_angle, fields.vector("position", default=None))
    fields.finish()
    return light


def _relative(path, folder):
    path, folder = Path(path).absolute(), Path(folder).absolute()
    if path.drive != folder.drive:  # Windows: no relative path leads to another drive
        return path.as_posix()
    return Path(os.path.relpath(path, folder)).as_posix()
