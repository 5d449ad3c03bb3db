"""Sample balls and the look-up of a place as assets, in .blend files of their own."""

from __future__ import annotations

import contextlib
from pathlib import Path

import bpy
import numpy as np

from ..ibl_toolkit.images import replacing
from . import asset_pictures, blender_images, lookup, maps
from .place import Place

BALLS_FILE = "Sample Balls.blend"
TAGS = ("panorama", "HDRI", "light probe")
PICTURE_WIDTH = 256
CATALOG_FILE = "blender_assets.cats.txt"
CATALOG_ID, CATALOG = "5d2c0f0e-7a3b-4c57-9c54-3a1f6f5be2a1", "Panorama"
"""The group under which the Asset Browser lists them."""


def write_balls(folder: Path, balls: dict[str, bpy.types.Object]):
    """Write sample balls to a file of assets, in the stead of one written before.

    ``balls``: MIRROR or MATTE to its object, which the caller removes.
    """
    told = {
        "MIRROR": "A perfect mirror: stand it in a place to see what is reflected, and where from",
        "MATTE": "Grey and diffuse, albedo 0.5: shows where light comes from, and its colour",
    }
    for kind, ball in balls.items():
        _mark(ball, told[kind], asset_pictures.ball(kind))
    names = {ball: f"{kind.title()} Ball" for kind, ball in balls.items()}
    _write(folder / BALLS_FILE, names, bpy.data.objects)


def write_lookup(folder: Path, place: Place) -> str:
    """Write the look-up of a place to a file of assets, in the stead of one written before; returns its name.

    In a material anywhere it gives the photograph as seen from the panorama's origin, and its light.
    """
    panorama = Path(place.image.filepath or place.image.name).stem
    with _temporary(lookup.build_lookup(place).copy()) as group:
        told = "Radiance of the panorama at a point, as seen from where it was captured, and its light there"
        image = maps.shrink(blender_images.array_from_image(place.image), PICTURE_WIDTH)
        _mark(group, f"{told}: {panorama}", asset_pictures.panorama(np.maximum(image, 0)))
        name = f"Panorama {panorama}"
        _write(folder / f"{name}.blend", {group: name}, bpy.data.node_groups)
        return name


def add_library(preferences: bpy.types.Preferences, name: str, folder: Path) -> bool:
    """Make a folder an asset library of this Blender; False where it is one already."""
    _write_catalog(folder / CATALOG_FILE)
    libraries = preferences.filepaths.asset_libraries
    if any(Path(library.path).resolve() == folder.resolve() for library in libraries if library.path):
        return False
    libraries.new(name=name, directory=str(folder))
    preferences.is_dirty = True  # Blender saves it as it saves other preferences
    return True


def _write_catalog(path):
    """Name the group of our assets, beside those that the folder has already."""
    before = path.read_text(encoding="utf-8") if path.exists() else "VERSION 1\n"
    if CATALOG_ID not in before:
        line = f"{CATALOG_ID}:{CATALOG}:{CATALOG}\n"
        with replacing(path) as temporary:
            temporary.write_text(f"{before.rstrip()}\n\n{line}", encoding="utf-8")


def _mark(block, description, picture):
    block.asset_mark()
    block.asset_data.description, block.asset_data.catalog_id = description, CATALOG_ID
    block.asset_data.author = "Expanded Panoramas"
    for tag in TAGS:
        block.asset_data.tags.new(tag, skip_if_exists=True)
    preview = block.preview_ensure()
    preview.image_size = picture.shape[1::-1]
    preview.image_pixels_float.foreach_set(np.ascontiguousarray(picture[::-1], np.float32).ravel())


def _write(path, names, collection):
    """Write data-blocks by these names; a Blender that is killed leaves the old file or the new one."""
    beside = path.with_name(f".{path.name}.part")
    try:
        with _named(names, collection):
            bpy.data.libraries.write(
                str(beside), set(names), path_remap="ABSOLUTE", fake_user=True, compress=True
            )
        beside.replace(path)
    except RuntimeError as error:
        raise OSError(f"{path}: Blender cannot write it: {error}") from error
    finally:
        beside.unlink(missing_ok=True)


@contextlib.contextmanager
def _named(names, collection):
    """Give data-blocks these names for a while, though others of this file may have them."""
    homonyms = {collection.get((name, None)): name for block, name in names.items() if block.name != name}
    homonyms.pop(None, None)
    for other in homonyms:
        other.name = f"{other.name} (waiting)"
    for block, name in names.items():
        block.name = name
    try:
        yield
    finally:
        for block in names:
            block.name = "asset"
        for other, name in homonyms.items():
            other.name = name


@contextlib.contextmanager
def _temporary(group):
    try:
        yield group
    finally:
        bpy.data.node_groups.remove(group)
