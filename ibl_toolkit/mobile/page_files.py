"""A scene with a phone's shadows as a file: the page, its glTF alone, or the picture that the page shows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..images import replacing, write_exr, write_png
from ..layers.views.pinhole import Pinhole
from .page_picture import page_picture
from .shadow_maps import ShadowSettings
from .shadow_scene import ShadowScene, scene_glb
from .web_page import Background, write_page

PICTURES = (".png", ".exr")
FORMATS = (".html", ".glb", *PICTURES)
"""Ends of names: the page; its scene as glTF; the picture with the first kind of shadow map, as sRGB or as
radiance."""


def write_page_file(
    path,
    scene: ShadowScene,
    kinds: Sequence[ShadowSettings],
    background: Background,
    camera: Pinhole,
    title: str = "Shadows",
):
    """Write one of FORMATS, all or nothing.

    Raises: ValueError for another end of the name, no kinds, and what `write_page` refuses.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(f"{path}: must end in {', '.join(FORMATS)}")
    if suffix == ".html":
        write_page(path, scene, kinds, background, camera, title)
    elif suffix == ".glb":
        data = scene_glb(scene, kinds, camera, background.described())
        with replacing(path) as temporary:
            temporary.write_bytes(data)
    else:
        radiance = page_picture(scene, kinds[0], background, camera).radiance
        if suffix == ".png":
            write_png(path, radiance, exposure=background.exposure)
        else:
            write_exr(path, {name: np.ascontiguousarray(radiance[..., k]) for k, name in enumerate("RGB")})
