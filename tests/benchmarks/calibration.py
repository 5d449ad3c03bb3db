"""Calibration against simulation: error by click noise, distance and size; predicted against true error.

Writes docs/charts/calibration.png and docs/charts/calibration.json.
"""

import json
import pathlib
import sys
import time

import matplotlib
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from expanded_panoramas.ibl_toolkit.calibration import (
    CalibrationError,
    CalibrationPicks,
    KnownLength,
    Rectangle,
    calibrate,
)
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector
from expanded_panoramas.ibl_toolkit.equirectangular import uv_from_direction

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
IMAGE_SIZE = (2048, 1024)  # errors go with the pixel: halve them for 4096 × 2048
CAMERA_HEIGHT = 1.5
CAMERA = rotation_from_vector([0.10, -0.15, 0.40])  # tilted by 10°
TRIALS = 100
SCENES, SCENE_TRIALS = 80, 60
NOISES = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0)  # [pixels]
DISTANCES = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)  # [m] from the point below the camera
SIZES = (0.3, 0.45, 0.7, 1.0, 1.5, 2.2, 3.2)  # [m]
COLOURS = ("#0072b2", "#d55e00", "#009e73")  # Okabe and Ito: told apart by everyone
MARKERS = ("o", "s", "^")


def floor_square(distance, size):
    """Corners (4, 3) of a square on the floor, its middle at a distance in a direction off the axes [m]."""
    corners = size * np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    return corners @ rotation_from_vector([0, 0, 0.3]).T + distance * np.array(
        [np.cos(0.2), np.sin(0.2), 0.0]
    )


def seen(points, camera):
    """Picks of points of the world by the camera at CAMERA_HEIGHT."""
    return uv_from_direction((points - [0.0, 0.0, CAMERA_HEIGHT]) @ camera)


class Scene:
    """A floor rectangle whose first side is known, with other things in sight; its camera is known."""

    def __init__(self, square, camera=CAMERA, wall=None, verticals=None):
        self.square, self.camera, self.wall, self.verticals = square, camera, wall, verticals

    def calibrate(self, rng=None, pixels=0.5):
        """The calibration from its picks, exact or with an error of so many pixels."""

        def pick(points):
            uv = seen(points, self.camera)
            if rng is not None:
                uv = uv + rng.normal(size=uv.shape) * pixels / np.array(IMAGE_SIZE)
                uv[..., 0] %= 1.0
                uv[..., 1] = np.clip(uv[..., 1], 0.0, 1.0)
            return uv

        corners = pick(self.square)
        rectangles = [Rectangle(corners)]
        if self.wall is not None:
            rectangles.append(Rectangle(pick(self.wall), "WALL"))
        verticals = () if self.verticals is None else pick(self.verticals)
        length = KnownLength(corners[:2], np.linalg.norm(self.square[1] - self.square[0]))
        return calibrate(CalibrationPicks(tuple(rectangles), (), verticals, length=length), IMAGE_SIZE)

    def simulate(self, rng, trials, pixels=0.5):
        """Tilt [deg] and height errors [%] and their own predictions, (n, 4), and the share refused."""
        rows = []
        for _ in range(trials):
            try:
                one = self.calibrate(rng, pixels)
            except CalibrationError:
                continue
            difference = one.world_from_panorama[2] - self.camera[2]
            tilt = np.degrees(2.0 * np.arcsin(0.5 * np.linalg.norm(difference)))
            height = 100.0 * (one.camera_height / CAMERA_HEIGHT - 1.0)
            rows.append((tilt, height, one.uncertainty_tilt_deg, one.uncertainty_scale_percent))
        return np.array(rows).reshape(-1, 4), 1.0 - len(rows) / trials


def predicted(scene):
    """(tilt [deg], scale [%]) predicted for exact picks; NaN where they are refused."""
    try:
        one = scene.calibrate()
    except CalibrationError:
        return np.nan, np.nan
    return one.uncertainty_tilt_deg, one.uncertainty_scale_percent


def series(name, variable, values, scenes, rng, pixels=None):
    """Predicted and simulated errors of one scene per value; pixels: click noise per value, else ½."""
    pixels = pixels or [0.5] * len(values)
    result = {"name": name, variable: list(values), "tilt_predicted_deg": [], "tilt_rms_deg": []}
    result |= {"scale_predicted_percent": [], "scale_rms_percent": [], "refused_share": []}
    for scene, noise in zip(scenes, pixels, strict=True):
        tilt, scale = (figure * noise / 0.5 for figure in predicted(scene))
        errors, refused = scene.simulate(rng, TRIALS, noise)
        enough = len(errors) >= TRIALS // 2
        rms = np.sqrt(np.mean(errors[:, :2] ** 2, axis=0)) if enough else (np.nan, np.nan)
        result["tilt_predicted_deg"].append(tilt)
        result["scale_predicted_percent"].append(scale)
        result["tilt_rms_deg"].append(rms[0])
        result["scale_rms_percent"].append(rms[1])
        result["refused_share"].append(refused)
    return result


def furnished(square):
    """The square with a window and two corners of the room, as an artist would pick them."""
    wall = np.array([[3.0, -1.0, 0.9], [3.0, 0.8, 0.9], [3.0, 0.8, 2.1], [3.0, -1.0, 2.1]])
    verticals = np.array([[[3.0, 2.0, 0.2], [3.0, 2.0, 2.5]], [[-2.0, 2.0, 0.1], [-2.0, 2.0, 2.6]]])
    return Scene(square, wall=wall, verticals=verticals)


def random_scene(rng):
    """Any rectangle on the floor, any tilt up to 25°, sometimes with a wall and corners."""
    axis = rng.normal(size=3) * [1.0, 1.0, 0.0]
    camera = rotation_from_vector(axis / np.linalg.norm(axis) * np.radians(rng.uniform(0.0, 25.0)))
    camera = rotation_from_vector([0.0, 0.0, rng.uniform(-np.pi, np.pi)]) @ camera
    square = floor_square(rng.uniform(0.0, 5.0), 1.0) * [rng.uniform(0.6, 1.6), rng.uniform(0.6, 1.6), 1.0]
    middle = square.mean(axis=0)
    square = middle + (square - middle) * rng.uniform(0.5, 2.5)
    square = middle + (square - middle) @ rotation_from_vector([0.0, 0.0, rng.uniform(0, np.pi)]).T
    others = furnished(square) if rng.random() < 0.4 else Scene(square)
    return Scene(rectangle_of(square), camera, others.wall, others.verticals)


def rectangle_of(corners):
    """The rectangle on the first side of a sheared one."""
    side = corners[1] - corners[0]
    across = np.array([-side[1], side[0], 0.0]) / np.linalg.norm(side)
    across *= np.dot(corners[3] - corners[0], across)
    return np.array([corners[0], corners[1], corners[1] + across, corners[0] + across])


def prediction_against_truth(rng):
    """Per random scene the predicted and the simulated σ, and over all trials how far errors reach."""
    scenes, reached = [], []
    while len(scenes) < SCENES:
        scene = random_scene(rng)
        tilt, scale = predicted(scene)
        if np.isnan(tilt):
            continue
        errors, refused = scene.simulate(rng, SCENE_TRIALS)
        if len(errors) < SCENE_TRIALS // 2:
            continue
        rms = np.sqrt(np.mean(errors[:, :2] ** 2, axis=0))
        scenes.append((tilt, rms[0], scale, rms[1], refused))
        reached.append(np.abs(errors[:, :2]) / errors[:, 2:])
    return np.array(scenes), np.concatenate(reached)


def coverage(reached):
    """Shares of trials within 1 and 2 predicted σ, and quantiles of error over prediction."""
    levels = (0.5, 0.683, 0.9, 0.954, 0.99)
    return {
        "within_1_sigma": float(np.mean(reached <= 1.0)),
        "within_2_sigma": float(np.mean(reached <= 2.0)),
        "quantiles": {f"{level:g}": float(np.quantile(reached, level)) for level in levels},
    }


def plot_series(axes, all_series, variable, figure, unit):
    """Lines for the prediction, marks for the simulation."""
    for one, colour, marker in zip(all_series, COLOURS, MARKERS, strict=False):
        axes.plot(one[variable], one[f"{figure}_predicted_{unit}"], color=colour, lw=1.4)
        axes.plot(one[variable], one[f"{figure}_rms_{unit}"], marker, color=colour, ms=5, label=one["name"])
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.legend(frameon=False, fontsize=8)


def plot_scatter(axes, scenes):
    """Simulated against predicted σ of random scenes."""
    axes.plot(scenes[:, 0], scenes[:, 1], "o", ms=4, color=COLOURS[0], alpha=0.7, label="tilt [°]")
    axes.plot(scenes[:, 2], scenes[:, 3], "s", ms=4, color=COLOURS[1], alpha=0.7, label="scale [%]")
    low, high = 0.7 * scenes[:, :4].min(), 1.5 * scenes[:, :4].max()
    ends = np.array([low, high])
    axes.plot(ends, ends, color="0.2", lw=1.0)
    axes.fill_between(ends, 0.8 * ends, 1.25 * ends, color="0.88", lw=0, label="ratio 0.8 to 1.25", zorder=0)
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set(xlabel="predicted error, one σ", ylabel="simulated error, rms")
    axes.legend(frameon=False, fontsize=8)


def plot_reach(axes, reached):
    """Share of trials whose error is within k predicted σ, with what normal errors would give."""
    k = np.linspace(0.0, 3.0, 301)
    ordered = np.sort(reached, axis=0)
    for column, name in enumerate(("tilt", "scale")):
        share = np.searchsorted(ordered[:, column], k, side="right") / len(ordered)
        axes.plot(k, 100.0 * share, color=COLOURS[column], lw=1.6, label=f"{name}, simulated")
    # erf by the trapezium rule: numpy has none
    density = np.sqrt(2.0 / np.pi) * np.exp(-0.5 * k * k)
    flat = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * (k[1] - k[0]))])
    axes.plot(k, 100.0 * flat, color="0.2", lw=1.0, ls="--", label="normal, one direction")
    axes.plot(
        k, 100.0 * (1.0 - np.exp(-k * k)), color="0.2", lw=1.0, ls=":", label="normal, two equal directions"
    )
    axes.set(
        xlabel="error / predicted σ of the same picks",
        ylabel="share of trials [%]",
        xlim=(0, 3),
        ylim=(0, 102),
    )
    axes.legend(frameon=False, fontsize=8, loc="lower right")


def draw(by_noise, by_distance, by_size, scenes, reached):
    """The six panels."""
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 3, figsize=(12.0, 7.2), constrained_layout=True)
    plot_series(axes[0, 0], by_noise, "noise_pixels", "tilt", "deg")
    axes[0, 0].set(
        xscale="log", xlabel="click noise, one σ [pixels]", ylabel="error of the vertical, rms [°]"
    )
    axes[0, 0].set_xticks(NOISES, [f"{noise:g}" for noise in NOISES])
    axes[0, 0].minorticks_off()
    plot_series(axes[0, 1], by_distance, "distance_m", "tilt", "deg")
    axes[0, 1].set(xlabel="distance of the square on the floor [m]", ylabel="error of the vertical, rms [°]")
    plot_series(axes[0, 2], by_distance, "distance_m", "scale", "percent")
    axes[0, 2].set(
        xlabel="distance of the square on the floor [m]", ylabel="error of the camera height, rms [%]"
    )
    plot_series(axes[1, 0], by_size, "size_m", "tilt", "deg")
    axes[1, 0].set(xscale="log", xlabel="side of the square [m]", ylabel="error of the vertical, rms [°]")
    axes[1, 0].set_xticks(SIZES, [f"{size:g}" for size in SIZES])
    axes[1, 0].minorticks_off()
    plot_scatter(axes[1, 1], scenes)
    plot_reach(axes[1, 2], reached)
    for letter, one in zip("abcdef", axes.flat, strict=True):
        one.set_title(letter, loc="left", fontweight="bold")
        one.grid(True, color="0.92", lw=0.7)
        one.set_axisbelow(True)
    figure.savefig(CHARTS / "calibration.png", dpi=150)
    plt.close(figure)


def main():
    """Simulate, write the numbers, draw them."""
    began = time.perf_counter()
    rng = np.random.default_rng(2013)

    def say(text):
        print(f"calibration: {text} ({time.perf_counter() - began:.0f} s)", file=sys.stderr, flush=True)

    reference = floor_square(2.0, 1.0)
    cases = [
        ("1 m square, 2 m away", Scene(reference)),
        ("… with a window and 2 corners", furnished(reference)),
    ]
    by_noise = [
        series(name, "noise_pixels", NOISES, [one] * len(NOISES), rng, list(NOISES)) for name, one in cases
    ]
    say("click noise done")
    by_distance = [
        series(
            f"side {size:g} m",
            "distance_m",
            DISTANCES,
            [Scene(floor_square(d, size)) for d in DISTANCES],
            rng,
        )
        for size in (0.5, 1.0, 2.0)
    ]
    say("distance done")
    by_size = [
        series(
            f"{distance:g} m away", "size_m", SIZES, [Scene(floor_square(distance, s)) for s in SIZES], rng
        )
        for distance in (0.0, 2.0, 5.0)
    ]
    say("size done")
    scenes, reached = prediction_against_truth(rng)
    ratios = {"tilt": scenes[:, 1] / scenes[:, 0], "scale": scenes[:, 3] / scenes[:, 2]}
    report = {
        "caption": (
            f"Calibration from a floor rectangle whose first side is known, {IMAGE_SIZE[0]} × "
            f"{IMAGE_SIZE[1]} panorama, camera at {CAMERA_HEIGHT} m tilted by 10°. Marks: rms of {TRIALS} "
            f"simulated calibrations with normal click errors; lines: first-order prediction from the exact "
            f"picks. Refused trials don't count, and nothing is drawn where most are (refused_share). a: "
            f"against click noise. b, c: against distance at half a pixel. d: against size at half a pixel. "
            f"e: {SCENES} random scenes, rms of {SCENE_TRIALS} trials each. f: share of these trials within "
            f"k predicted σ."
        ),
        "image_size": IMAGE_SIZE,
        "trials": TRIALS,
        "by_noise": by_noise,
        "by_distance": by_distance,
        "by_size": by_size,
        "random_scenes": {
            "scenes": SCENES,
            "trials_each": SCENE_TRIALS,
            "refused_share": float(scenes[:, 4].mean()),
            "simulated_over_predicted": {
                name: {f"{q:g}": float(np.quantile(ratio, q)) for q in (0.05, 0.5, 0.95)}
                for name, ratio in ratios.items()
            },
            "tilt": coverage(reached[:, 0]),
            "scale": coverage(reached[:, 1]),
            "expected_within_1_sigma": {"tilt": [0.632, 0.683], "scale": 0.683},
            "expected_within_2_sigma": {"tilt": [0.954, 0.982], "scale": 0.954},
        },
    }
    CHARTS.mkdir(parents=True, exist_ok=True)
    text = json.dumps(without_nan(report), indent=1, ensure_ascii=False)
    (CHARTS / "calibration.json").write_text(text + "\n", encoding="utf-8")
    draw(by_noise, by_distance, by_size, scenes, reached)
    say("docs/charts/calibration.png and .json written")
    print(json.dumps(report["random_scenes"]))


def without_nan(value):
    """The same report with None for NaN, which JSON lacks, and no more digits than the simulation carries."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(item) for item in value]
    if isinstance(value, (float, np.floating)):
        return None if np.isnan(value) else float(f"{value:.4g}")
    return value


if __name__ == "__main__":
    main()
