"""`panorama probe PHOTO`: light directions from a ball, or from a shadow, in one photograph."""

import argparse
import json
import math
from dataclasses import dataclass, fields
from pathlib import Path

from ..ibl_toolkit.images import replacing
from ..ibl_toolkit.mobile.probe import (
    DICTIONARY,
    DOMAINS,
    KINDS,
    MOST,
    PhotoCamera,
    dictionary_names,
    estimate_lights,
    find_marker,
    light_from_shadow,
    natural_width,
    place_ball,
    read_photo,
    unwrap,
    write_unwrapped,
)
from .job import naming, refuse_output
from .options import positive, whole_number
from .probe_result import ball_json, describe, light_json, marker_json, number_or_none
from .progress import Progress

INPUT = "photograph or video frame (.exr, .hdr, .png, .jpg, .tif) of a ball"
SUMMARY = "light directions from a ball, or from a shadow, in one photograph"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "RESULT.json", "_probe.json", False
__all__ = [
    "INPUT",
    "NEEDS_OUTPUT",
    "OUTPUT",
    "SUFFIX",
    "SUMMARY",
    "add_options",
    "describe",
    "probe_photo",
    "run",
]


@dataclass(frozen=True)
class ProbeOptions:
    """The options of the verb, by the same names; lengths [m], points [px]. One of fov and focal is given."""

    fov: float | None = None
    focal: float | None = None
    principal_point: tuple | None = None
    distortion: tuple = ()
    marker_size: float | None = None
    marker_id: int | None = None
    dictionary: str = DICTIONARY
    ball_radius: float | None = None
    ball_centre: tuple | None = None
    outline: tuple | None = None
    kind: str = "mirror"
    lights: int = 3
    domain: str = "image"
    unwrap: Path | None = None
    width: int | None = None
    surroundings: float | None = None
    shadow: tuple | None = None
    height: float | None = None


def add_options(parser):
    """Add the verb's own options."""
    _add_camera(parser)
    add = parser.add_argument_group("marker, whose frame the directions are told in").add_argument
    add("--marker-size", metavar="M", type=positive, help="side of its black square [m]")
    add("--marker-id", metavar="N", type=whole_number(0), help="which, where several are seen")
    add(
        "--dictionary", choices=dictionary_names(), metavar="NAME", default=DICTIONARY, help=f"({DICTIONARY})"
    )
    add = parser.add_argument_group("ball").add_argument
    add("--kind", choices=KINDS, default="mirror", help="(mirror)")
    add("--ball-radius", metavar="M", type=positive, help="[m]; without it, distances are in radii")
    add("--ball-centre", metavar=("X", "Y", "Z"), type=float, nargs=3, help="in the marker's frame [m]")
    add("--outline", metavar="X,Y", type=_point, nargs="+", help="3 or more points of its outline [px]")
    at_most = whole_number(1, MOST)
    add("--lights", metavar="N", type=at_most, default=3, help="at most so many, strongest first (3)")
    add("--domain", choices=tuple(DOMAINS), default="image", help="where lights are looked for (image)")
    add = parser.add_argument_group("panorama of a mirror ball").add_argument
    add("--unwrap", metavar="OUT.exr", type=Path, help="write it; alpha 0: the ball's blind spot")
    add("--width", metavar="W", type=whole_number(4), help="[px], even (as fine as the photograph)")
    add(
        "--surroundings",
        metavar="M",
        type=positive,
        help="how far off they are, in the ball's unit (infinite)",
    )
    add = parser.add_argument_group("a shadow instead of a ball").add_argument
    add(
        "--shadow",
        metavar=("FOOT", "TIP"),
        type=_point,
        nargs=2,
        help="X,Y of an upright edge's foot, and of its shadow's tip",
    )
    add("--height", metavar="M", type=positive, help="of that edge [m]")


def _add_camera(parser):
    group = parser.add_argument_group("camera")
    either = group.add_mutually_exclusive_group(required=True)
    either.add_argument("--fov", metavar="DEG", type=positive, help="angle of the picture's width [°]")
    either.add_argument("--focal", metavar="PX", type=positive, help="focal length [px]")
    group.add_argument("--principal-point", metavar=("X", "Y"), type=float, nargs=2, help="[px] (the middle)")
    group.add_argument(
        "--distortion",
        metavar="K",
        type=float,
        nargs="+",
        default=(),
        help="OpenCV's k1 k2 p1 p2 [k3 …] (none)",
    )


def _point(text):
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        x = y = math.nan
    if not math.isfinite(x + y):
        raise argparse.ArgumentTypeError(f"{text!r}: must be a point X,Y [px]")
    return x, y


def run(photo, output, options, progress):
    """Do the verb -> what `--json` prints."""
    if hasattr(options, "batch_verb") and options.unwrap:
        raise ValueError("--unwrap names one file: not in a batch")
    given = {field.name: getattr(options, field.name) for field in fields(ProbeOptions)}
    return probe_photo(photo, output, ProbeOptions(**given), progress)


def probe_photo(path, output=None, options=None, progress=None):
    """Light directions of a photograph -> a dict, the result of --json; also written to `output` where given.

    Raises: ValueError (ProbeError, ImageError) for bad options and a photograph that tells no light; OSError.
    """
    path, options, progress = Path(path), options or ProbeOptions(), progress or Progress()
    _refuse_options(options)
    for name, file, suffix in (("-o", output, ".json"), ("--unwrap", options.unwrap, ".exr")):
        if file is not None:
            refuse_output(file, suffix, (path,), name)
    with progress.step("reading"):
        photo = read_photo(path)
    with naming(path), progress.step("light"):
        camera = _camera(photo, options)
        pose = None
        if options.marker_size is not None:
            pose = find_marker(photo, camera, options.marker_size, options.marker_id, options.dictionary)
        result = (
            _of_shadow(camera, pose, options) if options.shadow else _of_ball(photo, camera, pose, options)
        )
    result["marker"] = pose and marker_json(pose)
    result["warnings"] = [*(pose.warnings if pose else ()), *result["warnings"]]
    if output is not None:
        with replacing(output) as temporary:
            temporary.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return result


def _refuse_options(options):
    needs = (
        ("marker_id", "marker_size"),
        ("ball_centre", "marker_size"),
        ("ball_centre", "ball_radius"),
        ("shadow", "marker_size"),
        ("shadow", "height"),
        ("height", "shadow"),
        ("width", "unwrap"),
        ("surroundings", "unwrap"),
    )
    for name, needed in needs:
        if getattr(options, name) is not None and getattr(options, needed) is None:
            raise ValueError(f"{_flag(name)}: needs {_flag(needed)} too")
    if options.dictionary != DICTIONARY and options.marker_size is None:
        raise ValueError("--dictionary: needs --marker-size too")
    for name in ("ball_radius", "outline", "unwrap", "kind", "lights", "domain"):
        if options.shadow is not None and getattr(options, name) != getattr(ProbeOptions, name):
            raise ValueError(f"{_flag(name)}: does nothing with --shadow, which needs no ball")
    if options.unwrap is not None and options.kind != "mirror":
        raise ValueError("--unwrap: a diffuse ball mirrors no panorama")


def _flag(name):
    return "--" + name.replace("_", "-")


def _camera(photo, options):
    width, height = photo.size
    how = {"centre": options.principal_point, "distortion": tuple(options.distortion)}
    if options.focal is not None:
        return PhotoCamera.from_focal(options.focal, width, height, **how)
    if options.fov is None:
        raise ValueError("field of view or focal length: one of them is needed")
    return PhotoCamera.from_fov(options.fov, width, height, **how)


def _of_shadow(camera, pose, options):
    found = light_from_shadow(camera, pose, *options.shadow, options.height)
    light = {"direction": found.direction.tolist(), "strength": 1.0, "uncertainty_deg": found.uncertainty_deg}
    light["direction_camera"] = (pose.marker_from_camera.T @ found.direction).tolist()
    light["altitude_deg"] = found.altitude_deg
    return {"method": "shadow", "frame": "marker", "lights": [light], "warnings": list(found.warnings)}


def _of_ball(photo, camera, pose, options):
    placed = place_ball(
        photo,
        camera,
        pose=pose,
        radius=options.ball_radius,
        centre=options.ball_centre,
        points=options.outline,
    )
    found = estimate_lights(photo, camera, placed.ball, options.kind, options.lights, options.domain, pose)
    strongest = max(found.lights[0].luminance, 1e-30)
    result = {
        "method": options.kind,
        "frame": "camera" if pose is None else "marker",
        "lights": [light_json(light, strongest, pose) for light in found.lights],
        "residual": number_or_none(found.residual),
        "ball": ball_json(placed, camera),
        "is_hdr": photo.is_hdr,
        "warnings": [*placed.warnings, *found.warnings],
    }
    if options.unwrap is not None:
        result["unwrapped"] = _write_panorama(photo, camera, placed.ball, pose, options)
    return result


def _write_panorama(photo, camera, ball, pose, options):
    width = options.width or max(natural_width(camera, ball), 4)
    turn = None if pose is None else pose.marker_from_camera
    found = unwrap(photo, camera, ball, width, turn, options.surroundings or math.inf)
    write_unwrapped(found, options.unwrap)
    return {"file": str(options.unwrap), "size": [width, width // 2], "known": float(found.known.mean())}
