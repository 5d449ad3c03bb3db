"""The folder that someone names for a panorama in layers: a new one, or one that has such a panorama."""

from __future__ import annotations

import os
from pathlib import Path

from ...images.atomic import new_folder
from ..panorama import LayeredPanorama
from .storage import write_layers
from .xml_file import NAME


def refuse_other_folder(folder):
    """Raise ValueError unless a panorama can be written to `folder` without harm to other files.

    Asked before long work that ends with `write_folder`.
    """
    folder = Path(folder)
    parent = folder.absolute().parent
    if not parent.is_dir():
        raise ValueError(f"{folder}: the folder {folder.parent} does not exist")
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder}: is a file, must be a folder, new or with a panorama in layers")
    if not os.access(folder if folder.is_dir() else parent, os.W_OK):
        raise ValueError(f"{folder}: cannot be written")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / NAME).is_file():
        raise ValueError(f"{folder}: has other files in it and no {NAME}: choose another folder")


def write_folder(panorama: LayeredPanorama, folder, **options):
    """`write_layers` with its options; a new folder is there whole or not at all."""
    folder = Path(folder)
    if folder.is_dir():
        write_layers(panorama, folder, **options)
        return
    with new_folder(folder) as temporary:
        write_layers(panorama, temporary, **options)
