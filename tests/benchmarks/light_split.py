"""The split of the maps that ship with Blender: the thesis's Fig. 3-3 for each, and what the default chooses.

Writes docs/charts/light_split.png and docs/charts/light_split.json.
"""

import importlib.util
import json
import pathlib

import numpy as np

from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.extraction import extract_lights
from expanded_panoramas.ibl_toolkit.light.split import split, two_trapezoid_curves

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
SHARES = (0.25, 0.5, 0.75)
DRAWN = 2000  # points of a curve
COLOURS = {"f": "#0072b2", "g": "#009e73", "ζ": "#d55e00"}  # Okabe and Ito: told apart by everyone
DASHES = {"f": (), "g": (), "ζ": (3, 2)}  # f shows through it where the two are one


def main():
    """Split, write the figures, draw the curves."""
    maps = {path.stem: read_panorama(path) for path in world_maps()}
    document = {
        "caption": "Maps that ship with Blender, 1024 × 512. Curves of Fig. 3-3 against the part of the "
        "sphere that the brightest pixels cover: f luminance, g its integral, ζ the two trapezoids, each "
        "divided by its largest value. Grey: bright part A by the two-trapezoid rule, with its share p of "
        "the light",
        "rows": {name: row(image) for name, image in maps.items()},
    }
    CHARTS.mkdir(parents=True, exist_ok=True)
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "light_split.json").write_text(text + "\n", encoding="utf-8")
    draw(maps)
    for name, values in document["rows"].items():
        print(f"{name:10}", json.dumps(values))


def world_maps():
    """Paths of the maps, in alphabetical order."""
    spec = importlib.util.find_spec("bpy")
    return sorted(pathlib.Path(spec.origin).parent.glob("*/datafiles/studiolights/world/*.exr"))


def row(image):
    """Figures of one map; areas are parts of the sphere."""
    bright = split(image)
    # A threshold by hand is never left alone: so many lights it would be.
    by_hand = extract_lights(image, threshold=bright.share * (1 - 1e-9))
    default = extract_lights(image)
    return {
        "share": significant(bright.share),
        "area": significant(bright.area),
        "level_over_mean": significant(bright.level / mean_luminance(image)),
        "area_by_share": {str(share): significant(split(image, share).area) for share in SHARES},
        "lights": len(by_hand.samples),
        "lights_by_default": len(default.samples),
        "lights_by_default_at_depth": len(extract_lights(image, depth=np.ones(image.shape[:2])).samples),
        "reason": default.reason,
    }


def mean_luminance(image):
    """Over the sphere."""
    x, _, g, _ = two_trapezoid_curves(image)
    return g[-1] / x[-1]


def significant(number):
    """Three digits."""
    return float(f"{number:.3g}")


def draw(maps):
    """A panel for each map."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 4, figsize=(12, 5.4), layout="constrained", sharex=True, sharey=True)
    for axis, (name, image) in zip(axes.flat, maps.items(), strict=True):
        x, f, g, zeta = two_trapezoid_curves(image)
        chosen = np.unique(np.geomspace(1, len(x), DRAWN).astype(int) - 1)
        percent = 100 * x[chosen] / x[-1]
        for (label, colour), curve in zip(COLOURS.items(), (f, g, zeta), strict=True):
            axis.plot(percent, curve[chosen] / curve.max(), color=colour, label=label, dashes=DASHES[label])
        bright = split(image)
        axis.axvspan(percent[0] / 2, 100 * bright.area, color="0.9", zorder=0)
        axis.axvline(100 * bright.area, color="0.5", linewidth=0.8)
        axis.set(
            title=f"{name}: p = {bright.share:.2f}", xscale="log", xlim=(percent[0], 100), ylim=(0, 1.02)
        )
    for axis in axes[1]:
        axis.set_xlabel("area x [% of the sphere]")
    axes[0, 0].legend(frameon=False, loc="center left")
    figure.savefig(CHARTS / "light_split.png", dpi=110)
    plt.close(figure)


if __name__ == "__main__":
    main()
