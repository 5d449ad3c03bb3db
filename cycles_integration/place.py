"""The captured place in a Blender scene: its panorama, its origin, and its rebuilt surfaces.

One Empty at the panorama's origin carries the calibration. Every material looks the photograph up through it,
so turning or lifting that Empty moves the picture on all surfaces at once (section 5.5.4).
"""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from . import blender_images, roles

ORIGIN = "Panorama Origin"
CATCHER = "Panorama Catcher"
"""An Empty that instances the real surfaces as shadow catchers; the surfaces themselves stay visible, for the
backplate and for the artist's viewport."""


def _pointer(kind, description):
    return bpy.props.PointerProperty(type=kind, description=description)


class Place(bpy.types.PropertyGroup):
    """What a scene knows of its captured place; everything here is derived and can be made again."""

    key: bpy.props.StringProperty(
        description="What this place's own data-blocks are named after", options={"HIDDEN"}
    )
    collection: _pointer(bpy.types.Collection, "All that the panorama made in this scene")
    surfaces: _pointer(bpy.types.Collection, "The real surfaces")
    support: _pointer(bpy.types.Collection, "Real surfaces that receive shadows and reflections")
    environment: _pointer(bpy.types.Collection, "Real surfaces that only show and light")
    lights: _pointer(bpy.types.Collection, "The photograph's lamps on the surfaces")
    suns: _pointer(bpy.types.Collection, "The photograph's lamps at infinity")
    catchers: _pointer(bpy.types.Collection, "The surfaces once more, as shadow catchers")
    origin: _pointer(bpy.types.Object, "Where the panorama was captured, and how it was turned")
    catcher: _pointer(bpy.types.Object, "What instances the surfaces as shadow catchers")
    image: _pointer(bpy.types.Image, "The photograph")
    residual: _pointer(bpy.types.Image, "The photograph without its lamps on the surfaces")
    irradiance: _pointer(bpy.types.Image, "The light that falls on the real surfaces")
    gloss: _pointer(bpy.types.Image, "What the photograph shows mirrored in glossy surfaces")
    sky: _pointer(bpy.types.Image, "The part of the photograph that no surface covers")
    sun_residual: _pointer(bpy.types.Image, "The photograph without its lamps at infinity")
    sun_quiet: _pointer(bpy.types.Image, "The same, of low resolution")
    plate: _pointer(bpy.types.Image, "The photograph in the size of a panorama picture")


def place_of(scene: bpy.types.Scene) -> Place:
    """Return the scene's place, whole again where parts of it were deleted; ValueError where it has none."""
    place = scene.panorama_place
    if place.image is None or place.origin is None or not is_here(place):
        raise ValueError(f"scene {scene.name!r} has no panorama: calibrate one first")
    _complete(place)
    return place


def place_in(scene: bpy.types.Scene) -> Place | None:
    """The scene's place as it stands, or None where it has none."""
    place = getattr(scene, "panorama_place", None)
    return place if place is not None and place.origin is not None and is_here(place) else None


def is_here(place: Place) -> bool:
    """Whether a place stands in its scene: one made with the settings of another only knows of its place."""
    return place.collection in place.id_data.collection.children_recursive


def create_place(scene: bpy.types.Scene, image_path: str, calibration) -> Place:
    """Give the scene a panorama (or another one) and set its calibration."""
    place = scene.panorama_place
    if not is_here(place):
        for pointer in place.bl_rna.properties:
            place.property_unset(pointer.identifier)
        place.collection = _child_collection(scene.collection, "Panorama")
    place.image = blender_images.load_radiance(image_path)
    if place.origin is None:
        place.origin = bpy.data.objects.new(ORIGIN, None)
        place.origin.empty_display_type, place.origin.empty_display_size = "ARROWS", 0.2
    _complete(place)
    set_calibration(place, calibration.world_from_panorama, calibration.camera_height)
    return place


PARTS = (
    ("surfaces", "Panorama Surfaces", "collection"),
    ("support", "Panorama Support", "surfaces"),
    ("environment", "Panorama Environment", "surfaces"),
    ("lights", "Panorama Lamps", "surfaces"),
    ("suns", "Panorama Suns", "collection"),
    ("catchers", "Panorama Catchers", "collection"),
)
"""The collections of a place, what they are called, and in which one each lies."""


def _complete(place):
    """Make what an artist may have deleted in the Outliner, or what is not there yet."""
    scene = place.id_data
    for part, name, parent in PARTS:
        collection, parent = getattr(place, part), getattr(place, parent)
        if collection is None:
            setattr(place, part, _child_collection(parent, name))
        elif collection not in scene.collection.children_recursive:  # what it lay in was deleted
            parent.children.link(collection)
    if place.catcher is None:
        place.catcher = bpy.data.objects.new(CATCHER, None)
        place.catcher.instance_type, place.catcher.is_shadow_catcher = "COLLECTION", True
        place.catcher.hide_viewport = True
    for thing, collection in ((place.origin, place.collection), (place.catcher, place.catchers)):
        if not thing.users_collection:  # deleted from the scene, it is kept by the place alone
            collection.objects.link(thing)


def own_name(place: Place, name: str) -> str:
    """Return the name of a data-block of this place alone.

    A file may hold several places, and scenes are renamed and copied: so the place keeps the name that its
    scene had first, and a scene made as a copy takes another one.
    """
    scene = place.id_data
    others = [other for other in bpy.data.scenes if other != scene]
    taken = {other.panorama_place.key for other in others if not _is_copy_of(scene, other)}
    if not place.key or place.key in taken:
        names = (scene.name if n == 1 else f"{scene.name} {n}" for n in range(1, len(others) + 2))
        every = {other.panorama_place.key for other in others}
        place.key = next(key for key in names if key not in every)
    return f"{name} ({place.key})"


def _is_copy_of(scene, other):
    """Whether ``other`` is the copy if one is made of the other: Blender lengthens the name."""
    return (len(other.name), other.name) > (len(scene.name), scene.name)


def set_calibration(place: Place, world_from_panorama: np.ndarray, camera_height: float):
    """Put the origin at (0, 0, camera_height) [m] with the panorama's orientation."""
    rotation = Matrix(np.asarray(world_from_panorama).tolist()).to_4x4()
    place.origin.matrix_world = Matrix.Translation((0, 0, camera_height)) @ rotation


def sort_objects(scene: bpy.types.Scene, place: Place):
    """Move every real mesh into the collection of its role, and new objects out of there.

    View layers leave out whole collections, never single objects; so roles have collections of their own.
    Raises ValueError, and moves nothing, where a real mesh is linked from another file.
    """
    roles.refuse_linked_surfaces(scene)
    inside = {scene.collection, *scene.collection.children_recursive}
    _refuse_linked_collections(roles.real_objects(scene), inside)
    collections = {roles.SUPPORT: place.support, roles.ENVIRONMENT: place.environment}
    for thing in roles.real_objects(scene):
        _move(thing, collections[thing.panorama_role], inside)
    ours = {scene.collection, place.collection, *place.collection.children_recursive}
    for thing in list(scene.objects):
        if thing.type == "MESH" and thing.panorama_role != roles.SYNTHETIC:
            continue
        if thing in (place.origin, place.catcher) or place.suns in thing.users_collection:
            continue
        strays = ours.intersection(thing.users_collection)
        if strays == inside.intersection(thing.users_collection):
            _move(thing, _synthetic_collection(scene), inside)
        for collection in strays.intersection(thing.users_collection):
            collection.objects.unlink(thing)


def _refuse_linked_collections(things, inside):
    """What lies in a collection of another file cannot be taken out of it."""
    for thing in things:
        for collection in inside.intersection(thing.users_collection):
            if not _is_own(collection):
                raise ValueError(
                    f"'{thing.name}' lies in the collection '{collection.name}' of another file, so it "
                    "cannot be sorted by its role: make the collection local, or the object synthetic"
                )


def _move(thing, collection, inside):
    """Move an object within a scene, of which these are the collections; other scenes keep it."""
    if collection not in thing.users_collection:
        collection.objects.link(thing)
    for other in inside.intersection(thing.users_collection) - {collection}:
        other.objects.unlink(thing)


def _synthetic_collection(scene):
    existing = (c for c in scene.collection.children if c.name.startswith("Synthetic") and _is_own(c))
    return next(existing, None) or _child_collection(scene.collection, "Synthetic")


def _is_own(collection: bpy.types.Collection) -> bool:
    """Whether a collection belongs to this file alone, so that objects can be put in and taken out."""
    return collection.library is None and collection.override_library is None


def _child_collection(parent, name):
    collection = bpy.data.collections.new(name)
    parent.children.link(collection)
    return collection


def register():
    """Give every scene its place."""
    bpy.utils.register_class(Place)
    bpy.types.Scene.panorama_place = _pointer(Place, "The captured place as it stands in this scene")


def unregister():
    """Take it back."""
    del bpy.types.Scene.panorama_place
    bpy.utils.unregister_class(Place)
