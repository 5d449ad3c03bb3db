"""Whether a place is still what it was: a digest of what its light is measured from."""

from __future__ import annotations

import hashlib
import os

import bpy
import numpy as np

from . import roles
from .lookup import STORED_POSITION
from .place import place_of


def digest_of_place(scene: bpy.types.Scene) -> str:
    """The same text for as long as picture, calibration and real surfaces of the scene's place stay.

    New objects are not in it, and of modifiers only which there are. Raises ValueError where the scene has no
    place.
    """
    place = place_of(scene)
    found = hashlib.sha1(usedforsecurity=False)

    def note(*values):
        for value in values:
            found.update(value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode())

    note(digest_of_image(scene), np.array(place.origin.matrix_world))
    for thing in sorted(roles.real_objects(scene), key=lambda o: o.name_full):
        note(thing.name_full, thing.panorama_role, thing.panorama_reflectivity, thing.panorama_roughness)
        note(thing.hide_render, np.array(thing.matrix_world), _points(thing.data), len(thing.data.polygons))
        note([(modifier.type, modifier.show_render) for modifier in thing.modifiers])
        note(STORED_POSITION in thing.data.attributes)
    return found.hexdigest()


def digest_of_image(scene: bpy.types.Scene) -> str:
    """The same text for as long as the place has the same panorama."""
    image = place_of(scene).image
    path = os.path.normpath(bpy.path.abspath(image.filepath, library=image.library))
    return repr((image.name_full, path))  # its size would have it loaded


def _points(mesh):
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    return points
