"""`panorama layers INPUT -o FOLDER`: a panorama in layers, of a picture, points, a set or a scene."""

from dataclasses import dataclass, fields
from pathlib import Path

from ..ibl_toolkit.layers.files.folder import refuse_other_folder, write_folder
from ..ibl_toolkit.layers.making.check import check_layers
from ..ibl_toolkit.layers.making.shots import is_shots_file
from ..ibl_toolkit.layers.making.sorting import Classes, sorted_layers
from ..ibl_toolkit.layers.making.uncovered import share_of_sphere
from .job import naming
from .layer_makers import (
    SAMPLES,
    WIDTH,
    from_folder,
    from_points,
    from_rgbd,
    from_scene,
    from_set,
    from_shots,
)
from .options import positive, rising, whole_number
from .progress import Progress

INPUT = (
    "RGB-D panorama (.exr), points (.ply), list of RGB-D shots or panorama set (.json), scene (.blend) or "
    "folder of layers"
)
SUMMARY = "make a panorama in layers: what is seen from its origin, and what hides behind"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "FOLDER", "_layers", True
FOLDER, SHOTS = "a folder", "shots"
MAKERS = {
    ".exr": from_rgbd,
    ".ply": from_points,
    ".json": from_set,
    ".blend": from_scene,
    FOLDER: from_folder,
    SHOTS: from_shots,
}


@dataclass(frozen=True)
class LayersOptions:
    """The options of the verb, by the same names; None: its default.

    radius, origin: [m]. samples, seed, denoise: of renders. surfaces: a layer for each surface along
    the rays, whose depth jumps. collections: of a scene, a layer for each. by_depth [m], by_geometry,
    infinity, flatten: what the layers are sorted by, see `Classes`.
    """

    radius: float | None = None
    layers: int | None = None
    width: int | None = None
    samples: int | None = None
    seed: int | None = None
    denoise: bool = False
    origin: tuple[float, float, float] | None = None
    collections: tuple[str, ...] = ()
    surfaces: bool = False
    by_depth: tuple[float, ...] = ()
    by_geometry: bool = False
    infinity: bool = False
    flatten: bool = False
    levels: int = 1
    ldr: bool = False


RENDERED = ("samples", "seed", "denoise", "surfaces")
IDLE = {
    ".exr": (*RENDERED, "width", "origin", "collections"),
    ".ply": (*RENDERED, "collections"),
    ".json": ("origin", "collections"),
    ".blend": (),
    SHOTS: (*RENDERED, "collections"),
    FOLDER: (*RENDERED, "radius", "layers", "width", "origin", "collections"),
}
"""Options that do nothing, by what the layers are made of."""
OF_SURFACES = ("layers", "surfaces")


def add_options(parser):
    """Add the verb's own options."""
    add = parser.add_argument
    add("--radius", metavar="R", type=positive, help="how far from the origin views will be [m]")
    add("--layers", metavar="N", type=whole_number(1), help="layers at most")
    add("--width", metavar="W", type=whole_number(8, 65536), help=f"of renders, points, shots [px] ({WIDTH})")
    add("--samples", metavar="N", type=whole_number(1), help=f"of renders: paths per pixel ({SAMPLES})")
    add("--seed", metavar="S", type=whole_number(0), help="of renders: another gives other noise (0)")
    add("--denoise", action="store_true", help="of renders: remove noise, and some detail with it")
    add("--surfaces", action="store_true", help="of renders: the surfaces along the rays, not split")
    add(
        "--origin",
        metavar=("X", "Y", "Z"),
        type=float,
        nargs=3,
        help="of a scene (its camera's), of shots (the first's) or of points (0 0 0)",
    )
    add(
        "--collection",
        dest="collections",
        metavar="NAME",
        action="append",
        default=[],
        help="of a scene: a layer for each collection that is named, in place of one for each surface",
    )
    add("--by-depth", metavar="D,D,…", type=rising, default=(), help="part layers at these distances [m]")
    add("--by-geometry", action="store_true", help="part large layers: floor, ceiling, walls, lights")
    add("--infinity", action="store_true", help="what moves by less than a pixel: a layer at infinity")
    add("--flatten", action="store_true", help="thin ranges of depth: one distance, or one plane")
    add("--levels", metavar="N", type=whole_number(1, 16), default=1, help="mip levels (default: 1)")
    add("--ldr", action="store_true", help="colours as 8-bit PNG")


def run(input_path, output, options, progress):
    """Do the verb -> what `--json` prints."""
    given = {field.name: getattr(options, field.name) for field in fields(LayersOptions)}
    return make_layers(input_path, output, LayersOptions(**given), progress)


def make_layers(input_path, output, options=None, progress=None):
    """Write a panorama in layers into the folder `output` -> its layers, radius, origin and seconds.

    input_path: an RGB-D panorama (.exr), points (.ply), a panorama set or a list of RGB-D shots (.json), a
    scene (.blend), or a folder of layers. A new folder is there whole or not at all; in one that has a
    panorama in layers the new one takes its place.
    """
    options, progress = options or LayersOptions(), progress or Progress()
    path, output = Path(input_path), Path(output)
    kind = _kind(path)
    if kind not in MAKERS:
        raise ValueError(f"{path}: must be {INPUT}")
    _refuse_options(path, kind, options)
    try:
        refuse_other_folder(output)
    except ValueError as error:
        raise ValueError(f"-o {error}") from None
    panorama = MAKERS[kind](path, options, progress)
    classes = Classes(options.by_depth, options.by_geometry, options.infinity, options.flatten)
    order = None
    if classes:
        with progress.step("sorting"), naming(path):
            panorama, order = sorted_layers(panorama, classes)
    with progress.step("writing"):
        write_folder(panorama, output, levels=options.levels, ldr=options.ldr)
    return _result(panorama, order, progress)


def _kind(path):
    if path.is_dir():
        return FOLDER
    suffix = path.suffix.lower()
    return SHOTS if suffix == ".json" and path.is_file() and is_shots_file(path) else suffix


def _refuse_options(path, kind, options):
    """Options that would do nothing."""
    idle = IDLE[kind] or (OF_SURFACES if options.collections else ())
    for name in idle:
        if getattr(options, name) not in (None, False, ()) and getattr(options, name) != []:
            option = "--collection" if name == "collections" else f"--{name}"
            raise ValueError(
                f"{option}: does nothing for {path}{' with --collection' * (idle == OF_SURFACES)}"
            )


def _result(panorama, order, progress):
    with progress.step("checking"):
        report = check_layers(panorama)
    hides = {} if order is None else {"hides": {name: list(names) for name, names in order.hides.items()}}
    return {
        "radius": float(panorama.radius),
        "origin": [float(x) for x in panorama.origin],
        "layers": [
            {
                "name": layer.name,
                "size": list(layer.size),
                "share": share_of_sphere(layer.mask),
                "discontinuities": report.jumps[layer.name],
            }
            for layer in panorama.layers
        ],
        **hides,
        "seconds": dict(progress.seconds),
        "warnings": list(report.warnings),
    }


def describe(result):
    """One line for each layer."""
    lines = [f"radius {result['radius']:.3g} m round ({', '.join(f'{x:.3g}' for x in result['origin'])})"]
    for layer in result["layers"]:
        width, height = layer["size"]
        lines.append(
            f"{layer['name']}: {width} × {height} px, {100 * layer['share']:.2f} % of the sphere, "
            f"{layer['discontinuities']} jumps of depth"
        )
    return lines
