"""The chart of `layer_views`."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

BOUND, ROOM_RADIUS = "bound", 1.0
# Okabe and Ito: told apart by everyone.
STYLES = {
    "splat": {"color": "#e69f00", "marker": "s"},
    "adaptive": {"color": "#0072b2", "marker": "^"},
    "grid": {"color": "0.35", "marker": "o"},
    "quadtree": {"color": "#cc79a7", "marker": "v"},
    "mesh": {"color": "#d55e00", "marker": "D"},
    BOUND: {"color": "0.6", "marker": "_", "linestyle": ":"},
}


def draw(document, path):
    """Error against time, against distance from the centre, by view, and by kind of layers."""
    plt.rcParams.update(
        {
            "font.size": 8,
            "axes.titlesize": 8.5,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "lines.markersize": 4,
            "lines.linewidth": 1.2,
        }
    )
    figure, axes = plt.subplots(2, 2, figsize=(11, 7.6), layout="constrained")
    compared = [row for row in document["rows"] if row["width"] == document["kinds_width"]]
    kinds = list(dict.fromkeys(row["kind"] for row in compared))
    usual = [row for row in document["rows"] if row["width"] == document["usual"]]
    two = [row for row in usual if row["kind"] == kinds[0]]
    _times(axes[0, 0], [row for row in document["rows"] if row["kind"] == kinds[0] and row["view"] == "C1"])
    _distances(axes[0, 1], [row for row in two if row["view"].endswith(" m")])
    _views(axes[1, 0], [row for row in two if not row["view"].endswith(" m")])
    _kinds(axes[1, 1], compared, kinds)
    for axis in axes.flat:
        axis.set_ylabel("PSNR [dB]")
        axis.grid(alpha=0.3)
    handles = [plt.Line2D([], [], label=method, **style) for method, style in STYLES.items()]
    figure.legend(handles=handles, frameon=False, loc="outside lower center", ncols=len(handles))
    figure.savefig(path, dpi=110)
    plt.close(figure)


def sheet(pictures, path):
    """Pictures (H, W, 3) of display values by title, in rows of three."""
    figure, axes = plt.subplots(2, 3, figsize=(12, 4.9), layout="constrained")
    for axis, (title, picture) in zip(axes.flat, pictures.items(), strict=True):
        axis.imshow(picture)
        axis.set_title(title)
        axis.axis("off")
    figure.savefig(path, dpi=110, pil_kwargs={"quality": 90})
    plt.close(figure)


def _times(axis, rows):
    for method in STYLES:
        points = sorted((r for r in rows if r["method"] == method), key=lambda row: row["width"])
        if method == BOUND:
            for row in points:
                axis.axhline(row["psnr"], color="0.6", linestyle=":")
                axis.annotate(
                    f"bound, {row['width']} px",
                    (0.995, row["psnr"]),
                    xycoords=("axes fraction", "data"),
                    ha="right",
                    va="bottom",
                    fontsize=6,
                )
            continue
        whole = [row["prepare_seconds"] + row["seconds"] for row in points]
        axis.plot(whole, [row["psnr"] for row in points], **STYLES[method])
        if any(row["prepare_seconds"] for row in points):  # a second view has its meshes
            axis.plot(
                [row["seconds"] for row in points],
                [row["psnr"] for row in points],
                **STYLES[method] | {"linestyle": "--", "markerfacecolor": "none"},
            )
    axis.set(xscale="log", xlabel="processor seconds; dashed: meshes made before")
    axis.set_xticks([0.5, 1, 2, 5, 10, 20], ["0.5", "1", "2", "5", "10", "20"])
    axis.minorticks_off()
    axis.set_title("C1, layers of rising resolution")


def _distances(axis, rows):
    for method, style in STYLES.items():
        points = sorted((r for r in rows if r["method"] == method), key=lambda row: row["from_centre"])
        axis.plot([r["from_centre"] for r in points], [r["psnr"] for r in points], **style)
    axis.axvline(ROOM_RADIUS, color="0.3", linewidth=0.8)
    axis.annotate("radius", (ROOM_RADIUS, 0.02), xycoords=("data", "axes fraction"), fontsize=7)
    axis.set(xlabel="eye's distance from the centre [m]")
    axis.set_title("beside the centre, and beyond the radius")


def _views(axis, rows):
    names = list(dict.fromkeys(row["view"] for row in rows))
    for method, style in STYLES.items():
        values = {row["view"]: row["psnr"] for row in rows if row["method"] == method}
        axis.plot(range(len(names)), [values[name] for name in names], **style | {"linestyle": "none"})
    axis.set_xticks(range(len(names)), names)
    axis.set_title("views of Table 8.1, and C1")


def _kinds(axis, rows, kinds):
    for method, style in STYLES.items():
        means = []
        for kind in kinds:
            found = [row["psnr"] for row in rows if (row["kind"], row["method"]) == (kind, method)]
            means.append(sum(found) / len(found))
        axis.plot(range(len(kinds)), means, **style | {"linestyle": "none"})
    axis.set_xticks(range(len(kinds)), [kind.replace(" of ", "\nof ") for kind in kinds])
    axis.set_title("kinds of layers: mean over four views beside the centre")
