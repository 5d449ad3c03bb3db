"""One self-contained HTML page that draws a scene's shadows with WebGL 2, over a panorama or a photo.

What it runs are the modules and shaders in ui/web/. They are written into the page as they are, and so are
the scene (.glb) and the background (JPEG). Nothing is loaded from elsewhere; the page's policy forbids it.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from string import Template

import cv2
import numpy as np

from ..images import replacing
from ..images.jpeg import QUALITY
from ..images.png import refuse_nan, srgb_codes
from ..layers.views.pinhole import Pinhole
from .shadow_maps import ShadowSettings
from .shadow_scene import ShadowScene, scene_glb

SOURCES = Path(__file__).resolve().parents[2] / "ui" / "web"
"""The page's template, modules (.js) and shaders (.glsl)."""
WIDEST = 4096
"""Of a background [px]: the side of a texture that phones of today all have."""
KINDS = ("panorama", "photo")


@dataclass(frozen=True, eq=False)
class Background:
    """What is behind the meshes, and what those that are real show.

    image: (H, W, 3) linear radiance. kind: "panorama", equirectangular, or "photo", by the page's camera.
    exposure: factor from radiance to what the screen shows. Of a panorama, origin: (3,) in the world [m], and
    world_from_panorama: (3, 3) rotation.

    Raises: ValueError that names the field and what is right.
    """

    image: np.ndarray
    kind: str = "panorama"
    exposure: float = 1.0
    origin: np.ndarray = field(default_factory=lambda: np.zeros(3))
    world_from_panorama: np.ndarray = field(default_factory=lambda: np.eye(3))

    def __post_init__(self):
        if self.kind not in KINDS:
            raise ValueError(f"background's kind {self.kind!r} must be one of {', '.join(KINDS)}")
        if np.ndim(self.image) != 3 or np.shape(self.image)[2] != 3 or not np.size(self.image):
            raise ValueError(f"background's image {np.shape(self.image)} must be (H, W, 3)")
        if self.kind == "panorama" and np.shape(self.image)[1] % 2:
            raise ValueError(f"panorama of width {np.shape(self.image)[1]} px must have an even one")
        if not 0 < self.exposure < np.inf:
            raise ValueError(f"background's exposure {self.exposure} must be above 0")
        if np.shape(self.origin) != (3,) or not np.isfinite(self.origin).all():
            raise ValueError(f"panorama's origin {self.origin} must be three finite numbers")
        turn = np.asarray(self.world_from_panorama)
        if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-5):
            raise ValueError(f"world_from_panorama {turn.tolist()} must be a (3, 3) rotation")

    def jpeg(self, path) -> bytes:
        """A JPEG file of the image, at most WIDEST wide; what is too bright is white."""
        image = np.asarray(self.image, dtype=np.float32)
        refuse_nan(image, path)
        height, width = image.shape[:2]
        if max(width, height) > WIDEST:
            scale = WIDEST / max(width, height)
            size = 2 * round(width * scale / 2), max(round(height * scale), 1)
            image = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
        codes = cv2.cvtColor(srgb_codes(image, self.exposure), cv2.COLOR_RGB2BGR)
        return cv2.imencode(".jpg", codes, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1].tobytes()

    def described(self) -> dict:
        """What the page has to know of it."""
        return {
            "kind": self.kind,
            "exposure": float(self.exposure),
            "origin": np.asarray(self.origin, dtype=float).tolist(),
            "panorama_from_world": np.asarray(self.world_from_panorama, dtype=float).T.tolist(),
        }


def write_page(
    path,
    scene: ShadowScene,
    settings: Sequence[ShadowSettings],
    background: Background,
    camera: Pinhole,
    title: str = "Shadows",
):
    """Write the page, all or nothing.

    settings: the kinds of shadow map that the page's menu has, the first shown first; of one there is no
    menu. camera: where the page looks from; over a panorama it may be turned by dragging. Its size does not
    count: the page fills the window, or has the shape of the photo.

    Raises: ValueError for no settings, NaN in the background, and a photo of another shape than the camera's.
    """
    refuse_other_size(background, camera, path)
    text = Template(_source("page.html")).substitute(
        title=escape(title),
        background=_base64(background.jpeg(path)),
        scene=_base64(scene_glb(scene, settings, camera, background.described())),
        shaders=_json({file.name: _source(file.name) for file in sorted(SOURCES.glob("*.glsl"))}),
        modules=_json({"imports": _modules()}),
        main=_source("main.js"),
    )
    with replacing(Path(path)) as temporary:
        temporary.write_text(text, encoding="utf-8")


def refuse_other_size(background: Background, camera: Pinhole, path):
    """Raise ValueError for a photo of another size than the picture of the camera that took it."""
    height, width = np.shape(background.image)[:2]
    if background.kind == "photo" and (width, height) != (camera.width, camera.height):
        raise ValueError(
            f"{path}: photo of {width} x {height} px must be as large as the camera's picture, "
            f"{camera.width} x {camera.height} px"
        )


def _modules():
    """{name: address}, the address being the module's text itself."""
    files = [file for file in sorted(SOURCES.glob("*.js")) if file.name != "main.js"]
    return {
        file.stem: f"data:text/javascript;base64,{_base64(_source(file.name).encode())}" for file in files
    }


def _source(name):
    return (SOURCES / name).read_text(encoding="utf-8")


def _base64(data):
    return base64.b64encode(data).decode()


def _json(value):
    """JSON within HTML, which must not end the element that it is in."""
    return json.dumps(value, ensure_ascii=False).replace("<", "\\u003c")
