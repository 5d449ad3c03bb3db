"""How far the work on a scene's panorama is: for each step what is missing, "" where nothing is."""

from mathutils import Vector

from ..cycles_integration import picture_coordinates, roles
from ..cycles_integration.methods import DIRECTIONAL
from ..cycles_integration.pieces import PIECE
from ..cycles_integration.place import is_here
from . import conversion

ORIENTING = ("RECTANGLE", "PARALLELS", "VERTICAL")


def image_missing(scene) -> str:
    """What step 1 still needs."""
    return "" if scene.panorama_set.image_path else "Open a panorama first"


def picks_missing(scene) -> str:
    """What step 2 needs before it can be solved."""
    return missing_of(scene.panorama_set)


def missing_of(state) -> str:
    """The same of a set, or of the copy of one that a tool edits."""
    if not state.image_path:
        return "Open a panorama first"
    if not any(pick.kind in ORIENTING for pick in state.picks):
        return "Add a rectangle, floor lines or verticals, or import a set"
    try:
        picks = conversion.picks_from_state(state)
    except ValueError as error:
        return str(error)
    if picks.camera_height is None and picks.length is None:
        return "Give the camera height or a known length"
    return ""


def calibration_missing(scene) -> str:
    """What step 2 lacks for those after it."""
    place = scene.panorama_place
    done = scene.panorama_set.result.is_solved and place.image and place.origin and is_here(place)
    return "" if done else "Calibrate first"


def drawing_missing(scene) -> str:
    """What must be there before a shape can be drawn on the floor and built."""
    if calibration_missing(scene) or picks_missing(scene):
        return calibration_missing(scene) or picks_missing(scene)
    if scene.panorama_set.calibration_is_old:
        return "The picks have changed: calibrate again"
    return "" if scene.panorama_set.image else "The panorama's image is gone: open it again"


def shapes_missing(scene) -> str:
    """What step 3 needs before it can be built."""
    if picks_missing(scene):
        return picks_missing(scene)
    state = scene.panorama_set
    if not state.shapes:
        return "Add a shape: the floor first, then what stands on it"
    try:
        conversion.shapes_from_state(state)
    except ValueError as error:
        return str(error)
    return ""


def surfaces_missing(scene) -> str:
    """What the light of step 5 needs of the steps before it."""
    if calibration_missing(scene):
        return calibration_missing(scene)
    return "" if roles.real_objects(scene) else "Build shapes first, or give objects a role"


def maps_missing(scene) -> str:
    """What step 6 needs of step 5."""
    if surfaces_missing(scene):
        return surfaces_missing(scene)
    return "" if scene.panorama_place.irradiance else "Prepare the light first"


def camera_missing(scene) -> str:
    """What a picture through the scene's camera needs."""
    return maps_missing(scene) or ("" if scene.camera else "Add a camera")


def next_step(scene) -> str:
    """The next thing to do, in one line."""
    state = scene.panorama_set
    if image_missing(scene):
        return f"Step 1: {image_missing(scene)}"
    if calibration_missing(scene) or state.calibration_is_old:
        return f"Step 2: {picks_missing(scene) or 'Calibrate'}"
    if not roles.real_objects(scene) or state.shapes_are_old:
        return f"Step 3: {shapes_missing(scene) or 'Build the shapes'}"
    if not new_objects(scene):
        return "Step 4: Add new objects, such as a mirror ball"
    if maps_missing(scene) or state.maps_are_old:
        return "Step 5: Prepare the light"
    return "Step 6: Render" if scene.camera else "Step 6: Add a camera"


def new_objects(scene) -> list:
    """The new meshes of the scene: what is to be put into the place."""
    return [o for o in scene.objects if o.type == "MESH" and o.panorama_role == roles.SYNTHETIC]


def lights_found(scene) -> str:
    """What became lights for the chosen method, and why."""
    job = scene.panorama_set.job
    return job.lights_at_infinity if job.method == DIRECTIONAL else job.lights_at_depth


def own_lights(scene) -> list:
    """The artist's own lights, which light new objects beside those of the place."""
    ours = scene.panorama_place.suns
    return [o for o in scene.objects if o.type == "LIGHT" and not (ours and o.name in ours.objects)]


def around_origin(scene) -> str:
    """Name of a new object within whose bounds the panorama was captured, as Blender's first cube is."""
    if calibration_missing(scene):
        return ""
    origin = scene.panorama_place.origin.matrix_world.translation
    return next((o.name for o in new_objects(scene) if _within_bounds(o, origin)), "")


def _within_bounds(thing, point):
    if not all(thing.dimensions):
        return False
    local = thing.matrix_world.inverted_safe() @ point
    corners = [Vector(corner) for corner in thing.bound_box]
    return all(min(c[i] for c in corners) < local[i] < max(c[i] for c in corners) for i in range(3))


def surface_counts(scene) -> list[tuple[str, int]]:
    """How many surfaces have each of the real roles."""
    return [
        (name, len(roles.with_role(scene, role))) for role, name, _ in roles.ROLES if role != roles.SYNTHETIC
    ]


def is_real(thing) -> bool:
    """Whether an object stands for a real surface."""
    return thing is not None and thing.type == "MESH" and thing.panorama_role != roles.SYNTHETIC


def is_own_support(thing) -> bool:
    """Whether an object is a support that no shape of the set describes."""
    return is_real(thing) and thing.panorama_role == roles.SUPPORT and PIECE not in thing


def keeps_picture(thing) -> bool:
    """Whether a real surface keeps the part of the picture that it once had."""
    return picture_coordinates.has_stored_positions(thing)


def selected_meshes(context) -> list:
    """The selected meshes."""
    return [o for o in context.selected_objects if o.type == "MESH"]


def selection_missing(context) -> str:
    """What an operator on the selected meshes needs."""
    if context.mode != "OBJECT":
        return "Only in Object Mode"
    return "" if selected_meshes(context) else "Select mesh objects first"
