"""`panorama render SET -o OUT.exr`: new objects in the place, seen by a camera or as a whole panorama."""

from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path

from ..ibl_toolkit.images import read_panorama
from . import blender
from .frames import frame_paths, is_complete
from .job import naming, open_job, place_in, rebuild, refuse_output
from .options import frame_range, light_limit, whole_number
from .progress import Progress

INPUT = "panorama set (.json)"
SUMMARY = "render objects into the place: through a camera, or the whole panorama"
OUTPUT, SUFFIX, NEEDS_OUTPUT = "OUT.exr", ".exr", True
METHODS = ("catcher", "single", "difference", "directional")
PANORAMA = "panorama"
MOST_PIXELS, MOST_SAMPLES = 65536, 2**24  # of Blender


@dataclass(frozen=True)
class RenderOptions:
    """The options of the verb, by the same names; None: its default.

    lights: the most that are taken out of the map, None for as many as there are.
    """

    objects: Path | None = None
    camera: str | None = None
    method: str = METHODS[0]
    lights: int | None = None
    width: int | None = None
    height: int | None = None
    samples: int = 64
    seed: int = 0
    denoise: bool = False
    frames: range | None = None


def add_options(parser):
    """Add the verb's own options."""
    add = parser.add_argument
    add("--objects", metavar="F.blend", type=Path, help="objects and cameras (default: the set's `objects`)")
    add("--camera", metavar="NAME|panorama", help="a camera of the objects' scene (default: its active one)")
    add("--method", choices=METHODS, default=METHODS[0], help="how objects and photograph meet")
    add("--lights", metavar="auto|none|N", type=light_limit, help="most lights to take out of the map (auto)")
    pixels = whole_number(4, MOST_PIXELS)
    add("--width", metavar="W", type=pixels, help="[px] (default: the objects' scene's; photograph's)")
    add("--height", metavar="H", type=pixels, help="[px] (default: follows from the width)")
    paths = whole_number(1, MOST_SAMPLES)
    add("--samples", metavar="N", type=paths, default=64, help="paths per pixel (default: 64)")
    add("--seed", metavar="S", type=whole_number(0), default=0, help="another gives other noise (default: 0)")
    add("--denoise", action="store_true", help="remove noise, and some detail with it")
    add("--frames", metavar="A-B[,STEP]", type=frame_range, help="frames; #### in OUT.exr is their number")


def run(set_path, output, options, progress):
    """Do the verb -> what `--json` prints."""
    given = {field.name: getattr(options, field.name) for field in fields(RenderOptions)}
    return render_set(set_path, output, RenderOptions(**given), progress)


def render_set(set_path, output, options=None, progress=None):
    """Render one picture or a range of frames of a set -> what was rendered, and the seconds of each step.

    Of a range, frames whose file is complete are left as they are; nothing is prepared if all are.
    """
    options, progress = options or RenderOptions(), progress or Progress()
    job = open_job(set_path)
    objects = Path(options.objects) if options.objects else job.set.objects
    paths = _output_paths(output, options.frames, (job.set.image, objects))
    if objects is not None and not objects.is_file():
        raise ValueError(f"{job.path}: objects: {objects}: no such file")
    pieces = rebuild(job)
    with progress.step("reading"):
        read_panorama(job.set.image)  # what Blender would show as it is, NaN too, is refused here
    with blender.empty_scene(progress) as scene:
        with progress.step("building"):
            place_in(scene, job, pieces)
            appended = _append(scene, objects)
        with _camera(scene, appended, options.camera, job, objects) as camera:
            return _render(scene, camera, _picture(camera, appended, job, options), paths, options, progress)


def _output_paths(output, frames, inputs):
    paths = frame_paths(output, frames)
    for path in paths.values():
        refuse_output(path, ".exr", inputs)
    return paths


def _append(scene, objects):
    if objects is None:
        return None
    from ..cycles_integration.objects_file import append_objects

    with blender.errors_of(objects):
        appended = append_objects(scene, objects)
    scene.frame_set(appended.frame)
    return appended


@contextmanager
def _camera(scene, appended, name, job, objects):
    if name == PANORAMA:
        from ..cycles_integration.rendering import panorama_camera

        with panorama_camera(scene) as camera:
            yield camera
    elif appended is None:
        raise ValueError(
            f"{job.path}: without objects there is no camera: give --objects F.blend, or --camera {PANORAMA}"
        )
    else:
        with naming(objects):
            camera = appended.camera(name)
        yield camera


def _picture(camera, appended, job, options):
    from ..cycles_integration.rendering import Picture

    default = job.image_size if options.camera == PANORAMA else appended.size
    width, height = picture_size(options.width, options.height, default)
    if options.camera == PANORAMA and width != 2 * height:
        raise ValueError(f"--width {width} --height {height}: a panorama must be twice as wide as high")
    return Picture(width, height, options.samples, options.seed, options.method, options.denoise)


def picture_size(width, height, default):
    """Width and height [px]; what is not given follows from the other, in the default's proportions.

    >>> picture_size(480, None, (1920, 1080)), picture_size(None, None, (1024, 512))
    ((480, 270), (1024, 512))
    """
    if width is None and height is None:
        return tuple(default)
    if height is None:
        return width, max(1, round(width * default[1] / default[0]))
    if width is None:
        return max(1, round(height * default[0] / default[1])), height
    return width, height


def _render(scene, camera, picture, paths, options, progress):
    from ..cycles_integration import preparation, rendering

    size = picture.width, picture.height
    missing = {n: path for n, path in paths.items() if n is None or not is_complete(path, size)}
    report = preparation.Preparation()
    if missing:
        with progress.step("preparing"):
            report = preparation.prepare(scene, options.lights)
        rendering.set_up_picture(scene, camera, picture)
        with progress.step("rendering", len(missing) * _samples(scene)):
            for number, path in missing.items():
                if number is not None:
                    scene.frame_set(number)
                with blender.errors_of(path):
                    rendering.write_render(scene, path)
    lights = report.at_infinity if picture.method == "directional" else report.at_depth
    return {
        "seconds": _seconds(progress.seconds, report.seconds),
        "method": picture.method,
        "samples": picture.samples,
        "seed": picture.seed,
        "size": list(size),
        "camera": options.camera or camera.name,
        "denoised": picture.denoise,
        "coverage": report.coverage,
        "lights": lights.count,
        "light_share": lights.share,
        "light_reason": lights.reason,
        "warnings": list(report.warnings),
        "frames": _frames(paths, missing),
    }


def _seconds(steps, preparation):
    """Seconds of each step in the order of the job; the preparation's own steps stand for it."""
    order = [(preparation if name == "preparing" else {name: spent}) for name, spent in steps.items()]
    return {name: spent for part in order for name, spent in part.items()}


def _samples(scene):
    """Samples of one picture, all of its view layers together."""
    return sum(layer.samples or scene.cycles.samples for layer in scene.view_layers if layer.use)


def _frames(paths, missing):
    if None in paths:
        return None
    before = [number for number in paths if number not in missing]
    return {"rendered": list(missing), "complete_before": before}


def describe(result):
    """One line, and one per step."""
    width, height = result["size"]
    how = f"{result['method']}, {result['samples']} samples, {result['lights']} lights"
    lines = [f"{width} × {height} px, {how}"]
    if result["frames"] is not None:
        done, before = (len(result["frames"][name]) for name in ("rendered", "complete_before"))
        lines.append(f"{done} frames rendered, {before} were complete before")
    return lines + [f"{name:<12}{spent:8.1f} s" for name, spent in result["seconds"].items()]
