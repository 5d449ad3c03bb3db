"""The render methods against the truth: two closed rooms, four methods, with and without extracted lights.

Writes docs/charts/methods.png (truth, each method, and five times its error) and docs/charts/methods.json.
The truth is rendered once and kept in out/bench/.
"""

import json
import os
import pathlib
import time

import bpy
import matplotlib
import numpy as np

from expanded_panoramas import cycles_integration
from expanded_panoramas.cycles_integration.methods import CATCHER, DIFFERENCE, DIRECTIONAL, SINGLE
from expanded_panoramas.cycles_integration.rendering import Picture
from expanded_panoramas.ibl_toolkit import metrics
from expanded_panoramas.sample_scenes import closed_room_truth as room
from expanded_panoramas.sample_scenes.closed_room import LARGE_LAMPS, SMALL_LAMPS

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHARTS, CACHE = ROOT / "docs" / "charts", ROOT / "out" / "bench"
PANORAMA_WIDTH, PANORAMA_SAMPLES = 1024, 128
WIDTH, HEIGHT, SAMPLES = 480, 270, 64
TRUTH_SAMPLES = 512
RUNS = (  # method, most lights, denoised
    (DIRECTIONAL, 0, False),
    (SINGLE, 0, False),
    (SINGLE, None, False),
    (DIFFERENCE, 0, False),
    (DIFFERENCE, None, False),
    (CATCHER, 0, False),
    (CATCHER, None, False),
    (CATCHER, None, True),
)
SHOWN = (RUNS[0], RUNS[5], RUNS[6])


def main():
    """Measure both rooms and write the sheet and the figures."""
    CACHE.mkdir(parents=True, exist_ok=True)
    rows, pictures = [], {}
    for lamps in (LARGE_LAMPS, SMALL_LAMPS):
        fresh_file()
        panorama = cached_panorama(lamps)
        truth = cached_truth(lamps)
        pictures[lamps, "truth"] = truth.with_objects
        empty = photograph(panorama, lamps)
        for run in RUNS:
            row, picture = measure(lamps, panorama, truth, empty, run)
            rows.append(row)
            print(row)
            if run in SHOWN:
                pictures[lamps, label(run)] = picture
        compare_times([row for row in rows if row["lamps"] == lamps])
    sheet(pictures)
    document = {
        "cores": os.cpu_count(),
        "samples": SAMPLES,
        "size": [WIDTH, HEIGHT],
        "truth_samples": TRUTH_SAMPLES,
        "rows": rows,
    }
    (CHARTS / "methods.json").write_text(json.dumps(document, indent=1) + "\n")


def measure(lamps, panorama, truth, empty, run):
    """One row of the table and its picture."""
    method, most_lights, denoise = run
    fresh_file()
    start = time.perf_counter()
    scene, prepared = room.mixed_scene(panorama, most_lights)
    ready = time.perf_counter()
    picture = room.render_mixed(
        scene, CACHE / "picture.exr", Picture(WIDTH, HEIGHT, SAMPLES, 1, method, denoise)
    )
    done = time.perf_counter()
    changed = metrics.changed_pixels(truth.with_objects, truth.without)
    unchanged = metrics.unchanged_pixels(truth.with_objects, truth.without)
    row = {
        "lamps": lamps,
        "method": method,
        "lights": prepared.at_depth.count,
        "denoised": denoise,
        "psnr_changed_db": round(metrics.psnr(picture, truth.with_objects, changed), 2),
        "psnr_unchanged_db": round(metrics.psnr(picture, empty, unchanged), 2),
        "white_dots": int(metrics.new_white_dots(picture, truth.with_objects).sum()),
        "prepare_seconds": round(ready - start, 1),
        "render_seconds": round(done - ready, 1),
    }
    return row, picture


def compare_times(rows):
    """Add each row's render time as a ratio to the default's: seconds depend on the machine and its load."""
    default = next(r for r in rows if r["method"] == CATCHER and r["lights"] and not r["denoised"])
    for row in rows:
        row["render_ratio"] = round(row["render_seconds"] / default["render_seconds"], 2)


def photograph(panorama, lamps):
    """The photograph projected on the rebuilt room, without objects: the catcher's backplate."""
    path = CACHE / f"photograph_{lamps}_{WIDTH}.exr"
    fresh_file()
    scene, _ = room.mixed_scene(panorama, 0)
    room.hide_objects(scene)
    return room.render_mixed(scene, path, Picture(WIDTH, HEIGHT, 1, 1, CATCHER))


def cached_panorama(lamps):
    """The room's panorama, rendered unless it is there."""
    path = CACHE / f"panorama_{lamps}_{PANORAMA_WIDTH}_{PANORAMA_SAMPLES}.exr"
    if not path.exists():
        room.capture_panorama(lamps, path, PANORAMA_WIDTH, PANORAMA_SAMPLES)
    return path


def cached_truth(lamps):
    """The truth, rendered unless it is there."""
    path = CACHE / f"truth_{lamps}_{WIDTH}_{TRUTH_SAMPLES}.npz"
    if not path.exists():
        truth = room.render_truth(lamps, WIDTH, HEIGHT, TRUTH_SAMPLES)
        np.savez(path, with_objects=truth.with_objects, without=truth.without)
    return room.Truth(**np.load(path))


def fresh_file():
    """An empty Blender file with the package registered."""
    cycles_integration.unregister()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    cycles_integration.register()


def label(run):
    """What the sheet calls a run."""
    method, most_lights, _ = run
    return method if method == DIRECTIONAL else f"{method}, {'no ' if most_lights == 0 else ''}lights"


def sheet(pictures):
    """Truth and pictures side by side, the error below."""
    lamps = (LARGE_LAMPS, SMALL_LAMPS)
    names = list(dict.fromkeys(name for _, name in pictures))
    figure, axes = plt.subplots(4, len(names), figsize=(4 * len(names), 9.2), layout="constrained")
    for row, which in enumerate(lamps):
        truth = metrics.display_values(pictures[which, "truth"])
        for column, name in enumerate(names):
            shown = metrics.display_values(pictures[which, name])
            axes[2 * row, column].imshow(shown)
            axes[2 * row + 1, column].imshow(np.clip(5 * np.abs(shown - truth), 0, 1))
            axes[2 * row, column].set_title(f"{which} lamps: {name}", fontsize=11)
            axes[2 * row + 1, column].set_title("5 × difference to the truth", fontsize=9)
    for axis in axes.flat:
        axis.set_axis_off()
    figure.savefig(CHARTS / "methods.png", dpi=80)


if __name__ == "__main__":
    cycles_integration.register()
    main()
