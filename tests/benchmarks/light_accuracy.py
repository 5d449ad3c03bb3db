"""Accuracy of the light samplers: how far light is moved, what planes then receive, how even samples are.

Writes docs/charts/light_accuracy.json and light_accuracy.png: the eight maps that ship with Blender by number
of lights, and figures on maps with a known density.
"""

import json
import pathlib

import bpy
import matplotlib
import numpy as np

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.importance import importance_sampling
from expanded_panoramas.ibl_toolkit.light.light_map import luminous_power
from expanded_panoramas.ibl_toolkit.light.median_cut import median_cut, variance_cut
from expanded_panoramas.ibl_toolkit.light.penrose import penrose_sampling

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
SAMPLERS = {
    "median cut": median_cut,
    "variance cut": variance_cut,
    "importance": importance_sampling,
    "Penrose": penrose_sampling,
}
COUNTS = (16, 64, 256, 1024)
PLANES, KNOWN_COUNT, CELLS = 200, 1000, (4, 8)
SMOOTH_RANGE = 31.0


def main():
    """Measure and write both files."""
    folder = pathlib.Path(bpy.utils.resource_path("LOCAL"), "datafiles", "studiolights", "world")
    maps = {path.stem: read_panorama(path) for path in sorted(folder.glob("*.exr"))}
    rows = [row(name, sampler, count, maps) for name, sampler in SAMPLERS.items() for count in COUNTS]
    document = {
        "definitions": {
            "spread_deg": "root mean square angle from light to its sample's direction, weighted by power",
            "irradiance_error_percent": f"root mean square over {PLANES} planes of the relative error of "
            "irradiance; both are geometric means over the eight maps",
            "chi_square": f"per cell of {CELLS[0] * CELLS[1]}, of counts against importance on a smooth map "
            f"of range {SMOOTH_RANGE:g} : 1; 1 for random samples of the right density",
            "nearest": "mean angle to the nearest sample on a constant map over a hexagonal lattice's",
            "solid_angle_spread": "standard deviation over the mean of the regions on a constant map",
        },
        "known_count": KNOWN_COUNT,
        "rows": rows,
        "known": {name: known(sampler) for name, sampler in SAMPLERS.items()},
    }
    (CHARTS / "light_accuracy.json").write_text(json.dumps(document, indent=1) + "\n")
    draw(rows)


def row(name, sampler, count, maps):
    """Both errors of a sampler at a number of lights, over the maps."""
    errors = np.array([errors_of(image, sampler(image, count)) for image in maps.values()])
    spread, irradiance = np.exp(np.log(errors).mean(axis=0))
    return {
        "sampler": name,
        "count": count,
        "spread_deg": round(float(np.degrees(spread)), 2),
        "irradiance_error_percent": round(100 * float(irradiance), 3),
    }


def errors_of(image, samples):
    """Spread [rad] and relative error of irradiance of the samples of a map."""
    directions = equirectangular.pixel_directions(image.shape[1], image.shape[0]).reshape(-1, 3)
    power = luminous_power(image).ravel().astype(float)
    own = samples.directions[samples.partition.ravel()]
    angles = 2 * np.arcsin(np.clip(np.linalg.norm(directions - own, axis=1) / 2, 0, 1))
    normals = np.random.default_rng(1).normal(size=(PLANES, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    truth = np.array([power @ np.maximum(directions @ normal, 0) for normal in normals])
    found = np.maximum(normals @ samples.directions.T, 0) @ samples.luminance
    error = np.sqrt(np.mean((found / truth - 1) ** 2))
    return np.sqrt(power @ angles**2 / power.sum()), error


def known(sampler):
    """Figures on maps whose density is known."""
    u, v = np.meshgrid((np.arange(512) + 0.5) / 512, (np.arange(256) + 0.5) / 256)
    smooth = 1 + (SMOOTH_RANGE - 1) * np.exp(-((u - 0.4) ** 2 * 4 + (v - 0.4) ** 2) / 0.05)
    smooth = np.repeat(smooth[..., None], 3, axis=2).astype(np.float32)
    even = sampler(np.ones((256, 512, 3), np.float32), KNOWN_COUNT)
    cosines = even.directions @ even.directions.T
    np.fill_diagonal(cosines, -1)
    lattice = np.sqrt(2 / np.sqrt(3) * 4 * np.pi / len(even))
    nearest = np.arccos(np.clip(cosines.max(axis=1), -1, 1)).mean() / lattice
    return {
        "chi_square": round(chi_square(smooth, sampler(smooth, KNOWN_COUNT)), 3),
        "nearest": round(float(nearest), 3),
        "solid_angle_spread": round(float(even.solid_angles.std() / even.solid_angles.mean()), 3),
    }


def chi_square(image, samples):
    """Of counts in cells against what importance expects, per cell."""
    rows, columns = CELLS
    height, width = image.shape[:2]
    power = luminous_power(image).astype(float)
    shares = power.reshape(rows, height // rows, columns, width // columns).sum(axis=(1, 3)) / power.sum()
    u, v = samples.uv.T
    counts = np.zeros(CELLS)
    np.add.at(counts, (np.minimum((v * rows).astype(int), rows - 1), (u * columns).astype(int)), 1)
    expected = shares * len(samples)
    return float(((counts - expected) ** 2 / expected).mean())


def draw(rows):
    """Both errors against the number of lights."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    labels = {"spread_deg": "light moved [°]", "irradiance_error_percent": "irradiance error [%]"}
    for axis, (key, label) in zip(axes, labels.items(), strict=True):
        for name in SAMPLERS:
            own = [r for r in rows if r["sampler"] == name]
            axis.loglog([r["count"] for r in own], [r[key] for r in own], marker="o", label=name)
        axis.set(xlabel="lights", ylabel=label)
        axis.grid(alpha=0.3)
    axes[0].legend(frameon=False)
    figure.savefig(CHARTS / "light_accuracy.png", dpi=100)


if __name__ == "__main__":
    main()
