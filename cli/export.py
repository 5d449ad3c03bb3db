"""`panorama export INPUT -o FILE`: a panorama in layers for other programs, or a picture for viewers."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from ..ibl_toolkit.images import (
    PhotoSphere,
    exposure_for,
    is_rgbd,
    read_panorama,
    read_rgbd,
    write_jpeg,
    write_png,
)
from ..ibl_toolkit.layers.export.pieces import TEXTURE_ERROR_PX
from ..ibl_toolkit.layers.export.writing import FORMATS, SURFACES, export_layers
from ..ibl_toolkit.layers.files.storage import read_layers
from ..ibl_toolkit.layers.files.xml_file import NAME
from ..ibl_toolkit.layers.views.flattened import flattened
from .job import naming, open_job, refuse_output
from .options import positive, whole_number
from .progress import Progress

INPUT = "folder of layers; for a picture also a panorama (.exr, .hdr) or panorama set (.json)"
SUMMARY = "write a panorama in layers as meshes for other programs, or a panorama as a picture for viewers"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "FILE", ".glb", True
PICTURES = {".jpg": write_jpeg, ".png": write_png}
_OF_MESHES = ("surface", "far", "texture_error")


@dataclass(frozen=True)
class ExportOptions:
    """The options of the verb, by the same names; None: its default.

    surface: of SURFACES. exposure: a factor. far: [m]. texture_error: [px]. level: 0 for the finest.
    """

    surface: str | None = None
    exposure: float | None = None
    far: float | None = None
    texture_error: float | None = None
    level: int = 0


def add_options(parser):
    """Add the verb's own options."""
    add = parser.add_argument
    add(
        "--surface",
        choices=SURFACES,
        help=f"of each layer (default: {', '.join(map(' '.join, FORMATS.items()))})",
    )
    add("--exposure", metavar="E", type=positive, help="what radiance is multiplied with (mid grey)")
    add("--far", metavar="R", type=positive, help="radius of what stands for infinity [m] (far enough)")
    add(
        "--texture-error",
        metavar="PX",
        type=positive,
        help=f"how far a texture may be off on a triangle [px] ({TEXTURE_ERROR_PX})",
    )
    add("--level", metavar="N", type=whole_number(0, 16), default=0, help="mip level that is read (0)")


def run(input_path, output, options, progress):
    """Do the verb -> what `--json` prints."""
    given = {field.name: getattr(options, field.name) for field in fields(ExportOptions)}
    return export_file(input_path, output, ExportOptions(**given), progress)


def export_file(input_path, output, options=None, progress=None):
    """Write `output` -> its files, exposure, bytes, seconds; the layers of a mesh, the size of a picture.

    input_path: a folder of layers or its panorama.xml; for .jpg and .png also a panorama or a set.
    """
    options, progress = options or ExportOptions(), progress or Progress()
    path, output = Path(input_path), Path(output)
    suffix = output.suffix.lower()
    allowed = (*FORMATS, *PICTURES)
    if suffix not in allowed:
        raise ValueError(f"-o {output}: must end in {', '.join(allowed)}")
    refuse_output(output, suffix, (path,))
    if suffix in PICTURES:
        return _picture(path, output, options, progress)
    return _meshes(path, output, options, progress)


def _meshes(path, output, options, progress):
    if not _is_folder(path):
        raise ValueError(f"{path}: must be a folder with a {NAME}, for a {output.suffix} file")
    with progress.step("reading"):
        panorama = read_layers(path, level=options.level)
    with progress.step("meshes"), naming(path):
        exported = export_layers(
            panorama,
            output,
            surface=options.surface,
            exposure=options.exposure,
            far=options.far,
            texture_error_px=options.texture_error or TEXTURE_ERROR_PX,
        )
    layers = [vars(layer) for layer in exported.layers]
    return {**_result(exported.files, exported.exposure, exported.clipped, progress), "layers": layers}


def _picture(path, output, options, progress):
    for name in _OF_MESHES:
        if getattr(options, name) is not None:
            raise ValueError(f"--{name.replace('_', '-')}: does nothing for a picture, {output}")
    with progress.step("reading"):
        image, world_from_panorama = _read_picture(path, options.level)
    exposure = options.exposure or exposure_for(image)
    height, width = image.shape[:2]
    sphere = PhotoSphere.whole(width, height, world_from_panorama)
    with progress.step("writing"):
        PICTURES[output.suffix.lower()](output, image, exposure=exposure, sphere=sphere)
    clipped = np.count_nonzero(image.max(axis=2) * exposure > 1) / (width * height)
    told = _result([output], exposure, clipped, progress)
    return {**told, "size": [width, height], "pose_deg": sphere.pose_deg}


def _read_picture(path, level):
    """Radiance (H, W, 3), and world_from_panorama (3, 3) or None."""
    if _is_folder(path):
        panorama = read_layers(path, level=level)
        with naming(path):
            return flattened(panorama), panorama.world_from_panorama
    if level:
        raise ValueError(f"--level: does nothing for {path}, which has one resolution")
    if path.suffix.lower() == ".json":
        job = open_job(path)
        return read_panorama(job.set.image), job.calibration.world_from_panorama
    if is_rgbd(path):
        rgbd = read_rgbd(path)
        return rgbd.image, rgbd.world_from_panorama
    return read_panorama(path), None


def _is_folder(path):
    return path.is_dir() or path.suffix.lower() == ".xml"


def _result(files, exposure, clipped, progress):
    return {
        "files": [str(file) for file in files],
        "bytes": sum(file.stat().st_size for file in files),
        "exposure": float(exposure),
        "clipped": clipped,
        "seconds": dict(progress.seconds),
        "warnings": [],
    }


def describe(result):
    """One line for each layer, and one for the files."""
    lines = [
        "{name}: {vertices} vertices, {triangles} triangles, ".format(**layer) + _size(layer["bytes"])
        for layer in result.get("layers", ())
    ]
    if "size" in result:
        lines = ["{} × {} px".format(*result["size"])]
    files = ", ".join(result["files"])
    clipped = f"{100 * result['clipped']:.3g} % of the pixels clipped"
    return [*lines, f"{files}: {_size(result['bytes'])}, radiance × {result['exposure']:.4g}, {clipped}"]


def _size(count):
    return f"{count / 1e6:.3g} MB"
