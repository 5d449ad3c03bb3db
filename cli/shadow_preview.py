"""`panorama shadow-preview SCENE.blend|SET -o PAGE.html`: a phone's shadows as a page, glTF, or a picture."""

from dataclasses import dataclass, fields, replace
from itertools import product
from pathlib import Path

import cv2
import numpy as np

from ..ibl_toolkit.images import exposure_for, read_panorama
from ..ibl_toolkit.mobile.device_lights import LIGHT_FROM
from ..ibl_toolkit.mobile.page_files import FORMATS, PICTURES, write_page_file
from ..ibl_toolkit.mobile.shadow_maps import METHODS, STORAGES, settings_with, suggested_settings
from ..ibl_toolkit.mobile.shadow_maps.settings import LARGEST, SMALLEST
from ..ibl_toolkit.mobile.shadow_scene import MOST_LIGHTS, label
from . import blender
from .job import naming, open_job, place_in, rebuild, refuse_output
from .options import positive, some_of, whole_number, whole_numbers
from .progress import Progress

INPUT = "scene (.blend) or panorama set (.json)"
SUMMARY = "write a page that draws a scene's shadows as a phone does, over its panorama or photo"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "PAGE.html", ".html", True
_MOST_PIXELS = 32767


@dataclass(frozen=True)
class ShadowPreviewOptions:
    """The options of the verb, by the same names; None: its default.

    method, resolution, storage: the page's menu has all combinations. window [texels] or penumbra [m]: how
    wide shadows' edges are. lights: at most. width: of a picture [px].
    """

    method: tuple[str, ...] | None = None
    resolution: tuple[int, ...] | None = None
    storage: tuple[str, ...] | None = None
    window: int | None = None
    penumbra: float | None = None
    lights: int = MOST_LIGHTS
    light_from: str = LIGHT_FROM[0]
    camera: str | None = None
    exposure: float | None = None
    width: int | None = None
    objects: Path | None = None


def add_options(parser):
    """Add the verb's own options."""
    add = parser.add_argument
    kinds = "; several, with commas, are a menu"
    add("--method", metavar="M[,M]", type=some_of(METHODS), help=f"{', '.join(METHODS)} (evsm){kinds}")
    sizes = whole_numbers(SMALLEST, LARGEST)
    add("--resolution", metavar="N[,N]", type=sizes, help=f"of a shadow map [texels] (1024){kinds}")
    add("--storage", metavar="S[,S]", type=some_of(STORAGES), help=f"{', '.join(STORAGES)} (16+16){kinds}")
    edges = parser.add_mutually_exclusive_group()
    edges.add_argument("--window", metavar="N", type=whole_number(1), help="of the filter [texels], odd (3)")
    edges.add_argument("--penumbra", metavar="M", type=positive, help="width of shadows' edges [m], about")
    most = whole_number(1, MOST_LIGHTS)
    add("--lights", metavar="N", type=most, default=MOST_LIGHTS, help=f"at most ({MOST_LIGHTS})")
    add(
        "--light-from",
        choices=LIGHT_FROM,
        default=LIGHT_FROM[0],
        help="the scene's lights, or those found in its panorama (auto: the scene's own, if it has any)",
    )
    add("--camera", metavar="NAME", help="(default: the scene's active one; of a set without, its origin)")
    add("--exposure", metavar="E", type=positive, help="what radiance is multiplied with (the scene's)")
    add("--width", metavar="W", type=whole_number(4, _MOST_PIXELS), help="of a picture [px] (the scene's)")
    add(
        "--objects", metavar="F.blend", type=Path, help="of a set: new objects (default: the set's `objects`)"
    )


def run(input_path, output, options, progress):
    """Do the verb -> what `--json` prints."""
    given = {field.name: getattr(options, field.name) for field in fields(ShadowPreviewOptions)}
    return write_shadow_preview(input_path, output, ShadowPreviewOptions(**given), progress)


def write_shadow_preview(input_path, output, options=None, progress=None):
    """Write `output` -> its kinds of shadow map, lights, meshes, size, seconds, warnings.

    input_path: a scene (.blend), or a panorama set with objects. output: .html, the page; .glb, its scene;
    .png (sRGB) or .exr (radiance), the picture with the first kind of shadow map, made without a browser.
    """
    options, progress = options or ShadowPreviewOptions(), progress or Progress()
    path, output = Path(input_path), Path(output)
    suffix = output.suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(f"-o {output}: must end in {', '.join(FORMATS)}")
    if options.width is not None and suffix not in PICTURES:
        raise ValueError(f"--width: does nothing for {output}, which is as large as its window")
    if path.suffix.lower() == ".json":
        found, kinds = _of_set(path, output, options, progress)
    elif path.suffix.lower() == ".blend":
        found, kinds = _of_blend(path, output, options, progress)
    else:
        raise ValueError(f"{path}: must be {INPUT}")
    camera, background = found.camera, found.background
    if options.width is not None:
        camera, background = _resized(camera, background, options.width)
    with progress.step("writing"):
        write_page_file(output, found.scene, kinds, background, camera, path.stem)
    return _result(output, found, kinds, camera, progress)


def _of_blend(path, output, options, progress):
    if options.objects is not None:
        raise ValueError(f"--objects: does nothing for {path}, which has its own")
    refuse_output(output, output.suffix.lower(), (path,))
    with open(path, "rb"):  # Blender's own complaint is long
        pass
    with blender.opened_scene(path, progress) as scene, naming(path):
        from ..cycles_integration.shadow_preview import settings_of

        preview = scene.panorama_shadow_preview
        return _found(scene, options, lambda extent: settings_of(preview), options.exposure, progress)


def _of_set(path, output, options, progress):
    job = open_job(path)
    objects = options.objects or job.set.objects
    refuse_output(output, output.suffix.lower(), (path, job.set.image, objects))
    if objects is None:
        raise ValueError(f"{path}: without objects nothing throws a shadow: give --objects F.blend")
    if not objects.is_file():
        raise ValueError(f"{path}: objects: {objects}: no such file")
    pieces = rebuild(job)
    with progress.step("reading"):
        exposure = options.exposure or exposure_for(read_panorama(job.set.image))
    with blender.empty_scene(progress) as scene, naming(path):
        from ..cycles_integration.objects_file import append_objects

        place_in(scene, job, pieces)
        with blender.errors_of(objects):
            appended = append_objects(scene, objects)
        scene.camera = appended.active_camera
        scene.render.resolution_x, scene.render.resolution_y = appended.size
        scene.render.resolution_percentage = 100
        scene.frame_set(appended.frame)
        return _found(scene, options, suggested_settings, exposure, progress)


def _found(scene, options, default_kind, exposure, progress):
    """A PageScene, and its kinds of shadow map. default_kind: of the extent of what throws shadows [m]."""
    import bpy

    from ..cycles_integration.shadow_page import page_scene
    from ..cycles_integration.shadow_preview import casters_of
    from ..cycles_integration.shadow_preview.casters import NOTHING_THROWS

    depsgraph = bpy.context.evaluated_depsgraph_get()
    with progress.step("scene"):
        points, _ = casters_of(depsgraph)
        if not len(points):
            raise ValueError(NOTHING_THROWS)
        extent = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
        kinds = _kinds(options, default_kind(extent), extent)
        return page_scene(
            scene, depsgraph, kinds, options.light_from, options.lights, options.camera, exposure
        ), kinds


def _kinds(options, default, extent):
    """The settings of the menu, the first shown first; what no option says is the default's."""
    given = (options.method, options.resolution, options.storage, options.window, options.penumbra)
    if all(value is None for value in given):
        return [default]
    choices = dict.fromkeys(  # each once
        product(
            options.method or (default.method,),
            options.resolution or (default.resolution,),
            options.storage or (default.storage,),
        )
    )
    if options.penumbra is not None:
        return [suggested_settings(extent, size, held, options.penumbra, how) for how, size, held in choices]
    window = options.window or max(default.window, 3)
    return [settings_with(window, size, held, how) for how, size, held in choices]


def _resized(camera, background, width):
    height = max(round(width * camera.height / camera.width), 1)
    if background.kind == "photo":
        image = cv2.resize(
            np.asarray(background.image, np.float32), (width, height), interpolation=cv2.INTER_AREA
        )
        background = replace(background, image=image)
    return replace(camera, width=width, height=height), background


def _result(output, found, kinds, camera, progress):
    scene = found.scene
    return {
        "file": str(output),
        "bytes": output.stat().st_size,
        "size": [camera.width, camera.height] if output.suffix.lower() in PICTURES else None,
        "background": found.background.kind,
        "exposure": float(found.background.exposure),
        "kinds": [label(kind) for kind in kinds],
        "lights": [_light(*one) for one in zip(found.light_names, scene.lights, strict=True)],
        "ambient": [float(value) for value in scene.ambient],
        "ambient_down": [float(value) for value in scene.from_below],
        "meshes": len(scene.meshes),
        "triangles": sum(len(mesh.triangles) for mesh in scene.meshes),
        "seconds": dict(progress.seconds),
        "warnings": list(found.warnings),
    }


def _light(name, light):
    camera = light.camera
    lamp = {"position": [float(value) for value in camera.eye]}
    sun = {"direction": [float(value) for value in -camera.axes[2]]}
    return {
        "name": name,
        **(lamp if camera.perspective else sun),
        "strength": [float(v) for v in light.strength],
    }


def describe(result):
    """A line for each light and kind of shadow map, and one for the file."""
    lines = []
    for light in result["lights"]:
        where = " ".join(f"{value:+.2f}" for value in light.get("position") or light["direction"])
        what = f"lamp at {where} m" if "position" in light else f"sun towards {where}"
        unit = "W/sr" if "position" in light else "W/m²"
        lines.append(
            f"{light['name']}: {what}, {' '.join(f'{value:.3g}' for value in light['strength'])} {unit}"
        )
    size = "" if result["size"] is None else "{} × {} px, ".format(*result["size"])
    amount = f"{result['meshes']} meshes, {result['triangles']} triangles"
    return [*lines, *result["kinds"], f"{result['file']}: {size}{amount}, {result['bytes'] / 1e6:.3g} MB"]
