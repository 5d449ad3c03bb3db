"""Calibration and reconstruction of a scene's panorama set: first everything is computed, then the scene
changes.

So a refusal leaves the scene as it was, and picture, origin and rebuilt shapes always move together.
"""

from ..cycles_integration import blender_images
from ..cycles_integration.pieces import PIECE, built_pieces, update_pieces
from ..cycles_integration.place import create_place
from ..ibl_toolkit.calibration import calibrate
from ..ibl_toolkit.images import read_panorama
from ..ibl_toolkit.panorama_set import PanoramaSet
from ..ibl_toolkit.reconstruction import reconstruct
from . import conversion, viewing

RESULT_FIELDS = (
    "camera_height",
    "tilt_deg",
    "residual_deg",
    "uncertainty_tilt_deg",
    "uncertainty_scale_percent",
    "condition",
)


def load_panorama(path):
    """Load an image that is fit to be a panorama. Raises ValueError or OSError naming file and value."""
    read_panorama(path)
    try:
        return blender_images.load_radiance(str(path))
    except RuntimeError as error:
        raise ValueError(f"{path}: Blender cannot load it: {error}") from error


def calibrate_scene(scene):
    """Calibrate, and take along what is built already -> Calibration."""
    return _solve(scene, _built_names(scene))


def build_scene(scene):
    """Calibrate and (re)build all shapes -> Calibration."""
    if not scene.panorama_set.shapes:
        raise ValueError("no shapes: add one first")
    return _solve(scene, None)


def add_shapes(scene, shapes):
    """Append shapes to the set and build them, beside those built already -> Calibration.

    Raises ValueError or OSError where that fails; the set is then as it was.
    """
    state = scene.panorama_set
    before = len(state.shapes), state.shapes_are_old
    for shape in shapes:
        conversion.append_shape(state, shape)
    names = {name for shape in shapes for name in (shape.name, shape.of) if name}
    try:
        calibration = _solve(scene, _built_names(scene) | names)
    except (ValueError, OSError):
        for index in reversed(range(before[0], len(state.shapes))):
            state.shapes.remove(index)
        state.shapes_are_old = before[1]
        raise
    state.shapes_are_old = not all(shape.is_built for shape in state.shapes)
    state.active_shape = len(state.shapes) - 1
    return calibration


def follow_camera_height(scene):
    """Scale the place with the camera height; what is wrong with it is kept for the panel to show."""
    state = scene.panorama_set
    if not state.result.is_solved:
        return
    try:
        calibrate_scene(scene)
    except (ValueError, OSError) as error:
        state.problem, state.calibration_is_old = str(error), True


def _solve(scene, names):
    state = scene.panorama_set
    if not state.image_path:
        raise ValueError("no panorama: open an image first")
    there = state.image is not None and state.image.size[0]  # its file may be gone since
    image = state.image if there else load_panorama(conversion.image_path(state))
    calibration = calibrate(conversion.picks_from_state(state), tuple(image.size))
    shapes = conversion.shapes_from_state(state, names)
    panorama_set = PanoramaSet(conversion.image_path(state), None, shapes)
    pieces = reconstruct(panorama_set, calibration, image.size[0])
    state.image = image
    place = create_place(scene, str(panorama_set.image), calibration)
    update_pieces(place, pieces)
    _note_calibration(state, calibration)
    _note_pieces(state, pieces)
    viewing.follow_origin(scene)
    state.shapes_are_old = names is not None and state.shapes_are_old
    return calibration


def _built_names(scene):
    return {thing[PIECE] for thing in built_pieces(scene.panorama_place)}


def _note_calibration(state, calibration):
    for field in RESULT_FIELDS:
        setattr(state.result, field, getattr(calibration, field))
    state.result.warnings = "\n".join(calibration.warnings)
    state.result.is_solved = True
    state.problem, state.calibration_is_old, state.maps_are_old = "", False, True


def _note_pieces(state, pieces):
    built = {piece.name: piece for piece in pieces}
    for shape in state.shapes:
        piece = built.get(shape.name)
        shape.is_built = piece is not None
        if piece is not None:
            shape.size, shape.residual = piece.size_m, piece.residual_m
            shape.warnings = "\n".join(piece.warnings)
