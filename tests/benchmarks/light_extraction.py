"""Seconds and peak memory of the light samplers, by size of the map and by number of lights.

The map is Blender's `interior`, enlarged, with noise in every pixel; made in out/bench/ and removed
afterwards. Each run has a process of its own, which loads the map as an array first: that takes part in the
memory and not in the seconds. Writes docs/charts/light_extraction.png and docs/charts/light_extraction.json.
"""

import importlib.util
import json
import multiprocessing
import os
import pathlib
import resource
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHARTS, CACHE = ROOT / "docs" / "charts", ROOT / "out" / "bench"
WIDTHS = (512, 1024, 2048, 4096, 8192)
COUNTS = (16, 64, 256, 1024, 4096)
METHODS = {
    "median cut": "median_cut.median_cut",
    "variance cut": "median_cut.variance_cut",
    "importance": "importance.importance_sampling",
    "Penrose": "penrose.penrose_sampling",
}
RUNS = 5
SEED = 8192
AIM_SECONDS = {"median cut": 1.5, "Penrose": 3.0}
AIM_GB = 2.5
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")  # Okabe and Ito: told apart by everyone
MARKERS = ("o", "s", "^", "D")


def main():
    """Measure, write the figures, draw them."""
    CACHE.mkdir(parents=True, exist_ok=True)
    cases = [(width, 1024, name) for width in WIDTHS[:-1] for name in METHODS]
    cases += [(WIDTHS[-1], count, name) for count in COUNTS for name in METHODS]
    results = {case: [] for case in cases}
    with tempfile.TemporaryDirectory(dir=CACHE) as folder:
        paths = {width: pathlib.Path(folder) / f"{width}.npy" for width in WIDTHS}
        for width, path in paths.items():
            alone(make_map, path, width)
        for run in range(RUNS):  # in rounds, so that a busy minute of the machine is nobody's alone
            for width, count, name in cases:
                results[width, count, name].append(alone(sample, paths[width], METHODS[name], count))
            print(f"light_extraction: run {run + 1} of {RUNS} done", file=sys.stderr, flush=True)
    rows = [summary(*case, runs) for case, runs in results.items()]
    document = {
        "caption": (
            "Light samplers on Blender's interior.exr, enlarged, with noise in every pixel, W × W/2 pixels: "
            "processor seconds, of all threads, from the array in memory to the samples with their partition "
            f"and energies, the least of {RUNS} runs; largest resident set of the process, the map's array "
            f"in it. a, c: 1,024 lights by width. b, d: {WIDTHS[-1]} × {WIDTHS[-1] // 2} pixels by number of "
            "lights. Dotted: what was aimed at for 1,024 lights on the largest map. Seconds there as ratios "
            f"to median cut: {ratios(rows)}. What does not rise with the count is this machine's allocation "
            "of memory."
        ),
        "cores": os.cpu_count(),
        "runs": RUNS,
        "rows": rows,
    }
    CHARTS.mkdir(parents=True, exist_ok=True)
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "light_extraction.json").write_text(text + "\n", encoding="utf-8")
    draw(rows)
    print(document["caption"])


def summary(width, count, name, runs):
    """Least seconds and largest memory of some runs."""
    return {
        "method": name,
        "width": width,
        "count": count,
        "processor_seconds": round(min(run["processor_seconds"] for run in runs), 3),
        "seconds": round(min(run["seconds"] for run in runs), 3),
        "peak_gb": round(max(run["peak_bytes"] for run in runs) / 1e9, 3),
        "map_gb": round(6e-9 * width**2, 3),
        "samples": runs[0]["samples"],
        "energy_error": max(run["energy_error"] for run in runs),
    }


def alone(function, *arguments):
    """What the function returns in a process of its own: a child starts with its parent's peak otherwise."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(function, arguments)


def make_map(path, width):
    """Save the enlarged map as an array."""
    import cv2
    import numpy as np

    from expanded_panoramas.ibl_toolkit.images import read_panorama

    spec = importlib.util.find_spec("bpy")
    source = next(pathlib.Path(spec.origin).parent.glob("*/datafiles/studiolights/world/interior.exr"))
    image = cv2.resize(read_panorama(source), (width, width // 2), interpolation=cv2.INTER_LINEAR)
    rng = np.random.default_rng(SEED)
    for row in image:
        row *= 0.9 + 0.2 * rng.random((width, 1), dtype=np.float32)
    np.save(path, image)


def sample(path, method, count):
    """Figures of one run; the error is the relative one of the samples' energy."""
    import numpy as np

    from expanded_panoramas.ibl_toolkit.light import light_map

    module, function = method.split(".")
    sampler = getattr(importlib.import_module(f"expanded_panoramas.ibl_toolkit.light.{module}"), function)
    sampler(np.ones((16, 32, 3), np.float32), 2)  # what is read or compiled once only
    image = np.load(path)
    start, start_busy = time.perf_counter(), time.process_time()
    samples = sampler(image, count)
    seconds, busy = time.perf_counter() - start, time.process_time() - start_busy
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    error = np.abs(samples.irradiance.sum(axis=0) / light_map.irradiance(image) - 1).max()
    return {
        "seconds": seconds,
        "processor_seconds": busy,
        "peak_bytes": peak,
        "samples": len(samples),
        "energy_error": float(error),
    }


def ratios(rows):
    """Processor seconds of the methods at 1,024 lights on the largest map, against median cut's, as text."""
    largest = [row for row in rows if (row["width"], row["count"]) == (WIDTHS[-1], 1024)]
    seconds = {row["method"]: row["processor_seconds"] for row in largest}
    return ", ".join(f"{name} {value / seconds['median cut']:.2f}" for name, value in seconds.items())


def draw(rows):
    """The four panels."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 2, figsize=(9.0, 6.8), constrained_layout=True)
    for column, (variable, ticks, label) in enumerate(
        [("width", WIDTHS, "width of the map [pixels]"), ("count", COUNTS, "number of lights")]
    ):
        chosen = [
            r for r in rows if (r["count"] == 1024 if variable == "width" else r["width"] == WIDTHS[-1])
        ]
        for row, figure_name in enumerate(("processor_seconds", "peak_gb")):
            plot(axes[row, column], chosen, variable, figure_name)
            axes[row, column].set(xscale="log", xlabel=label)
            axes[row, column].set_xticks(ticks, [str(tick) for tick in ticks])
            axes[row, column].minorticks_off()
    for axis in axes[0]:
        axis.set(yscale="log", ylim=(0.03, 12), ylabel="processor time [s]")
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.yaxis.set_minor_formatter(NullFormatter())
        for (name, aim), colour in zip(AIM_SECONDS.items(), (COLOURS[0], COLOURS[3]), strict=True):
            axis.axhline(aim, color=colour, lw=1.0, ls=":", label=f"aim for {name}")
    axes[1, 0].plot(WIDTHS, [6e-9 * width**2 for width in WIDTHS], color="0.5", lw=1.0, label="the map alone")
    for axis in axes[1]:
        axis.axhline(AIM_GB, color="0.2", lw=1.0, ls=":", label="aim")
        axis.set(ylim=(0, 1.1 * AIM_GB), ylabel="peak memory [GB]")
    for letter, axis in zip("abcd", axes.flat, strict=True):
        axis.set_title(letter, loc="left", fontweight="bold")
        axis.grid(True, color="0.92", lw=0.7)
        axis.set_axisbelow(True)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=6, frameon=False)
    axes[1, 0].legend(*without_methods(axes[1, 0]), frameon=False, fontsize=8)
    figure.savefig(CHARTS / "light_extraction.png", dpi=150)
    plt.close(figure)


def plot(axis, rows, variable, figure):
    """One line per method."""
    for name, colour, marker in zip(METHODS, COLOURS, MARKERS, strict=True):
        own = [row for row in rows if row["method"] == name]
        axis.plot(
            [row[variable] for row in own],
            [row[figure] for row in own],
            color=colour,
            marker=marker,
            ms=5,
            lw=1.4,
            label=name,
        )


def without_methods(axis):
    """Legend entries but those of the methods, which another panel explains."""
    entries = [pair for pair in zip(*axis.get_legend_handles_labels(), strict=True) if pair[1] not in METHODS]
    return zip(*entries, strict=True)


if __name__ == "__main__":
    main()
