"""The charts of shadow_maps.py."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"hard": "#555555", "pcf": "#0072b2", "vsm": "#d55e00", "evsm": "#009e73"}  # Okabe and Ito
DASHES = {"float32": (1, 1), "16+16": (), "8+8": (5, 2)}
NAMES = {"hard": "hard", "pcf": "PCF", "vsm": "VSM", "evsm": "EVSM"}
BITS = {"float32": "32", "16+16": "16", "8+8": "8"}
MARKERS = {"float32": "s", "16+16": "o", "8+8": "^"}
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})


def draw(document, path):
    """Six panels."""
    figure, axes = plt.subplots(2, 3, figsize=(14, 8), layout="constrained")
    _offset(axes[0, 0], document["offset"], "acne", "mean darkness of what is lit")
    _offset(axes[0, 1], document["offset"], "gap_mm", "gap at the foot of a box [mm]")
    _candidates(axes[0, 2], document["candidates"])
    _range(
        axes[1, 0], document["range"], "bleeding", "light on the worst hundredth of the dark", ("vsm", "evsm")
    )
    _range(axes[1, 1], document["range"], "gap_mm", "gap at the foot of a box [mm]", ("hard", "vsm", "evsm"))
    _maps(axes[1, 2], document["maps"])
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _offset(axis, rows, key, label):
    styles = {
        "hard": ("hard", ()),
        "PCF 1 × 1": ("pcf", (1, 1)),
        "PCF 3 × 3": ("pcf", (4, 2)),
        "PCF 7 × 7": ("pcf", ()),
        "VSM 7 × 7": ("vsm", ()),
        "EVSM 7 × 7": ("evsm", (4, 2)),
    }
    for name, (method, dashes) in styles.items():
        own = [row for row in rows if row["name"] == name]
        axis.plot(
            [row["factor"] for row in own],
            [row[key] for row in own],
            color=COLOURS[method],
            dashes=dashes,
            marker=".",
            label=name,
        )
    axis.axvline(1.9, color="0.8", linewidth=0.8, zorder=0)
    axis.text(1.9, axis.get_ylim()[1] * 0.96, " classic", color="0.5", fontsize=8)
    title = "Acne against offset" if key == "acne" else "Peter-panning against offset"
    axis.set(title=f"{title}, 1024, 16 bits", xlabel="factor of glPolygonOffset", ylabel=label)
    axis.legend(frameon=False, fontsize=8, handlelength=2.8)


def _range(axis, rows, key, label, methods):
    for method in methods:
        for storage in DASHES:
            own = [row for row in rows if row["method"] == method and row["storage"] == storage]
            axis.plot(
                [row["times"] for row in own],
                [row[key] for row in own],
                color=COLOURS[method],
                dashes=DASHES[storage],
                marker=".",
                label=f"{NAMES[method]}, {BITS[storage]} bits",
            )
    title = "Light bleeding, window 9" if key == "bleeding" else "Peter-panning, as suggested"
    axis.set(title=title, xlabel="range of depths / that of the scene", ylabel=label, xscale="log")
    axis.set_xticks([row["times"] for row in own], [str(row["times"]) for row in own])
    axis.minorticks_off()
    if key == "bleeding":
        axis.set_ylim(0, 1.35)
    else:
        axis.set(yscale="log", ylim=(0.4, 3000))
    axis.legend(frameon=False, fontsize=8, ncols=len(methods), loc="upper left", handlelength=2.8)


def _maps(axis, rows):
    for method in COLOURS:
        for storage, marker in MARKERS.items():
            own = [row for row in rows if row["method"] == method and row["storage"] == storage]
            axis.plot(
                [row["mebibytes"] for row in own],
                [row["rms"] for row in own],
                color=COLOURS[method],
                dashes=DASHES[storage],
                marker=marker,
                markersize=4,
                label=f"{NAMES[method]}, {BITS[storage]} bits",
            )
    axis.set(
        title="Error against a point lamp, 256² to 2048²",
        xlabel="map [MiB]",
        ylabel="rms error",
        xscale="log",
        yscale="log",
        ylim=(0.012, 0.9),
    )
    axis.minorticks_off()
    axis.set_yticks([0.02, 0.05, 0.1, 0.2], ["0.02", "0.05", "0.1", "0.2"])
    axis.set_xticks([0.0625, 0.25, 1, 4, 16], ["1/16", "1/4", "1", "4", "16"])
    axis.legend(frameon=False, fontsize=7.5, ncols=3, loc="upper left", handlelength=2.8)


def _candidates(axis, rows):
    least = 5e-4
    for place, row in enumerate(rows):
        colour = COLOURS["evsm"] if "ours" in row["name"] else "#bbbbbb"
        axis.barh(place, row["bleeding"], color=colour)
        axis.text(1.1 * least, place, f"{row['name']}, {row['bits']} bits", va="center")
    axis.invert_yaxis()
    axis.set_yticks([])
    axis.set(
        title="Other maps: light bleeding, window 9",
        xlabel="light on the worst hundredth of the dark",
        xscale="log",
        xlim=(least, 1),
    )


def draw_pictures(pictures, side, path):
    """Visibilities seen from above, in rows of six."""
    figure, axes = plt.subplots(2, 6, figsize=(15, 5.4), layout="constrained")
    for axis, (title, found) in zip(axes.flat, pictures.items(), strict=True):
        axis.imshow(np.reshape(found, (side, side)), cmap="gray", vmin=0, vmax=1, origin="lower")
        axis.set_title(title, fontsize=9)
        axis.axis("off")
    figure.savefig(path, dpi=110)
    plt.close(figure)
