"""The charts of `light_rendering`."""

import pathlib

import matplotlib
from _light_cases import DL, FORCED, HIB, MPA, PLAIN

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import NullFormatter

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
# Okabe and Ito: told apart by everyone.
STYLES = {
    PLAIN: {"color": "0.35", "marker": "o"},
    DL: {"color": "#e69f00", "marker": "s"},
    MPA: {"color": "#0072b2", "marker": "^"},
    HIB: {"color": "#d55e00", "marker": "D"},
    FORCED: {"color": "#cc79a7", "marker": "v", "linestyle": ":"},
}
PLACES_IN_A_ROW = 2


def draw(document):
    """A panel for each place and kind of scene; two places in a row."""
    _settings()
    places = list(document["summary"]["places"])
    kinds = list(dict.fromkeys(row["kind"] for row in document["rows"]))
    columns, lines = PLACES_IN_A_ROW * len(kinds), -(-len(places) // PLACES_IN_A_ROW)
    figure, axes = plt.subplots(lines, columns, figsize=(14, 2.05 * lines), layout="constrained")
    for axis in axes.flat:
        axis.set_axis_off()
    for row in document["rows"]:
        line, block = divmod(places.index(row["place"]), PLACES_IN_A_ROW)
        axis = axes[line, block * len(kinds) + kinds.index(row["kind"])]
        axis.set_axis_on()
        for way, values in row["ways"].items():
            if way != HIB or not row["left_alone"]:
                _line(axis, values["points"], way)
        ratio = row["ratios"][HIB]
        of_hybrid = "left alone" if row["left_alone"] else f"{ratio:.{0 if ratio >= 10 else 1}f} ×"
        axis.set_title(f"{row['place']}, {row['kind']}: {of_hybrid}")
    for axis in axes[-1]:
        axis.set_xlabel("processor seconds")
    for axis in axes[:, 0]:
        axis.set_ylabel("MSE")
    _legend(figure, axes, len(places) % PLACES_IN_A_ROW)
    figure.savefig(CHARTS / "light_rendering.png", dpi=100)
    plt.close(figure)


def draw_table(table):
    """Fig. 3-5: error against time of one map and scene."""
    _settings()
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for axis, error, name in zip(axes, ("mse", "flip"), ("MSE", "FLIP"), strict=True):
        for way in (PLAIN, MPA, HIB):
            label = "IS" if way == PLAIN else way
            points = [line for line in table["lines"] if line["way"] == label]
            axis.plot([p["time"] for p in points], [p[error] for p in points], label=label, **STYLES[way])
            for point in points if error == "mse" else ():
                axis.annotate(
                    point["samples"],
                    (point["time"], point[error]),
                    (3, 4),
                    textcoords="offset points",
                    fontsize=7,
                    color=STYLES[way]["color"],
                )
        axis.set(xscale="log", yscale="log", xlabel="time, plain map at 256 samples = 1", ylabel=name)
        axis.grid(alpha=0.3)
    axes[0].set_title(f"{table['place']}, {table['kind']} scene; numbers are samples", fontsize=9)
    axes[0].legend(frameon=False)
    figure.savefig(CHARTS / "light_rendering_table.png", dpi=100)
    plt.close(figure)


def _settings():
    plt.rcParams.update(
        {
            "font.size": 8,
            "axes.titlesize": 7.5,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "lines.markersize": 3.5,
            "lines.linewidth": 1.2,
        }
    )


def _line(axis, points, way):
    shown = [point for point in points if point["mse"] > 0]
    axis.plot([p["seconds"] for p in shown], [p["mse"] for p in shown], **STYLES[way])
    axis.set(xscale="log", yscale="log")
    axis.yaxis.set_minor_formatter(NullFormatter())
    axis.grid(alpha=0.3)


def _legend(figure, axes, has_room):
    handles = [plt.Line2D([], [], label=way, **style) for way, style in STYLES.items()]
    if has_room:
        axes[-1, -1].legend(handles=handles, frameon=False, loc="center")
    else:
        figure.legend(handles=handles, frameon=False, loc="outside lower center", ncols=len(handles))
