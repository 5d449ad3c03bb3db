"""The phone's page in a headless Chromium against the preview's nodes in Cycles, of one Blender scene.

Needs Chromium (CHROMIUM=/path/to/it, or on the PATH). Writes docs/charts/shadow_page_and_preview.json.
"""

import json
import pathlib
import sys
import tempfile

import bpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from page_and_preview import StillLife
from shadow_page import chosen, summary

import expanded_panoramas
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import METHODS, STORAGES

CHART = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts" / "shadow_page_and_preview.json"
LIGHTS = {
    ("sun",): STORAGES,
    ("lamp",): STORAGES,
    ("sun", "lamp"): ("16+16",),
}


def main():
    """Measure and write."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    expanded_panoramas.register()
    scene, rows = StillLife(), []
    for lights, storages in LIGHTS.items():
        kinds = [(method, storage) for method in METHODS for storage in storages]
        with tempfile.TemporaryDirectory() as folder:
            pages = scene.differences([(lights, chosen(*kind)) for kind in kinds], folder)
            for (method, storage), page in zip(kinds, pages, strict=True):
                about = {"lights": " and ".join(lights), "method": method, "storage": storage}
                rows.append({**about, **summary(page)})
    document = {
        "definitions": "difference in 8-bit sRGB, worst channel, between Chromium's picture of the page that "
        "is made of a Blender scene and that of Cycles with the preview's nodes, 480 × 320 px, each pixel at "
        "its middle: a real floor that shows white, a box and a ball that are new and diffuse, no ambient "
        "light; shadow map of 512 × 512, window 5; over: share of the pixels beyond 2/255; inside: away from "
        "outlines of meshes by more than a pixel",
        "blender": bpy.app.version_string,
        "rows": rows,
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    CHART.write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
