"""What `panorama layers` does for each kind of input: functions of (path, options, progress) -> panorama."""

from contextlib import ExitStack, contextmanager

from ..ibl_toolkit.images import read_rgbd
from ..ibl_toolkit.layers.files.storage import read_layers
from ..ibl_toolkit.layers.making.from_points import layers_from_points
from ..ibl_toolkit.layers.making.from_rgbd import layers_of
from ..ibl_toolkit.layers.making.from_shots import layers_from_shots
from ..ibl_toolkit.layers.making.ply import read_ply
from ..ibl_toolkit.layers.making.shots import read_shots
from . import blender
from .job import naming, open_job, place_in, rebuild

SAMPLES, WIDTH, MOST = 64, 2048, 4


def from_rgbd(path, options, progress):
    """Split an RGB-D panorama."""
    with progress.step("reading"):
        rgbd = read_rgbd(path, frame_needed=False)
    with progress.step("layers"), naming(path):
        return layers_of(rgbd, options.radius, options.layers)


def from_points(path, options, progress):
    """Layers of a cloud of points."""
    with progress.step("reading"):
        cloud = read_ply(path)
    origin = options.origin or (0.0, 0.0, 0.0)
    width = options.width or WIDTH
    with progress.step("layers"), naming(path):
        return layers_from_points(
            cloud.points, cloud.colours, origin, width, options.radius, count=options.layers
        )


def from_shots(path, options, progress):
    """Layers of RGB-D shots."""
    with progress.step("reading"):
        shots = read_shots(path)
    with progress.step("layers"), naming(path):
        return layers_from_shots(
            shots, options.width or WIDTH, options.radius, origin=options.origin, count=options.layers
        )


def from_folder(path, options, progress):
    """Layers that are there, to be sorted or stored in another way."""
    with progress.step("reading"):
        return read_layers(path)


def from_set(path, options, progress):
    """Rebuild the place of a set and render it, with the photograph on all of it."""
    job = open_job(path)
    pieces = rebuild(job)
    with blender.empty_scene(progress) as scene, naming(path):
        from ..cycles_integration.place_layers import capture_place

        place_in(scene, job, pieces)
        with _steps(progress) as tell:
            return _split(capture_place(scene, options.radius, _capture(options), tell), options, tell)


def from_scene(path, options, progress):
    """Render a scene: its surfaces, or its collections."""
    with open(path, "rb"):  # Blender's own complaint is long
        pass
    with blender.opened_scene(path, progress) as scene, naming(path):
        from ..cycles_integration.collection_layers import capture_collections
        from ..cycles_integration.layer_capture import capture_surfaces
        from ..cycles_integration.layer_scene import frame_of

        frame = frame_of(scene, options.origin)
        if options.collections:
            with progress.step("rendering"):
                return capture_collections(
                    scene, frame, options.radius, _capture(options), options.collections
                )
        with _steps(progress) as tell:
            return _split(
                capture_surfaces(scene, frame, options.radius, _capture(options), tell), options, tell
            )


def _split(captured, options, tell):
    """Successive surfaces as continuous layers, unless they are wanted as they are."""
    if options.surfaces:
        return captured
    from ..cycles_integration.layer_capture import split_surfaces

    tell("splitting")
    return split_surfaces(captured, options.layers)


@contextmanager
def _steps(progress):
    """A function that ends the step before and begins that of a name."""
    with ExitStack() as stack:

        def tell(name):
            stack.close()
            stack.enter_context(progress.step(name))

        yield tell


def _capture(options):
    from ..cycles_integration.layer_render import LayerCapture

    def given(value, default):
        return default if value is None else value

    return LayerCapture(
        width=given(options.width, WIDTH),
        samples=given(options.samples, SAMPLES),
        most=given(options.layers, MOST),
        denoise=options.denoise,
        seed=options.seed or 0,
    )
