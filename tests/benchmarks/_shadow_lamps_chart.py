"""The chart of shadow_lamps.py."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from _shadow_charts import COLOURS

STYLES = {
    "hard": ("hard", ()),
    "PCF 3 × 3": ("pcf", (2, 2)),
    "PCF as wide": ("pcf", ()),
    "VSM as wide": ("vsm", ()),
    "EVSM as wide": ("evsm", ()),
    "EVSM as wide, 512": ("evsm", (4, 2)),
    "EVSM as wide, 256": ("evsm", (1, 1)),
    "PCF as wide, of new things": ("pcf", (6, 1, 1, 1)),
    "VSM as wide, of new things": ("vsm", (6, 1, 1, 1)),
    "EVSM as wide, of new things": ("evsm", (6, 1, 1, 1)),
}


def draw(document, pictures, side, path):
    """Errors of both kinds of light, the truth's own, and pairs of pictures."""
    figure = plt.figure(figsize=(14, 7.4), layout="constrained")
    grid = figure.add_gridspec(2, 6, height_ratios=(1.5, 1))
    axes = [figure.add_subplot(grid[0, 2 * k : 2 * k + 2]) for k in range(3)]
    _errors(axes[0], document["errors"], "sun", "Error against Cycles' sun", "diameter [°]")
    _errors(axes[1], document["errors"], "lamp", "Error against Cycles' lamp, 3 m away", "radius [m]")
    _truth(axes[2], document["truth"])
    for axis in axes[:2]:
        axis.set_ylim(0, 1.05 * max(row["rms"] for row in document["errors"]))
    axes[0].legend(frameon=False, fontsize=8, handlelength=2.8)
    for place, (title, found) in enumerate(pictures.items()):
        axis = figure.add_subplot(grid[1, place])
        axis.imshow(np.reshape(found, (side, side)), cmap="gray", vmin=0, vmax=1, origin="lower")
        axis.set_title(title, fontsize=9)
        axis.set(xlim=(0.12 * side, 0.88 * side), ylim=(0.12 * side, 0.88 * side))
        axis.axis("off")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _errors(axis, rows, light, title, label):
    for name, (method, dashes) in STYLES.items():
        own = [row for row in rows if row["light"] == light and row["name"] == name]
        error = [row["rms"] for row in own]
        axis.plot(_sizes(own), error, color=COLOURS[method], dashes=dashes, marker=".", label=name)
    axis.set(title=title, ylabel="rms error")
    _ticks(axis, own, label)


def _truth(axis, rows):
    for light, marker in (("sun", "o"), ("lamp", "s")):
        own = [row for row in rows if row["light"] == light]
        for key, colour, name in (("traced", "#0072b2", "from traced rays"), ("noise", "#999999", "noise")):
            values = [row[key] for row in own]
            axis.plot(range(len(own)), values, color=colour, marker=marker, label=f"{light}: {name}")
    axis.set(
        title="How sure the truth is", xlabel="size, from a point to the largest", ylabel="rms of Cycles"
    )
    axis.set_xticks([])
    axis.set_ylim(0, None)
    axis.legend(frameon=False, fontsize=8)


def _sizes(rows):
    return [row["size"] for row in rows]


def _ticks(axis, rows, label):
    sizes = _sizes(rows)
    axis.set_xscale("symlog", linthresh=sizes[1])
    axis.set_xticks(sizes, ["sun" if size == 0.53 else f"{size:g}" for size in sizes])
    axis.minorticks_off()
    axis.set_xlabel(label)
