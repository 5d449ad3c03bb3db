"""What a frame of the phone's page costs on software OpenGL, the light moving: method, resolution, storage.

Table I and figure 12 of *Realistic Shadows for Mobile AR*, as ratios. Needs Linux and Chromium
(CHROMIUM=/path/to/it, or on the PATH). Writes docs/charts/shadow_cost.json and shadow_cost.png.
"""

import itertools
import json
import pathlib
import subprocess
import sys
from dataclasses import replace

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from _page_clock import timed
from _shadow_cost_chart import draw
from web_pages import CHROMIUM, camera, photo, still_life

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import STORAGES, LightCamera, ShadowSettings
from expanded_panoramas.ibl_toolkit.mobile.shadow_scene import SceneLight

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
METHODS = {
    "hard": ("hard", 1),
    "PCF 3 × 3": ("pcf", 3),
    "PCF 8 × 8": ("pcf", 7),
    "VSM 7 × 7": ("vsm", 7),
    "EVSM 7 × 7": ("evsm", 7),
}
"""Name -> method and window. A PCF 7 texels wide reads 8 × 8."""
RESOLUTIONS = (512, 1024, 2048)
SCREEN = 1024, 768  # of the article's tablet
PARTS = ("maps", "picture")
SUNS = [(0.9 * np.sin(a), -0.6, 0.9 * np.cos(a) + 0.2) for a in np.radians((-50, 0, 50))]
"""Directions to the sun during a day."""
REPEATS = 6
ARTICLE = {
    "tablet, 8 + 8": (31.88, (31.88, 19.50, 6.37)),
    "tablet, packed": (31.88, (22.59, 12.01, 3.65)),
    "desktop": (53.40, (53.40, 46.02, 36.94)),
}
"""Table I: frames per second of VSM, of what is one, and by resolution."""
ARTICLE_METHODS = {"hard": 32, "PCF 8 × 8": 2, "VSM 7 × 7": 20}
"""Figure 12: frames per second on the tablet."""


def main():
    """Measure and write both."""
    choices = list(itertools.product(METHODS, RESOLUTIONS, STORAGES))
    spent = measured([kind(*choice) for choice in choices])
    unit = choices.index(("VSM 7 × 7", 512, "8+8"))
    ratios, *halves = (in_frames_of(unit, some) for some in (spent, spent[::2], spent[1::2]))
    rows = [
        {
            **dict(zip(("name", "resolution", "storage"), choice, strict=True)),
            **dict(zip(PARTS, map(figure, parts), strict=True)),
            "frame": figure(parts.sum()),
        }
        for choice, parts in zip(choices, ratios, strict=True)
    ]
    apart = np.log(halves[0].sum(axis=1) / halves[1].sum(axis=1))
    version = subprocess.run([CHROMIUM, "--version"], capture_output=True, text=True, check=True).stdout
    document = {
        "definitions": "processor time of the browser's graphics process, all its threads, over that of a "
        f"frame with VSM, 512 × 512, 8+8; {SCREEN[0]} × {SCREEN[1]} px, a floor, a box and a ball (9 230 "
        "triangles) over a photo, one sun; maps drawn anew in each frame, shaders kept; the least of "
        f"{REPEATS} rounds, in each of which every kind is drawn once under each of {len(SUNS)} suns, mean "
        "over these; apart: rms difference between frames of the odd rounds and of the even ones",
        "chromium": version.strip() + ", SwiftShader",
        "unit_ms": round(1000 * frames(spent)[unit].sum()),
        "apart_percent": figure(100 * np.sqrt(np.mean(apart**2))),
        "kinds": rows,
        "article": {name: [figure(unit / fps) for fps in found] for name, (unit, found) in ARTICLE.items()},
        "article_methods": {
            name: figure(ARTICLE_METHODS["VSM 7 × 7"] / fps) for name, fps in ARTICLE_METHODS.items()
        },
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "shadow_cost.json").write_text(text + "\n", encoding="utf-8")
    draw(document, CHARTS / "shadow_cost.png")
    print(text)


def kind(name, resolution, storage):
    method, window = METHODS[name]
    return ShadowSettings(method, resolution, storage, window)


def measured(kinds):
    """Processor seconds (REPEATS, suns, kinds, parts)."""
    view = replace(camera(), width=SCREEN[0], height=SCREEN[1])
    scene = still_life()
    points = np.concatenate([mesh.points for mesh in scene.meshes])
    suns = [SceneLight(LightCamera.of_sun(sun, points), (2.0, 1.8, 1.5)) for sun in SUNS]
    drawn = [range(REPEATS), range(len(SUNS)), range(len(kinds)), PARTS]
    first = [{"light": 0, "kind": kind, "part": part} for kind, part in itertools.product(*drawn[2:])]
    jobs = [{"light": sun, "kind": kind, "part": part} for _, sun, kind, part in itertools.product(*drawn)]
    seconds = timed([*first, *jobs], replace(scene, lights=suns), kinds, photo(view), view)
    return np.reshape(seconds[len(first) :], [len(one) for one in drawn])  # the first build the shaders


def frames(spent):
    """Seconds (kinds, parts): what others take of the machine only ever adds to them."""
    return spent.min(axis=0).mean(axis=0)


def in_frames_of(unit, spent):
    return frames(spent) / frames(spent)[unit].sum()


def figure(number):
    """Three digits."""
    return float(f"{number:.3g}")


if __name__ == "__main__":
    main()
