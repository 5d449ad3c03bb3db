"""Shadow maps against Cycles' own shadows of suns and lamps, from points to large ones.

Cycles in turn is held against rays traced here. Writes docs/charts/shadow_lamps.json and shadow_lamps.png.
"""

import json
import math
import pathlib
import sys
from dataclasses import dataclass

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from _shadow_cycles import FloorLight
from _shadow_lamps_chart import draw
from shadow_errors import rms
from shadow_maps import BLOCKER_HEIGHT, SCENE, SUN, figure
from shadow_scenes import Lamp, Sun

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import (
    LightCamera,
    reaching,
    shadow_map,
    suggested_settings,
    visibility,
)

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
SIDE, HALF = 177, 1.6
"""Places on the floor, none of them on the foot of a box."""
SAMPLES, RAYS = 64, 256
"""Of each of two renders by Cycles; traced."""
DIAMETERS = (0, 0.25, 0.53, 1, 2, 4, 8, 16)
RADII = (0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
DISTANCE = 3.0
LAMP = tuple(DISTANCE * np.array(SUN) / np.linalg.norm(SUN))
SHOWN = (0.53, 4, 16)
"""Diameters of suns whose shadows are pictures."""
KINDS = {
    "hard": ("hard", 1024, 0, True),
    "PCF 3 × 3": ("pcf", 1024, 0, True),
    "PCF as wide": ("pcf", 1024, 1, True),
    "VSM as wide": ("vsm", 1024, 1, True),
    "EVSM as wide": ("evsm", 1024, 1, True),
    "EVSM as wide, 512": ("evsm", 512, 1, True),
    "EVSM as wide, 256": ("evsm", 256, 1, True),
    "PCF as wide, of new things": ("pcf", 1024, 1, False),
    "VSM as wide, of new things": ("vsm", 1024, 1, False),
    "EVSM as wide, of new things": ("evsm", 1024, 1, False),
}
"""Name -> method, resolution, width of the window in penumbras, and whether the floor throws shadows
too; in the preview and the page it only receives them, and the map is fitted to what is new."""


@dataclass(frozen=True)
class Light:
    """A sun of a diameter [°], or a lamp of a radius [m]."""

    kind: str
    size: float

    def camera(self, points):
        of = LightCamera.of_sun if self.kind == "sun" else LightCamera.of_lamp
        return of(SUN if self.kind == "sun" else LAMP, points)

    def extent(self, camera):
        """Of its map [m], at a lamp's distance."""
        return 2 * max(camera.half_width, camera.half_height) * (1 if self.kind == "sun" else DISTANCE)

    def penumbra(self):
        """How wide it is at BLOCKER_HEIGHT [m] behind what throws it."""
        if self.kind == "sun":
            return 2 * BLOCKER_HEIGHT * math.tan(math.radians(self.size / 2))
        return 2 * self.size * BLOCKER_HEIGHT / (DISTANCE - BLOCKER_HEIGHT)

    def rendered(self, floor):
        """Twice."""
        return floor.of_sun(SUN, self.size) if self.kind == "sun" else floor.of_lamp(LAMP, self.size)

    def traced(self, places, normals):
        count = RAYS if self.size else 1
        lamp = Sun(SUN, self.size, count) if self.kind == "sun" else Lamp(LAMP, 2 * self.size, count)
        return SCENE.lit(places, normals, lamp)


def main():
    """Measure and write both."""
    floor = FloorLight(SCENE.solids, SIDE, HALF, SAMPLES)
    places, normals = SCENE.floor(SIDE, HALF)
    rows, truths, pictures = [], [], {}
    for light in (*(Light("sun", d) for d in DIAMETERS), *(Light("lamp", r) for r in RADII)):
        halves = light.rendered(floor)
        truth = np.mean(halves, axis=0)
        off = rms(truth, light.traced(places, normals))
        about = {"light": light.kind, "size": light.size}
        truths.append({**about, "traced": figure(off), "noise": figure(rms(*halves) / 2)})
        found = {name: seen(light, places, normals, *kind) for name, kind in KINDS.items()}
        rows += [{**about, "name": name, "rms": figure(rms(one, truth))} for name, one in found.items()]
        if light.kind == "sun" and light.size in SHOWN:
            pictures |= {
                f"Cycles, {light.size}°": truth,
                f"EVSM as wide, {light.size}°": found["EVSM as wide"],
            }
    document = {
        "definitions": f"rms: root mean square error of visibility, the part of a light that arrives, over a "
        f"floor of {2 * HALF} m, {SIDE} × {SIDE} places, 16 + 16 bits; size: of a sun its diameter [°], 49° "
        f"high; of a lamp the radius [m] of a ball that shines, {DISTANCE} m away in the same direction; "
        f"truth is Cycles, twice {SAMPLES} samples, light with things over that without; noise: of that, "
        f"from the difference of the two; traced: rms of Cycles less {RAYS} rays to a disc",
        "errors": rows,
        "truth": truths,
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "shadow_lamps.json").write_text(text + "\n", encoding="utf-8")
    draw(document, pictures, SIDE, CHARTS / "shadow_lamps.png")
    print(text)


def seen(light, places, normals, method, resolution, widths, floor_throws):
    """Visibility of places (n, 3) by a light's shadow map."""
    points, triangles = SCENE.mesh()
    floor = points[:4], triangles[:2]
    if not floor_throws:
        points, triangles = points[4:], triangles[2:] - 4
    camera = light.camera(points)
    settings = suggested_settings(
        light.extent(camera), resolution, "16+16", widths * light.penumbra(), method
    )
    if floor_throws:
        return visibility(shadow_map(points, triangles, camera, settings), places, normals)
    camera = camera.with_border(settings)
    if settings.has_moments:
        camera = reaching(camera, *floor)
    return visibility(shadow_map(points, triangles, camera, settings, floor), places, normals)


if __name__ == "__main__":
    main()
