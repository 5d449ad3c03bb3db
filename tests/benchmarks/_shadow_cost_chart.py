"""The chart of shadow_cost.py."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from _shadow_charts import BITS, COLOURS, DASHES

METHOD = {"hard": "hard", "PCF 3 × 3": "pcf", "PCF 8 × 8": "pcf", "VSM 7 × 7": "vsm", "EVSM 7 × 7": "evsm"}
ARTICLE_DASHES = {"tablet, 8 + 8": (5, 2), "tablet, packed": (), "desktop": (1, 1)}
UNIT = "frame / frame with VSM, 512², 8 bits"
WIDE = 0.26


def draw(document, path):
    """Table I beside the article's, the frame's parts, and storages beside figure 12."""
    figure, axes = plt.subplots(1, 3, figsize=(14, 4.4), layout="constrained")
    _table(axes[0], document)
    _parts(axes[1], [row for row in document["kinds"] if row["storage"] == "16+16"])
    _methods(axes[2], document)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _table(axis, document):
    for storage, dashes in DASHES.items():
        own = [r for r in document["kinds"] if r["name"] == "VSM 7 × 7" and r["storage"] == storage]
        place, cost = [row["resolution"] for row in own], [row["frame"] for row in own]
        axis.plot(place, cost, color=COLOURS["vsm"], dashes=dashes, marker=".", label=f"{BITS[storage]} bits")
    for name, cost in document["article"].items():
        dashes = ARTICLE_DASHES[name]
        axis.plot(place, cost, color="#888888", dashes=dashes, marker="x", label=f"article: {name}")
    axis.set(title="Table I: VSM", xlabel="texels a side", ylabel=UNIT, xscale="log", yscale="log")
    axis.set_xticks(place, [str(one) for one in place])
    axis.set_yticks([0.5, 1, 2, 4, 8], ["½", "1", "2", "4", "8"])
    axis.minorticks_off()
    axis.legend(frameon=False, fontsize=8, handlelength=2.8)


def _parts(axis, rows):
    """Bars in groups of a method, a bar for each resolution."""
    names = list(METHOD)
    for row in rows:
        sizes = sorted({other["resolution"] for other in rows})
        place = names.index(row["name"]) + WIDE * (sizes.index(row["resolution"]) - 1)
        colour = COLOURS[METHOD[row["name"]]]
        axis.bar(place, row["maps"], WIDE * 0.9, color=colour)
        axis.bar(place, row["picture"], WIDE * 0.9, bottom=row["maps"], color=colour, alpha=0.35)
    axis.set_xticks(range(len(names)), names)
    axis.set(title="512², 1024², 2048², 16 bits: maps (dark) and picture (pale)", ylabel=UNIT)


def _methods(axis, document):
    """Bars in groups of a method, a bar for each storage; at 1024."""
    rows = [row for row in document["kinds"] if row["resolution"] == 1024]
    names, storages = list(METHOD), ["float32", "8+8", "16+16"]
    hatches = dict(zip(storages, ("..", "", "//"), strict=True))
    for row in rows:
        place = names.index(row["name"]) + WIDE * (storages.index(row["storage"]) - 1)
        label = f"{BITS[row['storage']]} bits" if row["name"] == names[0] else None
        colour = COLOURS[METHOD[row["name"]]]
        axis.bar(
            place,
            row["frame"],
            WIDE * 0.9,
            color=colour,
            hatch=hatches[row["storage"]],
            edgecolor="white",
            label=label,
        )
    unit = next(r["frame"] for r in rows if r["name"] == "VSM 7 × 7" and r["storage"] == "8+8")
    article = document["article_methods"]
    places = [names.index(name) for name in article]
    axis.plot(
        places, np.multiply(list(article.values()), unit), "kx", label="article: figure 12, VSM as ours"
    )
    axis.set_xticks(range(len(names)), names)
    axis.set(title="Methods at 1024², by storage", ylabel=UNIT, yscale="log")
    axis.set_yticks([0.5, 1, 2, 4, 8, 16], ["½", "1", "2", "4", "8", "16"])
    axis.minorticks_off()
    axis.legend(frameon=False, fontsize=8)
