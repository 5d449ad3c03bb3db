"""Accuracy of snapping to corners whose place is known, what it takes for a corner, and its cost.

Writes docs/charts/corner_snap.json and corner_snap.png.
"""

import json
import pathlib
import sys
import time

import matplotlib
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from corner_pictures import PLACES, error_rows, moved, picture

from expanded_panoramas.ibl_toolkit.corner_snap import snap_to_corner

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
TURNS_DEG = (0, 25, 50, 70)
CLICKS = ((2.5, 1.0), (-1.5, 3.0), (0.3, -0.2), (-4.0, -3.0))
"""Beside the corner [rows]."""
NOISES, BLURS = (0.0, 0.02, 0.05, 0.1), (0.5, 0.7, 1.0, 1.4, 2.0)
KINDS = {"checker": "four fields", "corner": "one field"}
NO_CORNER = {
    "edge": {"kind": "edge", "noise": 0.02},
    "noise": {"contrast": 1.0, "noise": 0.3},
    "weak noise": {"contrast": 1.0, "noise": 0.05},
}
TYPICAL_BLUR = 0.7
WIDE = 8192, 4096


def main():
    """Measure and write both files."""
    document = {
        "definitions": "rms distance [rows of the image] of the snapped point to the corner, over turns "
        f"{TURNS_DEG} degrees, clicks {CLICKS} rows beside it, and the places {list(PLACES)}; found: share "
        "of the clicks that were snapped; noise relative to radiance, blur [rows]",
        "noise": [row(kind, noise=noise) for kind in KINDS for noise in NOISES],
        "blur": [row(kind, blur_rows=blur) for kind in KINDS for blur in BLURS],
        "contrast": [
            row("corner", contrast=50.0),
            row("corner", contrast=50.0, noise=0.05),
            row("corner", contrast=1.3, noise=0.02),
            row("checker", contrast=50.0),
        ],
        "false_corners": {name: false_corners(what) for name, what in NO_CORNER.items()},
        "milliseconds_at_8192": milliseconds(),
    }
    text = json.dumps(document, indent=1)
    (CHARTS / "corner_snap.json").write_text(text + "\n", encoding="utf-8")
    draw(document)
    print(text)


def row(kind, **how):
    """Error and success of one kind of picture."""
    snaps = [(snap, uv) for snap, uv in snapped(kind=kind, **how) if snap.is_corner]
    errors = [error_rows(snap.uv, uv) for snap, uv in snaps]
    of_all = len(PLACES) * len(TURNS_DEG) * len(CLICKS)
    rms = float(np.sqrt(np.mean(np.square(errors)))) if errors else None
    return {"kind": kind, **how, "rms_rows": rms and round(rms, 3), "found": round(len(snaps) / of_all, 3)}


def false_corners(how):
    """Of how many clicks where there is no corner so many were snapped."""
    snaps = [snap for snap, _ in snapped(**how)]
    return {"clicks": len(snaps), "snapped": sum(snap.is_corner for snap in snaps)}


def snapped(**how):
    """(Snap, place of the corner) of every click on every picture."""
    for number, (uv, turn) in enumerate((uv, turn) for uv in PLACES.values() for turn in TURNS_DEG):
        image = picture(uv, turn, seed=number, **how)
        for click in CLICKS:
            yield snap_to_corner(image, moved(uv, *click)), uv


def milliseconds():
    """Processor time of a snap on a wide panorama."""
    small = picture(PLACES["middle"], 25)
    image = np.tile(small, (WIDE[1] // small.shape[0], WIDE[0] // small.shape[1], 1))
    start, count = time.process_time(), 50
    for _ in range(count):
        snap_to_corner(image, PLACES["middle"])
    return round(1000 * (time.process_time() - start) / count, 2)


def draw(document):
    """Error against noise and against blur."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    for axis, name, key in zip(axes, ("noise", "blur"), ("noise", "blur_rows"), strict=True):
        for kind, label in KINDS.items():
            rows = [r for r in document[name] if r["kind"] == kind and r["rms_rows"] is not None]
            axis.plot([r[key] for r in rows], [r["rms_rows"] for r in rows], marker="o", label=label)
        axis.set(ylabel="rms error [rows]", ylim=(0, None))
        axis.grid(alpha=0.3)
    axes[0].set_xlabel(f"noise, relative (blur {TYPICAL_BLUR} rows)")
    axes[1].set_xlabel("blur [rows] (no noise)")
    axes[0].legend(frameon=False)
    figure.savefig(CHARTS / "corner_snap.png", dpi=90)
    plt.close(figure)


if __name__ == "__main__":
    main()
