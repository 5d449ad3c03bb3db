"""The light of the panoramas that ship with Blender as a phone has it, against the maps themselves.

Needs no browser. Writes docs/charts/device_lights.json.
"""

import json
import pathlib

import bpy
import numpy as np

from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.light_map import LUMINANCE
from expanded_panoramas.ibl_toolkit.mobile.device_lights import device_lights, floor_irradiance
from expanded_panoramas.ibl_toolkit.mobile.shadow_scene import SceneMesh, ShadowScene

FOLDER = pathlib.Path(bpy.utils.resource_path("LOCAL"), "datafiles", "studiolights", "world")
CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
POINTS = np.array([[-0.5, -0.5, 0], [0.5, 0.5, 1.0]])
FACES = {
    "up": (0, 0, 1),
    "sides": ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)),
    "down": (0, 0, -1),
    "slopes": ((1, 0, 1), (-1, 0, 1), (0, 1, -1), (0, -1, -1)),
}


def main():
    """Measure and write."""
    document = {
        "definitions": "lights: suns, as all lies at infinity; share: of the floor's light, as luminance, "
        "that they bring; up, down, sides (+x, +y, −x, −y), slopes (two at 45° up, two down): what an "
        "unshadowed face with that normal gets of suns and ambient light over what it gets of the map, as "
        "luminance, for up the channel that is most off",
        "panoramas": [measured(path) for path in sorted(FOLDER.glob("*.exr"))],
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "device_lights.json").write_text(text + "\n", encoding="utf-8")
    print(text)


def measured(path):
    """A row of one panorama."""
    image = np.maximum(read_panorama(path), 0)
    found = device_lights(image, POINTS)
    up = ratio(found, image, FACES["up"])
    return {
        "name": path.stem,
        "lights": len(found.lights),
        "share": round(sum(found.shares), 3),
        "up": round(float(up[np.argmax(np.abs(up - 1))]), 4),
        "sides": [round(bright(found, image, normal), 2) for normal in FACES["sides"]],
        "slopes": [round(bright(found, image, normal), 2) for normal in FACES["slopes"]],
        "down": round(bright(found, image, FACES["down"]), 2),
    }


def ratio(found, image, normal):
    """(3,) of a face's light to the map's."""
    return received(found, normal) / floor_irradiance(image, normal)


def bright(found, image, normal):
    """The same as luminance."""
    unit = np.array(normal) / np.linalg.norm(normal)
    return float(LUMINANCE @ received(found, unit) / (LUMINANCE @ floor_irradiance(image, unit)))


def received(found, normal):
    """(3,) irradiance of a face without shadows."""
    suns = [np.array(one.strength) * max(-one.camera.axes[2] @ normal, 0) for one in found.lights]
    mesh = SceneMesh("floor", np.eye(3), np.array([[0, 1, 2]]))
    scene = ShadowScene([mesh], found.lights, found.ambient, found.ambient_down)
    return sum(suns, scene.ambient_on([normal])[0])


if __name__ == "__main__":
    main()
