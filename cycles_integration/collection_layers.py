"""A scene as a panorama in layers that the artist has sorted: a layer for each of some collections."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Matrix

from ..ibl_toolkit.layers.making.uncovered import usual_radius
from ..ibl_toolkit.layers.panorama import EQUIRECTANGULAR, Layer, LayeredPanorama
from . import capture
from .layer_render import LayerCapture, centres, mean_of_surface, ray_depth, refuse_other_radius, set_up
from .layer_scene import rendered_scene
from .view_layers import layer_collection

SURFACES = {"MESH", "CURVE", "CURVES", "SURFACE", "META", "FONT", "POINTCLOUD"}


def capture_collections(
    scene: bpy.types.Scene,
    world_from_panorama: Matrix,
    radius: float | None,
    options: LayerCapture,
    collections: Sequence[str],
) -> LayeredPanorama:
    """Render what is seen of each collection with the others out of sight: layers of the collections' names.

    What is out of sight still throws its light, its shadow and its mirror image. One render job with a view
    layer each; `options.most` does not count. Depth as of `capture_surfaces`; where no collection is seen,
    the first layer is at infinity. The scene stays as it is.

    Raises: ValueError for a collection that is not in the scene, one within another, for surfaces that lie in
    none of them, instanced ones among these, and for things in two of them.

    Source: thesis, 6.3.2, Fig. 6-12.
    """
    refuse_other_radius(radius)
    groups = [_collection(scene, name) for name in collections]
    _refuse_overlaps(groups)
    with rendered_scene(scene, world_from_panorama) as taken:
        own = next(layer for layer in taken.view_layers if layer.use)
        _refuse_strays(own, groups)
        for number, group in enumerate(groups):
            _add_view_layer(taken, own, str(number), [other for other in groups if other != group])
        own.use = False
        set_up(taken, options)
        passes = capture.render_view_layers(taken)
    layers = _layers([group.name for group in groups], [passes[str(k)] for k in range(len(groups))], options)
    front = np.fmin.reduce([layer.depth for layer in layers])
    frame = np.array(world_from_panorama, dtype=np.float64)
    return LayeredPanorama(
        layers, frame[:3, :3], frame[:3, 3], usual_radius(front) if radius is None else radius
    )


def _layers(names, passes, options):
    fine = [ray_depth(each["Depth"]) for each in passes]
    depths = [centres(depth, options.finer) for depth in fine]
    is_open = np.isinf(depths).all(axis=0)
    layers = []
    for number, (name, depth) in enumerate(zip(names, depths, strict=True)):
        radiance = mean_of_surface(passes[number]["Combined"], fine[number], depth, options.finer)
        kept = np.isfinite(depth) | (is_open if number == 0 else False)
        if not kept.any():
            raise ValueError(f"nothing is seen of the collection '{name}'")
        attributes = {"radiance": radiance, "depth": np.where(kept, depth, np.float32(np.nan))}
        layers.append(Layer(name, EQUIRECTANGULAR, attributes))
    return tuple(layers)


def _add_view_layer(taken, own, name, others):
    """A view layer that shows what `own` does, but for some collections, which are out of sight."""
    layer = taken.view_layers.new(name)
    layer.use_pass_z = True
    layer.material_override = own.material_override
    _copy_flags(own.layer_collection, layer.layer_collection)
    for other in others:
        _hide(layer_collection(layer, other))


def _copy_flags(source, target):
    for flag in ("exclude", "holdout", "indirect_only"):
        if getattr(target, flag) != getattr(source, flag):
            setattr(target, flag, getattr(source, flag))
    for one, other in zip(source.children, target.children, strict=True):
        _copy_flags(one, other)


def _hide(collection):
    """Out of the camera's sight; the flag reaches no children."""
    collection.indirect_only = True
    for child in collection.children:
        _hide(child)


def _collection(scene, name):
    found = next((c for c in scene.collection.children_recursive if c.name == name), None)
    if found is None:
        there = ", ".join(f"'{c.name}'" for c in scene.collection.children_recursive) or "none"
        raise ValueError(f"scene '{scene.name}' has no collection '{name}'; its collections: {there}")
    return found


def _refuse_overlaps(groups):
    for group in groups:
        inside = next((other for other in groups if other in group.children_recursive), None)
        if inside is not None:
            raise ValueError(f"collection '{inside.name}' lies in '{group.name}': name one of them")
        if groups.count(group) > 1:
            raise ValueError(f"collection '{group.name}' is named twice")
    for number, group in enumerate(groups):
        own = set(group.all_objects)
        for other in groups[:number]:
            both = [thing.name for thing in other.all_objects if thing in own and _shows(thing)]
            if both:
                names = f"'{other.name}' and '{group.name}'"
                raise ValueError(f"{_listed(both)} in both collections {names}: must be in one of them")


def _refuse_strays(layer, groups):
    layer.update()
    sorted_out = {thing for group in groups for thing in group.all_objects}
    strays = [thing.name for thing in layer.objects if _shows(thing)]
    strays = [name for name in strays if name not in {thing.name for thing in sorted_out}]
    if strays:
        raise ValueError(f"{_listed(strays)} in none of the collections {', '.join(g.name for g in groups)}")


def _shows(thing):
    """Whether it has, or instances, surfaces that are rendered."""
    instanced = thing.instance_collection if thing.instance_type == "COLLECTION" else None
    is_seen = thing.type in SURFACES or (instanced is not None and any(map(_shows, instanced.all_objects)))
    return is_seen and not thing.hide_render


def _listed(names):
    return ", ".join(f"'{name}'" for name in names[:5]) + (", …" if len(names) > 5 else "")
