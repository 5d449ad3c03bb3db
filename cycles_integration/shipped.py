"""The panoramas that ship with Blender: eight real rooms and places (CC0), of 1024 × 512 pixels."""

from __future__ import annotations

from pathlib import Path

import bpy

FOLDER = Path("studiolights", "world")


def shipped_panorama(name: str) -> Path:
    """Return the path of a panorama of Blender's own, such as interior.exr.

    Raises ValueError where this Blender was packed without it.
    """
    folders = (
        bpy.utils.system_resource("DATAFILES"),
        Path(bpy.utils.resource_path("LOCAL"), "datafiles"),
        Path(bpy.utils.resource_path("SYSTEM"), "datafiles"),
    )
    found = (Path(folder, FOLDER, name) for folder in folders if folder)
    path = next((path for path in found if path.is_file()), None)
    if path is None:
        raise ValueError(
            f"this Blender was packed without datafiles/{FOLDER.as_posix()}/{name}, its own panorama: "
            "get a Blender from blender.org, or open a panorama of yours"
        )
    return path
