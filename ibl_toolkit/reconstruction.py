"""The shapes of a panorama set, rebuilt as meshes of the world from a calibrated panorama.

Source: thesis, section 5.5.1.
"""

from dataclasses import dataclass

import numpy as np

from . import floor_shapes, solids
from .meshes import Mesh
from .outlines import contains, overlap

LIFT_M = 0.001  # [m] between flat shapes that overlap on the floor, so that they do not flicker
FLAT_KINDS = ("polygon", "rectangle", "square", "circle")


class ReconstructionError(ValueError):
    """A shape that cannot be rebuilt from its picks; the message begins with its name."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A rebuilt shape.

    size_m: (x, y, z) along its own axes [m], z = 0 when flat. residual_m: how far its picks are from it [m].
    lift_m: how far a flat shape was lifted off the floor because it lies on others [m].
    """

    name: str
    kind: str
    role: str
    mesh: Mesh
    size_m: tuple[float, float, float]
    residual_m: float
    reflectivity: float
    roughness: float
    warnings: tuple[str, ...] = ()
    lift_m: float = 0.0

    def to_json(self):
        """What `panorama build --json` prints for this shape."""
        return {
            "name": self.name,
            "kind": self.kind,
            "role": self.role,
            "vertices": len(self.mesh.vertices),
            "faces": len(self.mesh.faces),
            "size": list(self.size_m),
            "residual": self.residual_m,
            "lift": self.lift_m,
            "warnings": list(self.warnings),
        }


def reconstruct(panorama_set, calibration, image_width=4096):
    """Rebuild all shapes of a set, in its order -> tuple of Piece.

    Circles and cylinders get as few sides as keep them within half a pixel of an image image_width pixels
    wide.
    Each flat shape that overlaps flat shapes before it is lifted by LIFT_M above the highest of them.

    Raises ReconstructionError, which names the shape and says what would be right.
    """
    tolerance = np.pi / image_width
    shapes = {shape.name: shape for shape in panorama_set.shapes}
    bases = {}
    for shape in panorama_set.shapes:
        if shape.kind != "walls":
            bases[shape.name] = _for_shape(shape, _base, shape, calibration, tolerance)
    for shape in panorama_set.shapes:
        if shape.kind == "walls":
            bases[shape.name] = _for_shape(shape, _named_base, shape, shapes, bases)
    lifts = _lifts(panorama_set.shapes, bases)
    return tuple(
        _for_shape(shape, _piece, shape, bases[shape.name], lifts.get(shape.name, 0.0), calibration)
        for shape in panorama_set.shapes
    )


def _for_shape(shape, function, *arguments):
    try:
        return function(*arguments)
    except ValueError as error:
        raise ReconstructionError(f"shape '{shape.name}' ({shape.kind}): {error}") from error


def _base(shape, calibration, tolerance):
    points = calibration.floor_point(shape.points)
    if shape.kind in ("rectangle", "box"):
        return floor_shapes.rectangle(points)
    if shape.kind == "square":
        return floor_shapes.square(points)
    if shape.kind == "circle":
        return floor_shapes.circle(points, calibration.camera_height, tolerance)
    if shape.kind == "cylinder":
        return floor_shapes.cylinder_base(points, calibration.camera_height, tolerance)
    if shape.kind == "polygon":
        return floor_shapes.polygon(points)
    raise ValueError(f"kind '{shape.kind}' is unknown")


def _named_base(shape, shapes, bases):
    if shape.of not in shapes or shapes[shape.of].kind not in FLAT_KINDS:
        names = (
            ", ".join(name for name, other in shapes.items() if other.kind in FLAT_KINDS) or "none there yet"
        )
        raise ValueError(f"of is '{shape.of}', must name a flat shape of the set ({names})")
    return bases[shape.of]


def _lifts(shapes, bases):
    """Height [m] of each flat shape: one level above the highest of those before it that it overlaps."""
    levels = {}
    flat = [shape.name for shape in shapes if shape.kind in FLAT_KINDS]
    for index, name in enumerate(flat):
        under = [
            levels[other] for other in flat[:index] if overlap(bases[name].outline, bases[other].outline)
        ]
        levels[name] = max(under, default=-1) + 1
    return {name: LIFT_M * level for name, level in levels.items()}


def _piece(shape, base, lift, calibration):
    if shape.kind in FLAT_KINDS:
        mesh, residual, notes = _lifted(base.mesh, lift), base.residual_m, base.warnings
        size = (*base.size_m, 0.0)
    else:
        height = _height(shape, base, calibration)
        mesh, notes = _solid(shape, base, height.height_m, calibration.camera_height)
        residual, notes = max(base.residual_m, height.deviation_m), (*base.warnings, *height.warnings, *notes)
        size = (*base.size_m, height.height_m)
    return Piece(
        name=shape.name,
        kind=shape.kind,
        role=shape.role,
        mesh=mesh,
        size_m=tuple(float(length) for length in size),
        residual_m=float(residual),
        reflectivity=shape.reflectivity,
        roughness=shape.roughness,
        warnings=tuple(notes),
        lift_m=lift,
    )


def _height(shape, base, calibration):
    if shape.height is not None:
        return solids.Height(float(shape.height))
    if shape.top is None:
        raise ValueError("has neither `top` nor `height`: give one")
    direction = calibration.world_direction(shape.top)
    if shape.kind == "box":
        first = calibration.floor_point(shape.points)[0]
        return solids.height_above_point(direction, first, calibration.camera_height)
    return solids.height_above_outline(direction, base, calibration.camera_height)


def _solid(shape, base, height, camera_height):
    inside = contains(base.outline, np.zeros(2))
    if shape.kind == "walls":
        notes = [] if inside else [f"the panorama stands outside of '{shape.of}', so outside of these walls"]
        if inside and shape.ceiling and height <= camera_height:
            raise ValueError(
                f"the ceiling at {height:.3f} m is not above the panorama at {camera_height:.3f} m"
            )
        return solids.walls(base, height, bool(shape.ceiling)), notes
    if inside and height >= camera_height:
        raise ValueError(
            f"{height:.3f} m high over the point below the panorama: the panorama would be inside it"
        )
    build = solids.box if shape.kind == "box" else solids.cylinder
    return build(base, height), []


def _lifted(mesh, lift):
    matrix = mesh.world_from_local.copy()
    matrix[2, 3] = lift
    return Mesh(mesh.vertices, mesh.faces, matrix)
