"""`panorama view FOLDER -o VIEW.exr`: a panorama in layers as a camera beside its origin sees it."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from ..ibl_toolkit.images import write_exr
from ..ibl_toolkit.layers.files.storage import read_layers
from ..ibl_toolkit.layers.files.xml_file import NAME
from ..ibl_toolkit.layers.views.pinhole import Pinhole
from ..ibl_toolkit.layers.views.view_methods import METHODS, outside_by, render_view
from .job import naming, refuse_output
from .options import positive, whole_number
from .progress import Progress

INPUT = "folder of layers"
SUMMARY = "see a panorama in layers from beside its origin"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "VIEW.exr", "_view.exr", True
_HALF_MAX = float(np.finfo(np.float16).max)
_MOST = 32767  # pixels of a picture's side


@dataclass(frozen=True)
class ViewOptions:
    """The options of the verb, by the same names.

    eye, look_at: (x, y, z) in the world [m], z up. fov: of the width [degrees]. method: of METHODS.
    """

    eye: tuple[float, float, float]
    look_at: tuple[float, float, float]
    fov: float = 60.0
    width: int = 960
    height: int = 540
    method: str = "adaptive"


def add_options(parser):
    """Add the verb's own options."""
    add, point = (
        parser.add_argument,
        {"metavar": ("X", "Y", "Z"), "type": float, "nargs": 3, "required": True},
    )
    add("--eye", **point, help="where the camera is, in the world [m]")
    add("--look-at", **point, help="what is in the middle of the picture, in the world [m]")
    add("--fov", metavar="DEG", type=positive, default=ViewOptions.fov, help="angle of the width [°] (60)")
    add("--width", metavar="W", type=whole_number(1, _MOST), default=ViewOptions.width, help="[px] (960)")
    add("--height", metavar="H", type=whole_number(1, _MOST), default=ViewOptions.height, help="[px] (540)")
    add("--method", choices=METHODS, default=ViewOptions.method, help=f"(default: {ViewOptions.method})")


def run(folder, output, options, progress):
    """Do the verb -> what `--json` prints."""
    given = {field.name: getattr(options, field.name) for field in fields(ViewOptions)}
    return write_view(folder, output, ViewOptions(**given), progress)


def write_view(folder, output, options, progress=None):
    """Write a view of the layers in `folder` -> method, size, seconds, holes [px], triangles, warnings.

    The EXR has R G B, half floats where they can hold it, and Z in 32-bit floats: the distance from the eye
    along the ray [m], +inf at infinity, NaN in holes. triangles is None where the method has none.
    """
    progress = progress or Progress()
    refuse_output(output, ".exr", ())
    camera = Pinhole.looking_at(options.eye, options.look_at, options.fov, options.width, options.height)
    folder = Path(folder)
    if not (folder.is_dir() or folder.suffix.lower() == ".xml"):
        raise ValueError(f"{folder}: must be a folder with a {NAME}")
    with progress.step("reading"):
        panorama = read_layers(folder)
    with progress.step("view"), naming(folder):
        view = render_view(panorama, camera, options.method)
    with progress.step("writing"):
        _write(output, view)
    return {
        "method": options.method,
        "size": [options.width, options.height],
        "seconds": dict(progress.seconds),
        "holes": int(np.count_nonzero(view.holes)),
        "triangles": view.triangles,
        "warnings": list(_warnings(panorama, camera)),
    }


def _warnings(panorama, camera):
    outside = outside_by(panorama, camera)
    if outside > 0:
        yield (
            f"the eye is {outside:.3g} m outside of the panorama's radius, {panorama.radius:.3g} m: "
            "what is seen there may lack parts that are in no layer"
        )


def _write(path, view):
    kind = np.float16 if view.radiance.max() <= _HALF_MAX else np.float32
    channels = {name: view.radiance[..., k].astype(kind) for k, name in enumerate("RGB")}
    write_exr(path, {**channels, "Z": view.depth})


def describe(result):
    """One line."""
    width, height = result["size"]
    share = result["holes"] / (width * height)
    drawn = "" if result["triangles"] is None else f", {result['triangles']} triangles"
    seconds = result["seconds"]["view"]
    return [f"{width} × {height} px, {result['method']}: {seconds:.2f} s, holes {100 * share:.2g} %{drawn}"]
