"""Picture coordinates kept on a mesh: the position that each vertex had in the panorama's frame, and a UV
layer.

A stored position lets a piece of the place be moved, bent or duplicated and keep the picture it had (section
5.5.4). It is stored per vertex of the base mesh: modifiers interpolate it, so a Subdivision or Bevel keeps
the picture and an Array repeats it, and what a modifier or a shape key deforms is a change of the piece as it
was stored. Positions, not directions, because the look-up needs the depth too.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..ibl_toolkit.environment_uv import corner_uvs, uv_error_px
from ..ibl_toolkit.meshes import Mesh, transformed
from ..ibl_toolkit.uv_subdivision import subdivide_for_uv
from .lookup import STORED_POSITION
from .place import Place

UV_LAYER = "Panorama UV"
ROUNDING = 1e-6
LEAST_DISTANCE = 1e-5
"""[m] A vertex nearer to the panorama's origin has no direction."""


def has_stored_positions(thing: bpy.types.Object) -> bool:
    """Whether a mesh object keeps a picture of its own."""
    return STORED_POSITION in thing.data.attributes


def store_positions(place: Place, things: list[bpy.types.Object]):
    """Keep the part of the picture that each mesh object shows now, in the stead of one kept before.

    A mesh that several objects share becomes each one's own, since each shows another part. Raises ValueError
    naming an object that cannot be written or has a vertex at the panorama's origin; then nothing is stored.
    """
    stored = [(thing, _live_positions(place, _writable(thing))) for thing in things]
    for thing, positions in stored:
        if thing.data.users > 1:
            thing.data = thing.data.copy()
        _remove(thing.data)
        attribute = thing.data.attributes.new(STORED_POSITION, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", positions.astype(np.float32).ravel())
        thing.data.update()


def clear_positions(things: list[bpy.types.Object]) -> int:
    """Let the mesh objects show again what lies behind them; returns how many had a picture of their own."""
    kept = [_writable(thing) for thing in things if has_stored_positions(thing)]
    for thing in kept:
        if has_stored_positions(thing):  # meshes may be shared
            _remove(thing.data)
            thing.data.update()
    return len(kept)


def write_uv(place: Place, things: list[bpy.types.Object], max_error_px: float | None = 1.0) -> float:
    """Write the picture that mesh objects show as the UV layer `Panorama UV`; returns the largest error [px].

    The layer is linear on each face and the picture is not. Where its error is above ``max_error_px`` pixels
    of the image, or a pole of the image lies inside a face, the mesh is replaced by triangles small enough;
    other layers are then lost. None leaves the faces as they are.

    Raises ValueError, and writes nothing, where that is not possible: a pole inside a face that must stay, or
    a piece with stored positions that would have to be divided.
    """
    layers = [(thing, *_uv_layer(place, _writable(thing), max_error_px)) for thing in things]
    for thing, divided, uvs, _ in layers:
        if divided is not None:
            _replace_mesh(place, thing, divided)
        _write_layer(thing.data, uvs)
    return max(error_px for *_, error_px in layers)


def _uv_layer(place, thing, max_error_px):
    """(mesh in the panorama's frame to replace the object's or None, UV per face corner, error [px])."""
    stored = has_stored_positions(thing)
    positions = _stored_positions(thing.data) if stored else _live_positions(place, thing)
    # A vertex that an earlier division put on a pole is there but for rounding.
    at_pole = np.hypot(*positions[:, :2].T) < ROUNDING * np.abs(positions[:, 2])
    positions[at_pole, :2] = 0
    shown = Mesh(positions, tuple(tuple(p.vertices) for p in thing.data.polygons), np.eye(4))
    frame_and_height, width = (np.eye(3), 0.0), place.image.size[0]
    try:
        error_px = uv_error_px(shown, *frame_and_height, width)
        if max_error_px is None or error_px <= max_error_px:
            return None, corner_uvs(shown, *frame_and_height), error_px
        if not stored:
            divided = subdivide_for_uv(shown, *frame_and_height, width, max_error_px)
            return divided.mesh, divided.corner_uvs, divided.error_px
    except ValueError as error:
        raise ValueError(f"{thing.name!r}: {error}") from error
    raise ValueError(
        f"{thing.name!r}: its UV layer would be {error_px:.1f} pixels off, and a piece that keeps its "
        "picture is not divided: release the picture first, or leave the faces as they are"
    )


def panorama_from_local(place: Place, thing: bpy.types.Object) -> np.ndarray:
    """The transform (4, 4) from an object's vertices to the panorama's frame."""
    return np.array(place.origin.matrix_world.inverted() @ thing.matrix_world, dtype=np.float64)


def _live_positions(place, thing):
    """Vertices (V, 3) of the base mesh in the panorama's frame [m]."""
    matrix = panorama_from_local(place, thing)
    positions = transformed(matrix, _vectors(thing.data.vertices, "co"))
    if len(positions) and np.linalg.norm(positions, axis=1).min() < LEAST_DISTANCE:
        raise ValueError(f"{thing.name!r} has a vertex at the panorama's origin, where it shows nothing")
    return positions


def _stored_positions(mesh):
    return _vectors(mesh.attributes[STORED_POSITION].data, "vector")


def _vectors(collection, name):
    values = np.empty(3 * len(collection), np.float32)
    collection.foreach_get(name, values)
    return values.reshape(-1, 3).astype(np.float64)


def _writable(thing):
    if thing.type != "MESH":
        raise ValueError(f"{thing.name!r} is a {thing.type.lower()}, must be a mesh")
    if thing.data.library or thing.mode == "EDIT":
        raise ValueError(
            f"{thing.name!r}: its mesh is {'linked' if thing.data.library else 'in Edit Mode'}, "
            "so it cannot be written"
        )
    return thing


def _remove(mesh):
    attribute = mesh.attributes.get(STORED_POSITION)
    if attribute is not None:
        mesh.attributes.remove(attribute)


def _write_layer(mesh, uvs):
    layer = mesh.uv_layers.get(UV_LAYER) or mesh.uv_layers.new(name=UV_LAYER, do_init=False)
    layer.uv.foreach_set("vector", np.asarray(uvs, np.float32).ravel())
    mesh.uv_layers.active = layer
    mesh.update()


def _replace_mesh(place, thing, divided):
    """Give the object a mesh that is given in the panorama's frame; its materials stay."""
    local_from_panorama = np.linalg.inv(panorama_from_local(place, thing))
    if thing.data.users > 1:
        thing.data = thing.data.copy()
    thing.data.clear_geometry()
    vertices = transformed(local_from_panorama, divided.vertices)
    thing.data.from_pydata(vertices.tolist(), [], [list(face) for face in divided.faces])
