"""A place as a panorama in layers: its surfaces, with the photograph projected on all of them."""

from __future__ import annotations

import bpy

from ..ibl_toolkit.layers.panorama import LayeredPanorama
from . import capture, lookup, materials, roles, world
from .layer_capture import surfaces_of
from .layer_render import LayerCapture, refuse_other_radius
from .place import place_of, sort_objects


def capture_place(
    scene: bpy.types.Scene, radius: float | None, options: LayerCapture, tell=lambda step: None
) -> LayeredPanorama:
    """Render the real surfaces of a scene's place as `capture_surfaces` does, each showing the photograph.

    The first layer is the photograph itself with the depth of the rebuilt place. What hides behind shows what
    the photograph has in its direction: the picture of what stands in front (section 5.5.4). No lamps are
    needed, and one path per sample place does.

    Raises: ValueError where the scene has no place or no surfaces.
    """
    refuse_other_radius(radius)
    place = place_of(scene)
    real = roles.real_objects(scene)
    if not real:
        raise ValueError("the place has no surfaces: build shapes first")
    sort_objects(scene, place)
    lookup.build_lookup(place)
    frame = place.origin.matrix_world.copy()
    with capture.temporary_scene(place, options.width, options.samples, with_lamps=False) as taken:
        capture.sample_pixel_centres(taken)
        taken.view_layers[0].use_pass_z = True
        taken.world = world.build_world(taken, place)
        with materials.worn_by(real, materials.backplate_material(place)):
            return surfaces_of(taken, frame, radius, options, tell)
