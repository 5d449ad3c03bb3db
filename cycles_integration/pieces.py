"""The rebuilt surfaces as Blender objects; brought up to date, they stay the objects they were."""

from __future__ import annotations

import bpy
from mathutils import Matrix

from .picture_coordinates import has_stored_positions
from .place import Place

PIECE = "panorama_piece"
"""Custom property of an object: the shape of the set that it was built from."""


def update_pieces(place: Place, pieces) -> list[bpy.types.Object]:
    """Build the pieces of a reconstruction, or bring those already built up to date.

    A piece that keeps its picture is left as it is, since an artist has made something of it. Pieces that the
    reconstruction no longer names are removed. Returns the objects built.
    """
    _release_duplicates(place)
    kept = {thing[PIECE] for thing in kept_pieces(place)}
    before = {thing[PIECE]: thing for thing in built_pieces(place) if not has_stored_positions(thing)}
    wanted = [piece for piece in pieces if piece.name not in kept or piece.name in before]
    built = [_update_piece(place, before.pop(piece.name, None), piece) for piece in wanted]
    for thing in before.values():
        bpy.data.objects.remove(thing)
    return built


def built_pieces(place: Place) -> list[bpy.types.Object]:
    """Return the objects that were built from shapes."""
    return [thing for thing in place.surfaces.all_objects if PIECE in thing] if place.surfaces else []


def kept_pieces(place: Place) -> list[bpy.types.Object]:
    """Return the built pieces that keep their picture."""
    return [thing for thing in built_pieces(place) if has_stored_positions(thing)]


def _release_duplicates(place):
    """Of several objects with live pictures that call themselves one piece, the one with its name is it."""
    live = [thing for thing in built_pieces(place) if not has_stored_positions(thing)]
    owners = {}
    for thing in sorted(live, key=lambda o: o.name != o[PIECE]):
        if owners.setdefault(thing[PIECE], thing) != thing:
            del thing[PIECE]


def _update_piece(place, thing, piece):
    if thing is None:
        thing = bpy.data.objects.new(piece.name, bpy.data.meshes.new(piece.name))
        thing[PIECE] = piece.name
        place.surfaces.objects.link(thing)
    thing.data.clear_geometry()
    thing.data.from_pydata(piece.mesh.vertices.tolist(), [], [list(face) for face in piece.mesh.faces])
    thing.matrix_world = Matrix(piece.mesh.world_from_local.tolist())
    thing.panorama_role = piece.role
    thing.panorama_reflectivity, thing.panorama_roughness = piece.reflectivity, piece.roughness
    thing.display_type = "WIRE"  # the photograph behind it shows how it looks; Cycles renders it all the same
    return thing
