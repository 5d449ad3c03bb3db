"""Shadow maps against traced truth: offset, resolution, range of depths, bits; where each breaks.

Writes docs/charts/shadow_maps.json, shadow_maps.png and shadow_maps_pictures.png.
"""

import itertools
import json
import math
import pathlib
import sys
from dataclasses import replace

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from _shadow_candidates import candidates
from _shadow_charts import draw, draw_pictures
from shadow_errors import acne, bleeding, rms
from shadow_scenes import Ball, Box, Scene, Sun

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import (
    METHODS,
    STORAGES,
    LightCamera,
    ShadowSettings,
    shadow_map,
    suggested_settings,
    visibility,
)
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.depth_buffer import depth_buffer
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.storage import STEPS

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
BOX = Box((-0.6, -0.3, 0), (-0.1, 0.2, 0.9))
SCENE = Scene((BOX, Ball((0.7, 0.2, 0.6), 0.3), Box((-0.3, -1.0, 0.0), (0.9, -0.9, 0.3))))
STACK = Scene((Box((-0.8, -0.6, 1.0), (0.2, 0.6, 1.05)), Box((-1.2, -0.2, 0.15), (0.6, 1.2, 0.2))))
SUN = (0.5, -0.6, 0.9)
SIDE, HALF = 241, 1.6
"""Places on the floor, none of them on the foot of a box."""
SPACING_MM = 2000 * HALF / SIDE
SAMPLES = 64
APART = 8
"""Places between what counts as acne or bleeding and the nearest edge of a shadow."""
BLOCKER_HEIGHT = 0.5
"""Mean distance [m] from what throws a shadow to where it falls, for the window."""
FACTORS = (0, 0.5, 1, 1.5, 1.9, 2.5, 3, 4, 6, 8, 12, 16)
RANGES = (1, 2, 5, 10, 20, 50, 100)
RESOLUTIONS = (256, 512, 1024, 2048)


class Measured:
    """A scene under the sun: its map's camera, its floor, its truth."""

    def __init__(self, scene):
        self.scene, self.mesh = scene, scene.mesh()
        self.camera = LightCamera.of_sun(SUN, self.mesh[0])
        self.extent = 2 * max(self.camera.half_width, self.camera.half_height)
        self.points, self.normals = scene.floor(SIDE, HALF)
        self.truth = scene.lit(self.points, self.normals, Sun(SUN))

    def found(self, settings, camera=None):
        return visibility(shadow_map(*self.mesh, camera or self.camera, settings), self.points, self.normals)

    def suggested(self, resolution=1024, storage="16+16", penumbra=0.0, method="evsm"):
        return suggested_settings(self.extent, resolution, storage, penumbra, method)

    def farther(self, times):
        return replace(self.camera, far=self.camera.far * times)


def main():
    """Measure and write all three."""
    still, stack = Measured(SCENE), Measured(STACK)
    document = {
        "definitions": "rms: root mean square error of visibility over a floor of 3.2 m, 241 × 241 places; "
        "acne: mean darkness of what is lit; bleeding: light on the worst hundredth of what is dark, both "
        "8 places (106 mm) or more from the nearest edge; gap_mm: light lost from the dark along the foot of "
        "a box, within 0.2 m, per metre of foot; sun 49° high; still life of two boxes and a ball; "
        "for bleeding, and the rms of candidates beside it, one board hovers 0.8 m above another",
        "texel_mm_at_1024": round(1000 * still.extent / 1024, 2),
        "depth_range_m": round(still.camera.far - still.camera.near, 2),
        "offset": offset(still),
        "range": depth_range(still, stack),
        "maps": maps(still, stack),
        "bare": bare(still),
        "candidates": compared(still, stack),
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "shadow_maps.json").write_text(text + "\n", encoding="utf-8")
    draw(document, CHARTS / "shadow_maps.png")
    draw_pictures(pictures(still, stack), SIDE, CHARTS / "shadow_maps_pictures.png")
    print(text)


def offset(still):
    """Acne and gap against the offset's factor, at 1 unit."""
    return [
        {"name": name, "factor": factor, **faults(still, still.found(settings))}
        for name, method, window in (
            ("hard", "hard", 1),
            ("PCF 1 × 1", "pcf", 1),
            ("PCF 3 × 3", "pcf", 3),
            ("PCF 7 × 7", "pcf", 7),
            ("VSM 7 × 7", "vsm", 7),
            ("EVSM 7 × 7", "evsm", 7),
        )
        for factor in FACTORS
        for settings in [ShadowSettings(method, 1024, "16+16", window, factor, 1.0)]
    ]


def depth_range(still, stack):
    """All three faults when the light's range of depths is longer than the scene."""
    return [
        {
            "method": method,
            "storage": storage,
            "times": times,
            **faults(
                still, still.found(still.suggested(storage=storage, method=method), still.farther(times))
            ),
            "bleeding": figure(leak(stack, stack.suggested(storage=storage, method=method), times)),
        }
        for method, storage, times in itertools.product(METHODS, STORAGES, RANGES)
    ]


def maps(still, stack):
    """Every method, storage and resolution as suggested."""
    return [
        {
            "method": method,
            "storage": storage,
            "resolution": resolution,
            "mebibytes": resolution**2 * settings.bytes_per_texel / 2**20,
            "rms": figure(rms(found, still.truth)),
            **faults(still, found),
            "bleeding": figure(leak(stack, settings)),
        }
        for method, storage, resolution in itertools.product(METHODS, STORAGES, RESOLUTIONS)
        for settings in [still.suggested(resolution, storage, method=method)]
        for found in [still.found(settings)]
    ]


def bare(still):
    """Acne of one test without any offset."""
    return [
        {"storage": storage, "resolution": resolution, "acne": faults(still, still.found(settings))["acne"]}
        for storage, resolution in itertools.product(STORAGES, RESOLUTIONS)
        for settings in [ShadowSettings("hard", resolution, storage, 1, 0.0, 0.0)]
    ]


def compared(still, stack):
    """Candidates, window 9, no reduction of bleeding: of each, in each scene, the try that errs least."""
    rows = []
    for name, (storage, bits, tries) in candidates().items():
        row = {"name": name, "bits": bits}
        for scene in (still, stack):
            depth = depth_buffer(*scene.mesh, scene.camera, 1024, 0.0, 1.0, STEPS[storage])
            found = tries(depth, scene.camera.texture(scene.points), 9)
            best = min(found, key=lambda one: rms(one, scene.truth))
            if scene is stack:
                row["rms"] = figure(rms(best, stack.truth))
                row["bleeding"] = figure(bleeding(best, stack.truth, APART))
            else:
                row |= {"rms_contact": figure(rms(best, still.truth)), **faults(still, best)}
        rows.append(row)
    return rows


def faults(still, found):
    """Acne, and the gap at the box's foot on the sides away from the sun, which are 1 m long together."""
    outside = np.maximum(np.array(BOX.low) - still.points, still.points - np.array(BOX.high))[:, :2]
    near = np.linalg.norm(np.maximum(outside, 0), axis=1) < 0.2
    lost = found[near & (still.truth == 0) & (outside.max(axis=1) > 0)].sum() * SPACING_MM**2 / 1000
    return {"acne": figure(acne(found, still.truth, APART)), "gap_mm": figure(lost)}


def leak(stack, settings, times=1):
    """Bleeding with a window of 9 and without its reduction, which would hide it."""
    window = 1 if settings.method == "hard" else 9
    factor = 5.0 if settings.method == "pcf" else settings.offset_factor
    wide = replace(settings, window=window, offset_factor=factor, bleeding_reduction=0.0)
    return bleeding(stack.found(wide, stack.farther(times)), stack.truth, APART)


def pictures(still, stack):
    """Title -> visibility, in rows of six."""
    disc = Sun(SUN, 3, SAMPLES)
    wide = 2 * BLOCKER_HEIGHT * math.tan(math.radians(1.5))
    bare_ = ShadowSettings("hard", 512, "16+16", 1, 0.0, 0.0)
    leaky = replace(stack.suggested(method="vsm"), window=9, bleeding_reduction=0.0)
    return {
        "true, lamp of 3°": still.scene.lit(still.points, still.normals, disc),
        "hard, 512": still.found(still.suggested(512, method="hard")),
        "PCF 3 × 3, 512": still.found(still.suggested(512, method="pcf")),
        "PCF as wide, 1024": still.found(still.suggested(penumbra=wide, method="pcf")),
        "VSM as wide, 1024": still.found(still.suggested(penumbra=wide, method="vsm")),
        "EVSM as wide, 1024": still.found(still.suggested(penumbra=wide)),
        "acne: hard, no offset": still.found(bare_),
        "peter-panning: factor 30": still.found(replace(bare_, offset_factor=30.0)),
        "VSM in 8 + 8 bits": still.found(still.suggested(storage="8+8", method="vsm")),
        "EVSM in 8 + 8 bits": still.found(still.suggested(storage="8+8")),
        "bleeding: VSM 16 + 16": stack.found(leaky),
        "the same, EVSM 16 + 16": stack.found(replace(leaky, method="evsm", offset_units=1.0)),
    }


def figure(number):
    """Three digits; nothing below a millionth."""
    return float(f"{number:.3g}") if number >= 1e-6 else 0.0


if __name__ == "__main__":
    main()
