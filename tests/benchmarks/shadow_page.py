"""The phone's page in a headless Chromium against numpy: every method and storage, sun and lamp; a picture.

Needs Chromium (CHROMIUM=/path/to/it, or on the PATH). Writes docs/charts/shadow_page.json and
docs/images/shadow_page.jpg, Chromium's picture of a page with a menu.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
from dataclasses import replace

import cv2
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from shadow_scenes import Ball, Box
from web_pages import CHROMIUM, measured, outward, photographed, sky, still_life, white

from expanded_panoramas.cycles_integration.shipped import shipped_panorama
from expanded_panoramas.ibl_toolkit.images import exposure_for, read_panorama
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.mobile.device_lights import device_lights
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import (
    METHODS,
    STORAGES,
    suggested_settings,
)
from expanded_panoramas.ibl_toolkit.mobile.shadow_scene import SceneMesh, ShadowScene
from expanded_panoramas.ibl_toolkit.mobile.web_page import Background, write_page

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
EXTENT, RESOLUTION, PENUMBRA = 4.0, 512, 0.04
PICTURE = 960, 540
EYE_HEIGHT = 1.6
"""Of the panorama [m], by guess."""


def main():
    """Measure and write both."""
    if not CHROMIUM:
        print("skipped: needs a Chromium: CHROMIUM=/path/to/chromium, or `chromium` on the PATH")
        return
    version = subprocess.run([CHROMIUM, "--version"], capture_output=True, text=True, check=True).stdout
    with tempfile.TemporaryDirectory() as folder:
        document = {
            "definitions": "difference in 8-bit sRGB, worst channel, between Chromium's picture of the page "
            "and numpy's, 480 × 320 px, shadow map of 512 × 512, window 5; visibility: everything real, over "
            "white, one light; over: share of the pixels beyond 2/255; inside: away from outlines of meshes "
            "by more than a pixel; pictures: two lights, ambient light, things of their own colour, panorama",
            "chromium": version.strip() + ", SwiftShader",
            "visibility": [row for light in ("sun", "lamp") for row in shown_alone(light, folder)],
            "pictures": list(pictures(folder)),
            "car_park": {"page_kib": car_park(pathlib.Path(folder))},
        }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (DOCS / "charts" / "shadow_page.json").write_text(text + "\n", encoding="utf-8")
    print(text)


def shown_alone(light, folder):
    """Rows of one light's visibility, by method and storage."""
    scene = still_life((light,), ("support",) * 3, 0.0)
    kinds = [(method, storage) for method in METHODS for storage in STORAGES]
    pages = measured([(scene, chosen(*kind), white()) for kind in kinds], folder)
    for (method, storage), page in zip(kinds, pages, strict=True):
        yield {"light": light, "method": method, "storage": storage, **summary(page)}


def pictures(folder):
    """Rows of whole pictures, by method."""
    scene = still_life(("sun", "lamp"))
    pages = measured([(scene, chosen(method, "16+16"), sky()) for method in METHODS], folder)
    for method, page in zip(METHODS, pages, strict=True):
        yield {"method": method, "storage": "16+16", **summary(page)}


def chosen(method, storage):
    """The settings that are compared."""
    return suggested_settings(EXTENT, RESOLUTION, storage, PENUMBRA, method)


def summary(page):
    """Figures of a page's differences."""
    off, inside = page.off, page.off[~page.outlines]
    return {
        "mean": round(float(off.mean()), 3),
        "largest": round(float(off.max()), 1),
        "over": round(float((off > 2).mean()), 5),
        "inside_mean": round(float(inside.mean()), 3),
        "inside_largest": round(float(inside.max()), 1),
        "inside_over": round(float((inside > 2).mean()), 5),
    }


def car_park(folder):
    """Picture of new things in a car park under its own sun; size of the page [KiB]."""
    photograph = read_panorama(shipped_panorama("city.exr"))
    meshes = list(new_things())
    points = np.concatenate([mesh.points for mesh in meshes if mesh.throws])
    found = device_lights(photograph, points)
    sun = found.lights[0].camera
    eye = np.array([0.0, 0.0, EYE_HEIGHT])
    behind = Background(photograph, "panorama", exposure_for(photograph), eye)
    kinds = [
        suggested_settings(2 * max(sun.half_width, sun.half_height), resolution, storage, 0.03, method)
        for method in reversed(METHODS)
        for resolution, storage in ((1024, "16+16"), (1024, "8+8"), (512, "16+16"))
    ]
    lights = [replace(one, camera=one.camera.with_border(kinds[0])) for one in found.lights]
    scene = ShadowScene(meshes, lights, found.ambient, found.ambient_down)
    page, view = folder / "car_park.html", Pinhole.looking_at(eye, (0.1, 3.2, 0.75), 62, *PICTURE)
    write_page(page, scene, kinds, behind, view, "New things in a car park")
    shown = cv2.cvtColor(photographed([page], folder, PICTURE)[0], cv2.COLOR_RGB2BGR)
    cv2.imwrite(str(DOCS / "images" / "shadow_page.jpg"), shown, [cv2.IMWRITE_JPEG_QUALITY, 88])
    return round(page.stat().st_size / 1024)


def new_things():
    """A ball and a box on the ground."""
    floor = np.array([[-3.0, 1, 0], [3, 1, 0], [3, 6, 0], [-3, 6, 0]]), np.array([[0, 1, 2], [0, 2, 3]])
    yield SceneMesh("ground", *floor, throws=False)
    ball = Ball((0.75, 3.0, 0.4), 0.4, 48)
    points, triangles = ball.mesh()
    normals = (points - ball.centre) / ball.radius
    yield SceneMesh("ball", points, triangles, "synthetic", (0.65, 0.2, 0.1), normals)
    box = outward(*Box((-0.5, 2.9, 0), (0.0, 3.4, 1.0)).mesh())
    yield SceneMesh("box", *box, "synthetic", (0.35, 0.4, 0.45))


if __name__ == "__main__":
    main()
