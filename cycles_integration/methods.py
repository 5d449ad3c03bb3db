"""The four ways to put new objects into the place; each sets the scene up so that F12 renders the picture."""

from __future__ import annotations

import bpy

from . import compositor, view_layers, world
from .place import Place
from .view_layers import BACKPLATE, MASK, OBJECTS, WITHOUT

CATCHER, SINGLE, DIFFERENCE, DIRECTIONAL = "catcher", "single", "difference", "directional"
METHODS = (
    (
        CATCHER,
        "Catcher",
        "Photograph × (light with objects ÷ light without), new objects over it. One render",
    ),
    (
        SINGLE,
        "Single",
        "One plain render; the support shows the photograph by its effective albedo. Fast, noisy",
    ),
    (DIFFERENCE, "Difference", "Photograph + render with objects − render without (differential rendering)"),
    (
        DIRECTIONAL,
        "Directional",
        "The traditional light map: all light from infinity, the support catches shadows",
    ),
)


def set_up(scene: bpy.types.Scene, place: Place, method: str, plate: bpy.types.Image | None = None):
    """Set view layers, shadow catchers, World and compositor up for a method.

    ``plate`` is the photograph in the picture's own size where the camera is the panorama's.
    Raises ValueError for a method that does not exist.
    """
    if method not in (CATCHER, SINGLE, DIFFERENCE, DIRECTIONAL):
        raise ValueError(f"method is {method!r}; expected catcher, single, difference or directional")
    view_layers.remove_ours(scene)
    view_layers.show_suns(scene, place, method == DIRECTIONAL)
    world.build_world(scene, place, whole_map_lights=method == DIRECTIONAL)
    view_layers.add_objects(
        scene, place, as_catchers=method in (CATCHER, DIRECTIONAL), with_environment=method != DIRECTIONAL
    )
    scene.render.film_transparent = method != SINGLE
    if method == SINGLE:
        compositor.connect(scene, compositor.PLAIN, {"Objects": (OBJECTS, "Image")})
        return
    view_layers.add_backplate(scene, place)
    sources = {
        "Objects": (OBJECTS, "Image"),
        "Backplate": (BACKPLATE, "Image"),
        "At Infinity": (BACKPLATE, "Environment"),
    }
    if method == DIFFERENCE:
        view_layers.add_without(scene, place)
        view_layers.add_mask(scene, place)
        sources |= {"Alpha": (MASK, "Alpha"), "Without": (WITHOUT, "Image")}
        compositor.connect(scene, compositor.DIFFERENCE, sources, plate)
    else:
        sources |= {"Alpha": (OBJECTS, "Alpha"), "Catcher": (OBJECTS, "Shadow Catcher")}
        compositor.connect(scene, compositor.CATCHER, sources, plate)
