"""The panorama set: a JSON file that says everything an artist told the program about one panorama.

The keys are those of the manual's page on the set file; what is unknown, of a wrong type or out of range is
refused with its full key path, such as "shapes[3].top". Paths in the file are relative to it.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np

from .calibration.picks import CalibrationPicks, KnownLength, Parallels, Rectangle
from .images.atomic import replacing
from .set_fields import Fields, SetError

VERSION = 1
ROLES = ("SUPPORT", "ENVIRONMENT")
PLANES = ("FLOOR", "CEILING", "WALL")
POINTS = {  # kind: (fewest points, whether exactly so many)
    "polygon": (3, False),
    "rectangle": (3, True),
    "square": (2, True),
    "circle": (3, False),
    "walls": (0, True),
    "box": (3, True),
    "cylinder": (3, False),
}
SOLIDS = ("walls", "box", "cylinder")
DEFAULT_ROUGHNESS = 0.2


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape of the real place, as picked.

    points (n, 2): picks (u, v) on the floor, None for walls, which name their floor in `of`. top (2,): pick
    on the upper edge, or else height [m], of walls, boxes and cylinders. reflectivity and roughness: of a
    glossy support.
    """

    name: str
    kind: str
    points: np.ndarray | None = None
    of: str | None = None
    top: np.ndarray | None = None
    height: float | None = None
    ceiling: bool = False
    role: str = "SUPPORT"
    reflectivity: float = 0.0
    roughness: float = DEFAULT_ROUGHNESS


@dataclass(frozen=True, eq=False)
class PanoramaSet:
    """An image, the picks that calibrate it, the shapes of the place, the .blend with objects to add."""

    image: Path
    calibration: CalibrationPicks
    shapes: tuple[Shape, ...] = ()
    objects: Path | None = None


def read_set(path):
    """Read a set file -> PanoramaSet, its paths resolved against the file's folder.

    Raises SetError naming the file and the key; OSError when it cannot be opened.
    """
    path = Path(path)
    try:
        document = json.loads(
            path.read_text(encoding="utf-8"), object_pairs_hook=_once_each, parse_constant=_refuse_constant
        )
        return set_from_dict(document, path.parent)
    except (ValueError, RecursionError) as error:  # JSON and UTF-8 errors are ValueErrors
        raise SetError(f"{path}: {error}") from error


def write_set(panorama_set, path):
    """Write a set file; an existing one is replaced in one step. Raises SetError for an invalid set."""
    path = Path(path)
    document = set_to_dict(panorama_set, path.parent)
    set_from_dict(document, path.parent)
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    with replacing(path) as temporary:
        Path(temporary).write_text(text, encoding="utf-8")


def set_from_dict(document, folder):
    """The PanoramaSet of the JSON object of a set file in `folder`. Raises SetError naming the key."""
    fields = Fields(document, "")
    version = fields.integer("version")
    if version != VERSION:
        newer = ": written by a newer program, update this one" if version > VERSION else ""
        raise SetError(f"version is {version}, must be {VERSION}{newer}")
    image = Path(folder) / fields.text("image")
    calibration = _calibration(fields.object("calibration"))
    shapes = tuple(_shape(item) for item in fields.objects("shapes", default=()))
    objects = fields.text("objects", default=None)
    fields.finish()
    _check_names(shapes)
    return PanoramaSet(image, calibration, shapes, None if objects is None else Path(folder) / objects)


def set_to_dict(panorama_set, folder):
    """The JSON object of a set file in `folder`; its paths are made relative to it where they can be."""
    document = {"version": VERSION, "image": _relative(panorama_set.image, folder)}
    document["calibration"] = _calibration_to_dict(panorama_set.calibration)
    document["shapes"] = [_shape_to_dict(shape) for shape in panorama_set.shapes]
    if panorama_set.objects is not None:
        document["objects"] = _relative(panorama_set.objects, folder)
    return document


def _calibration(fields):
    rectangles = tuple(
        _finished(item, Rectangle(item.points("points", 4, exactly=True), item.choice("plane", PLANES)))
        for item in fields.objects("rectangles", default=())
    )
    parallels = tuple(
        _finished(item, Parallels(item.choice("axis", ("X", "Y")), item.lines("lines")))
        for item in fields.objects("parallels", default=())
    )
    verticals = fields.lines("verticals", default=np.zeros((0, 2, 2)))
    height = fields.number("camera_height", above=0, default=None)
    length = fields.object("length", default=None)
    if height is not None and length is not None:
        raise SetError(f"{fields.key('length')} is given beside camera_height: the scale needs one of them")
    if length is not None:
        length = _finished(
            length, KnownLength(length.points("points", 2, exactly=True), length.number("metres", above=0))
        )
    return _finished(fields, CalibrationPicks(rectangles, parallels, verticals, height, length))


def _calibration_to_dict(picks):
    document = {}
    if len(picks.rectangles):
        document["rectangles"] = [{"points": _listed(r.points), "plane": r.plane} for r in picks.rectangles]
    if len(picks.parallels):
        document["parallels"] = [{"axis": p.axis, "lines": _listed(p.lines)} for p in picks.parallels]
    if len(picks.verticals):
        document["verticals"] = _listed(picks.verticals)
    if picks.camera_height is not None:
        document["camera_height"] = float(picks.camera_height)
    if picks.length is not None:
        document["length"] = {"points": _listed(picks.length.points), "metres": float(picks.length.metres)}
    return document


def _shape(fields):
    kind = fields.choice("kind", tuple(POINTS))
    known = {"name": fields.text("name"), "kind": kind, "role": fields.choice("role", ROLES)}
    if kind == "walls":
        known["of"] = fields.text("of")
        known["ceiling"] = fields.boolean("ceiling", default=False)
    else:
        count, exactly = POINTS[kind]
        known["points"] = fields.points("points", count, exactly)
    if kind in SOLIDS:
        known["top"] = fields.point("top", default=None)
        known["height"] = fields.number("height", above=0, default=None)
        if (known["top"] is None) == (known["height"] is None):
            given = "neither" if known["top"] is None else "both"
            raise SetError(
                f"{fields.key('top')} and {fields.key('height')}: {given} given, must be one of them"
            )
    if known["role"] == "SUPPORT":
        known["reflectivity"] = fields.number("reflectivity", least=0, most=1, default=0.0)
        known["roughness"] = fields.number("roughness", least=0, most=1, default=DEFAULT_ROUGHNESS)
    return _finished(fields, Shape(**known))


def _shape_to_dict(shape):
    document = {"name": shape.name, "kind": shape.kind}
    for key in ("points", "of", "top", "height"):
        value = getattr(shape, key)
        if value is not None:
            document[key] = _listed(value) if key in ("points", "top") else value
    if shape.ceiling:
        document["ceiling"] = True
    document["role"] = shape.role
    if shape.reflectivity:
        document["reflectivity"] = float(shape.reflectivity)
    if shape.roughness != DEFAULT_ROUGHNESS:
        document["roughness"] = float(shape.roughness)
    return document


def _check_names(shapes):
    kinds = {}
    for index, shape in enumerate(shapes):
        if shape.name in kinds:
            raise SetError(
                f"shapes[{index}].name is '{shape.name}', which an earlier shape has: names must differ"
            )
        kinds[shape.name] = shape.kind
    for index, shape in enumerate(shapes):
        if shape.of is not None and kinds.get(shape.of, "walls") in SOLIDS:
            raise SetError(
                f"shapes[{index}].of is '{shape.of}', must name a polygon or other flat shape of this set"
            )


def _finished(fields, value):
    fields.finish()
    return value


def _listed(array):
    return np.asarray(array, dtype=np.float64).tolist()


def _relative(path, folder):
    path, folder = Path(path).absolute(), Path(folder).absolute()
    if path.drive != folder.drive:  # Windows: no relative path leads to another drive
        return path.as_posix()
    return PurePath(os.path.relpath(path, folder)).as_posix()


def _once_each(pairs):
    document = dict(pairs)
    if len(document) != len(pairs):
        keys = [key for key, _ in pairs]
        repeated = next(key for key in keys if keys.count(key) > 1)
        raise SetError(f"key '{repeated}' stands twice in one object")
    return document


def _refuse_constant(name):
    raise SetError(f"{name} is not a number that JSON knows")
