"""The hotel room that ships with Blender, as a file to open and as a set to import. Runs in Blender."""

import importlib
import json
import pathlib
import shutil

import bpy


def addon():
    """The installed package."""
    name = next(n for n in bpy.context.preferences.addons.keys() if n.endswith("expanded_panoramas"))  # noqa: SIM118
    return importlib.import_module(name)


def panorama(folder):
    """Copy the panorama into a folder of its own -> its path."""
    shipped = importlib.import_module(f"{addon().__name__}.cycles_integration.shipped")
    target = pathlib.Path(folder) / "hotel" / "interior.exr"
    target.parent.mkdir(exist_ok=True)
    shutil.copyfile(shipped.shipped_panorama("interior.exr"), target)
    return target


def picked_set(folder):
    """Write the set with all picks and shapes beside the panorama -> its path."""
    image = panorama(folder)
    text = (pathlib.Path(addon().__file__).parent / "sample_scenes" / "hotel_room.json").read_text("utf-8")
    target = image.with_name("hotel_room.json")
    target.write_text(json.dumps({**json.loads(text), "image": image.name}), encoding="utf-8")
    return target
