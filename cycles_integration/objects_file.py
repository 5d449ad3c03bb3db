"""New objects and cameras from a .blend: its first scene, appended to the scene of a place."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy


@dataclass(frozen=True)
class Appended:
    """What an objects file brought: its cameras by name, its active one, its picture size [px] and frame."""

    objects: tuple[bpy.types.Object, ...]
    cameras: dict[str, bpy.types.Object]
    active_camera: bpy.types.Object | None
    size: tuple[int, int]
    frame: int

    def camera(self, name: str | None = None) -> bpy.types.Object:
        """Return the camera of this name, or the active one. Raises ValueError with those there are."""
        found = self.active_camera if name is None else self.cameras.get(name)
        if found is None:
            there = ", ".join(self.cameras) or "none"
            wanted = "it has no active camera" if name is None else f"it has no camera {name!r}"
            raise ValueError(f"{wanted}; its cameras: {there}")
        return found


def append_objects(scene: bpy.types.Scene, path: str | Path) -> Appended:
    """Append the first scene of a .blend: objects, collections, data, animation.

    What stands there without a role is synthetic. Collections that its first view layer leaves out are not
    rendered. A captured place in that file stays there: the scene has its own.
    Raises ValueError where the file has no scene; OSError where it is no .blend.
    """
    path = Path(path)
    with bpy.data.libraries.load(str(path.absolute()), link=False) as (there, ours):
        ours.scenes = there.scenes[:1]
    if not ours.scenes:
        raise ValueError(f"{path}: it has no scene, so no objects to add")
    theirs = ours.scenes[0]
    place = theirs.panorama_place.collection
    of_place = set(place.all_objects) if place else set()
    _hide_what_is_left_out(theirs.view_layers[0].layer_collection)
    for collection in theirs.collection.children:
        if collection != place:
            scene.collection.children.link(collection)
    objects = tuple(thing for thing in theirs.objects if thing not in of_place)
    for thing in theirs.collection.objects:
        if thing not in of_place:
            scene.collection.objects.link(thing)
    render = theirs.render
    share = render.resolution_percentage / 100
    appended = Appended(
        objects=objects,
        cameras={thing.name: thing for thing in objects if thing.type == "CAMERA"},
        active_camera=theirs.camera if theirs.camera in objects else None,
        size=(round(render.resolution_x * share), round(render.resolution_y * share)),
        frame=theirs.frame_current,
    )
    bpy.data.scenes.remove(theirs)
    return appended


def _hide_what_is_left_out(layer_collection):
    for child in layer_collection.children:
        if child.exclude:
            child.collection.hide_render = True
        _hide_what_is_left_out(child)
