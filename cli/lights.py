"""`panorama lights IMAGE_OR_SET -o LIGHTS.json`: few lights for the bright part of a map, and the rest."""

from contextlib import ExitStack
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from ..ibl_toolkit import equirectangular
from ..ibl_toolkit.images import replacing, write_exr
from ..ibl_toolkit.light.clipping import find_clipping, irradiance_from_shadow, restored
from ..ibl_toolkit.light.extraction import METHODS, extract_lights
from ..ibl_toolkit.light.light_map import LUMINANCE
from ..ibl_toolkit.light.lights_file import LightsFile, lights_of, write_lights
from ..ibl_toolkit.light.penrose import penrose_sampling
from ..ibl_toolkit.light.presampling import PresamplingMap, write_presampling
from .job import naming, refuse_output
from .light_map import picture_of, read_light_map
from .options import one_or_three, share_of_light, whole_number
from .progress import Progress

INPUT = "panorama (.exr, .hdr), RGB-D panorama (.exr) or panorama set (.json)"
SUMMARY = "make a few lights of the bright part of a map, and keep the rest as a quiet map"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "LIGHTS.json", "_lights.json", True
PRESAMPLES = 1024
PRESAMPLING_WIDTH = 512
"""Samples of a pre-sampling map, and its width, or the next the map's can be halved to [px]"""
SHOWN = 12
"""Lights that are listed for people."""


@dataclass(frozen=True)
class LightsOptions:
    """The options of the verb, by the same names; None: its default."""

    method: str = METHODS[0]
    count: int | None = None
    threshold: float | None = None
    residual: Path | None = None
    presampling: Path | None = None
    irradiance: tuple[float, ...] | None = None
    lit_over_shadow: tuple[float, ...] | None = None


def add_options(parser):
    """Add the verb's own options."""
    add = parser.add_argument
    add("--method", choices=METHODS, default=METHODS[0], help="hybrid (default), or lights for the whole map")
    add("-n", "--count", metavar="N", type=whole_number(0), help="lights (default: the map chooses)")
    add(
        "--threshold",
        metavar="auto|P",
        type=share_of_light,
        help="share of the light in the bright part, above 0 and below 1 (auto)",
    )
    add("--residual", metavar="REST.exr", type=Path, help="write the map without what the lights carry")
    add(
        "--presampling",
        metavar="MAP.exr",
        type=Path,
        help="write the rest (hybrid) or the whole map as samples and their regions",
    )
    add(
        "--irradiance",
        metavar="E|R,G,B",
        type=one_or_three,
        help="restore a clipped sun or lamp: what it brings to a surface that faces it",
    )
    add(
        "--lit-over-shadow",
        metavar="X|R,G,B",
        type=one_or_three,
        help="restore it: radiance of the floor in its light over that in its shadow",
    )


def run(input_path, output, options, progress):
    """Do the verb -> what `--json` prints."""
    given = {field.name: getattr(options, field.name) for field in fields(LightsOptions)}
    if hasattr(options, "batch_verb") and (options.residual or options.presampling):
        raise ValueError("--residual and --presampling name one file: not in a batch")
    return make_lights(input_path, output, LightsOptions(**given), progress)


def make_lights(input_path, output, options=None, progress=None):
    """Write the lights of a map, and the rest of it where asked -> what was chosen, and why.

    input_path: a panorama set, a panorama, or an RGB-D panorama. All files are written, or none.
    """
    options, progress = options or LightsOptions(), progress or Progress()
    if options.irradiance is not None and options.lit_over_shadow is not None:
        raise ValueError("--irradiance and --lit-over-shadow both say how bright the light was: give one")
    outputs = {"-o": output, "--residual": options.residual, "--presampling": options.presampling}
    outputs = {option: Path(path) for option, path in outputs.items() if path is not None}
    _refuse_outputs(outputs, (Path(input_path), picture_of(input_path)))
    light_map = read_light_map(input_path, progress)
    with progress.step("lights"), naming(light_map.path):
        image = _restored(light_map, options)
        found = extract_lights(image, options.method, options.count, options.threshold, light_map.depth)
        presampled = _presampled(image, found) if options.presampling else None
    with progress.step("writing"):
        _write(outputs, found, presampled, light_map.path)
    return _result(found)


def _refuse_outputs(outputs, inputs):
    for option, path in outputs.items():
        refuse_output(path, ".json" if option == "-o" else ".exr", inputs, option)
    names = [str(path.absolute()) for path in outputs.values()]
    if len(set(names)) < len(names):
        raise ValueError(f"{' and '.join(outputs)}: must be different files")


def _restored(light_map, options):
    """The map, its clipped light restored where the options say how bright it was."""
    wanted = options.irradiance or options.lit_over_shadow
    if wanted is None:
        return light_map.image
    wanted = np.squeeze(wanted)
    clipping = find_clipping(light_map.image)
    if options.lit_over_shadow is not None:
        wanted = irradiance_from_shadow(light_map.image, clipping, wanted, light_map.up)
    return restored(light_map.image, clipping, wanted)


def _presampled(image, found):
    """The residual as samples, or the whole map where it all became lights."""
    samples = found.samples
    if found.method == "hybrid":
        samples = penrose_sampling(image, PRESAMPLES, samples.partition < 0)
    width = image.shape[1]
    while width > PRESAMPLING_WIDTH and width % 4 == 0:
        width //= 2
    return PresamplingMap.from_samples(samples, width)


def _write(outputs, found, presampled, image_path):
    """Write all files beside their targets, then rename them, so that no error leaves some of them."""
    residual = outputs.get("--residual")
    lights_file = LightsFile(
        image=image_path,
        method=found.method,
        share=found.share,
        lights=lights_of(found),
        threshold=found.threshold,
        reason=found.reason,
        residual=residual,
    )
    with ExitStack() as stack:
        beside = {option: stack.enter_context(replacing(path)) for option, path in outputs.items()}
        if residual is not None:
            write_exr(beside["--residual"], {name: found.residual[..., k] for k, name in enumerate("RGB")})
        if presampled is not None:
            write_presampling(beside["--presampling"], presampled)
        write_lights(beside["-o"], lights_file)


def _result(found):
    lights = lights_of(found)
    powers = [float(LUMINANCE @ light.irradiance) for light in lights]
    return {
        "method": found.method,
        "threshold": found.threshold,
        "share": found.share,
        "reason": found.reason,
        "lights": [
            _summary(light, power / sum(powers) * found.share)
            for light, power in zip(lights, powers, strict=True)
        ],
        "warnings": list(found.warnings),
    }


def _summary(light, share):
    u, v = equirectangular.uv_from_direction(light.direction)
    radius = np.arccos(max(1 - light.solid_angle / (2 * np.pi), -1))
    distance = None if light.position is None else float(np.linalg.norm(light.position))
    return {
        "u": float(u),
        "v": float(v),
        "share": share,
        "angle_deg": float(np.degrees(2 * radius)),
        "distance": distance,
    }


def describe(result):
    """The reason, then a line for each of the strongest lights."""
    lines = [result["reason"]]
    for light in result["lights"][:SHOWN]:
        where = "" if light["distance"] is None else f", at {light['distance']:.2f} m"
        lines.append(
            f"  u {light['u']:.3f}  v {light['v']:.3f}  {100 * light['share']:5.1f} % of the light, "
            f"{light['angle_deg']:.1f}° across{where}"
        )
    if len(result["lights"]) > SHOWN:
        lines.append(f"  and {len(result['lights']) - SHOWN} more")
    return lines
