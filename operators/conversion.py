"""The panorama set of a scene to and from the set that the mathematics and the files know."""

from pathlib import Path

import bpy
import numpy as np

from ..ibl_toolkit.calibration import CalibrationPicks, KnownLength, Parallels, Rectangle
from ..ibl_toolkit.panorama_set import POINTS, SOLIDS, PanoramaSet, Shape, set_from_dict, set_to_dict


def set_from_state(state) -> PanoramaSet:
    """Return the scene's set. Raises ValueError naming what is missing or wrong."""
    if not state.image_path:
        raise ValueError("no panorama: open an image first")
    objects = Path(bpy.path.abspath(state.objects_path)) if state.objects_path else None
    return PanoramaSet(image_path(state), picks_from_state(state), shapes_from_state(state), objects)


def image_path(state) -> Path:
    """Return the panorama's absolute path."""
    return Path(bpy.path.abspath(state.image_path))


def picks_from_state(state) -> CalibrationPicks:
    """Return what calibrates. Raises ValueError naming a point that is not picked yet."""
    rectangles, parallels, verticals, lengths = [], [], [], []
    for index, pick in enumerate(state.picks):
        points = _points(pick.points, pick_label(pick, index))
        if pick.kind == "RECTANGLE":
            rectangles.append(Rectangle(points, pick.plane))
        elif pick.kind == "PARALLELS":
            parallels.append(Parallels(pick.axis, points.reshape(-1, 2, 2)))
        elif pick.kind == "VERTICAL":
            verticals.append(points)
        else:
            lengths.append(KnownLength(points, number(pick.metres)))
    height = number(state.camera_height) if state.camera_height > 0 and not lengths else None
    return CalibrationPicks(
        tuple(rectangles),
        tuple(parallels),
        np.array(verticals).reshape(-1, 2, 2),
        height,
        next(iter(lengths), None),
    )


def shapes_from_state(state, names=None) -> tuple[Shape, ...]:
    """Return the shapes, all or those with these names. Raises ValueError naming what is wrong with one."""
    shapes = tuple(_shape(item) for item in state.shapes if names is None or item.name in names)
    # The set file's own checks hold here too: names that differ, tops or heights, a base for walls.
    checked = set_to_dict(PanoramaSet(image_path(state), CalibrationPicks(), shapes), Path())
    return set_from_dict(checked, Path()).shapes


def state_from_set(state, panorama_set: PanoramaSet):
    """Replace the scene's set. The calibration is to be done again, so nothing moves yet."""
    state.result.is_solved = False
    state.problem = ""
    state.image, state.image_path = None, str(panorama_set.image)
    state.objects_path = "" if panorama_set.objects is None else str(panorama_set.objects)
    _fill_picks(state, panorama_set.calibration)
    state.shapes.clear()
    for shape in panorama_set.shapes:
        append_shape(state, shape)
    state.active_pick = state.active_shape = 0
    state.calibration_is_old = state.shapes_are_old = False


def pick_label(pick, index) -> str:
    """How a pick is called in lists and messages."""
    names = {
        "RECTANGLE": f"{pick.plane.title()} rectangle",
        "PARALLELS": f"Floor lines along {pick.axis}",
        "VERTICAL": "Vertical",
        "LENGTH": "Known length",
    }
    return f"{index + 1}: {names[pick.kind]}"


def point_labels(item) -> list[str]:
    """How the points of a pick or shape are called, in order."""
    if item.kind in ("PARALLELS", "VERTICAL", "LENGTH"):
        several = len(item.points) > 2
        return [
            f"Line {i // 2 + 1} {end}" if several else end
            for i, end in zip(range(len(item.points)), ("start", "end") * len(item.points), strict=False)
        ]
    return [f"Point {i + 1}" for i in range(len(item.points))]


def number(value) -> float:
    """The shortest decimal that a single-precision property stands for: 1.32, not 1.3200000524520874."""
    return float(np.format_float_positional(np.float32(value), unique=True))


def set_point(point, uv):
    """Store a pick (2,)."""
    point.uv = [float(value) for value in uv]


def _points(points, label):
    missing = [i + 1 for i, point in enumerate(points) if not point.picked]
    if missing:
        raise ValueError(f"{label}: point {missing[0]} of {len(points)} is not picked")
    return np.array([[number(value) for value in point.uv] for point in points]).reshape(-1, 2)


def _shape(item):
    label = f"shape '{item.name}'"
    known = {"name": item.name, "kind": item.kind, "role": item.role}
    if item.kind == "walls":
        known["of"] = item.of or None
        if not item.of:
            raise ValueError(f"{label}: name the flat shape over which the walls stand")
        known["ceiling"] = item.ceiling
    else:
        known["points"] = _points(item.points, label)
    if item.kind in SOLIDS:
        if item.has_height:
            known["height"] = number(item.height)
        elif item.top.picked:
            known["top"] = np.array([number(value) for value in item.top.uv])
        else:
            raise ValueError(f"{label}: pick a point of its upper edge, or give its height")
    if item.role == "SUPPORT":
        known["reflectivity"], known["roughness"] = number(item.reflectivity), number(item.roughness)
    return Shape(**known)


def _fill_picks(state, calibration):
    state.picks.clear()
    for rectangle in calibration.rectangles:
        add_pick(state, "RECTANGLE", rectangle.points).plane = rectangle.plane
    for parallels in calibration.parallels:
        add_pick(state, "PARALLELS", parallels.lines.reshape(-1, 2)).axis = parallels.axis
    for vertical in calibration.verticals:
        add_pick(state, "VERTICAL", vertical)
    if calibration.length is not None:
        add_pick(state, "LENGTH", calibration.length.points).metres = calibration.length.metres
    state.camera_height = calibration.camera_height or 0


def add_pick(state, kind, points=None):
    """Append a pick, its points still to be picked where none are given."""
    pick = state.picks.add()
    pick.kind = kind
    _add_points(pick.points, 4 if kind == "RECTANGLE" else 2, points)
    return pick


def free_name(state, wanted) -> str:
    """Return a name that no shape has: as wanted, or with a number."""
    taken = {shape.name for shape in state.shapes}
    names = (wanted if n == 1 else f"{wanted} {n}" for n in range(1, len(taken) + 2))
    return next(name for name in names if name not in taken)


def add_shape(state, kind, name):
    """Append a shape whose points are still to be picked."""
    shape = state.shapes.add()
    shape.name, shape.kind = name, kind
    _add_points(shape.points, POINTS[kind][0])
    return shape


def append_shape(state, shape):
    """Append a shape of a set."""
    item = state.shapes.add()
    item.name, item.kind, item.role, item.of = shape.name, shape.kind, shape.role, shape.of or ""
    _add_points(item.points, 0, () if shape.points is None else shape.points)
    item.has_height = shape.height is not None
    item.height = shape.height or 0
    if shape.top is not None:
        set_point(item.top, shape.top)
    item.ceiling = shape.ceiling
    item.reflectivity, item.roughness = shape.reflectivity, shape.roughness


def _add_points(collection, count, points=None):
    for index in range(count if points is None else len(points)):
        point = collection.add()
        if points is not None:
            set_point(point, points[index])
