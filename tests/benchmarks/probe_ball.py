"""Angular error of light directions from photographs of balls with known lights.

Writes docs/charts/probe_ball.json and probe_ball.png, and docs/images/probe_photo.jpg, the manual's example.
"""

import functools
import json
import pathlib
import sys
import time

import cv2
import matplotlib
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from probe_photos import (
    Lamp,
    angle_deg,
    ball_of_pixels,
    codes,
    degraded,
    desk_before,
    hdr,
    ldr,
    photograph,
    unit,
)

from expanded_panoramas.ibl_toolkit.mobile.probe import (
    Ball,
    PhotoCamera,
    ProbeError,
    estimate_lights,
    find_marker,
    place_ball,
)
from expanded_panoramas.ibl_toolkit.mobile.probe.ball import reflected
from expanded_panoramas.ibl_toolkit.mobile.probe.components import maximum_components
from expanded_panoramas.ibl_toolkit.mobile.probe.mirror import reflected_centroid
from expanded_panoramas.ibl_toolkit.mobile.probe.samples import in_picture, on_ball

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
CHARTS = DOCS / "charts"
KINDS = {"mirror": "mirror ball", "diffuse": "diffuse ball"}
CASES = 10
DIAMETER, NOISE, BLUR, LIGHTS = 100, 0.02, 0.7, 1
"""What holds where nothing else is said."""
DIAMETERS, NOISES, BLURS, COUNTS = (
    (20, 35, 50, 100, 200),
    (0, 0.02, 0.05, 0.1),
    (0, 0.7, 1.5, 3.0),
    (1, 2, 3, 4),
)
MISSED_DEG = 10.0
DEFINITIONS = (
    f"angle [degrees] between each true light and the nearest one found, over {CASES} random places and sets "
    f"of lights; missed: share of the lights that none is within {MISSED_DEG} degrees of; doubted: share of "
    "the photographs with a warning that a direction is uncertain. "
    f"Ball of {DIAMETER} px, noise {NOISE} of the median (growing with the root of the signal), blur {BLUR} "
    f"px, {LIGHTS} light, unless said otherwise; 8-bit sRGB, with clipped highlights on the mirror; ball "
    "found by its outline's edges. Lamps are discs of 1.5 to 6 degrees radius in a smooth room"
)
APART_DEG = 40.0
HIDDEN_DEG = {"mirror": 30.0, "diffuse": 65.0}
"""Lights this near to the direction from camera to ball stand behind it."""


def main():
    """Measure, and write the files."""
    write_example()
    document = {
        "definitions": DEFINITIONS,
        "by_diameter_px": [row(kind, diameter=d) for kind in KINDS for d in DIAMETERS],
        "by_noise": [row(kind, noise=n) for kind in KINDS for n in NOISES],
        "by_blur_px": [row(kind, blur=b) for kind in KINDS for b in BLURS],
        "by_lights": [row(kind, lights=n) for kind in KINDS for n in COUNTS],
        "hdr": [row(kind, make=hdr) for kind in KINDS],
        "ball_known_exactly": [row(kind, is_placed=True) for kind in KINDS],
        "sphere_domain": [row(kind, domain="sphere") for kind in KINDS],
        "beside_a_marker": [marker_row(kind) for kind in KINDS],
        "as_in_the_paper": paper_rows(),
        "milliseconds": milliseconds(),
    }
    text = json.dumps(document, indent=1)
    (CHARTS / "probe_ball.json").write_text(text + "\n", encoding="utf-8")
    draw(document)
    print(text)


def write_example():
    """A mirror ball of 10 cm under a warm and a cold lamp, 12 cm to the right of a marker of 10 cm."""
    camera, desk = PhotoCamera.from_35mm(50, 960, 720), desk_before()
    ball = Ball(desk.to_camera((0.12, 0.02, 0.05)), 0.05)
    lamps = [
        Lamp(desk.camera_from_marker @ unit(direction), 4, radiance)
        for direction, radiance in (([0.5, 0.3, 0.8], (60, 54, 30)), ([-0.7, 0.1, 0.6], (15, 15, 30)))
    ]
    image = degraded(photograph(camera, ball, lamps, desk=desk, fine=2), blur_px=BLUR, noise=NOISE)
    picture = (codes(image)[..., ::-1] * 255).round().astype(np.uint8)
    cv2.imwrite(str(DOCS / "images" / "probe_photo.jpg"), picture, [cv2.IMWRITE_JPEG_QUALITY, 92])


_traced = {}


def scene(kind, number, diameter, lights):
    """Camera, ball, lamps and the picture without noise."""
    key = kind, number, diameter, lights
    if key not in _traced:
        random = np.random.default_rng((number, lights))
        width = int(2.6 * diameter)
        camera = PhotoCamera.from_fov(40, width, width)
        ball = ball_of_pixels(camera, diameter, random.uniform(-0.12, 0.12, 2))
        lamps = random_lamps(random, lights, ball.axis, HIDDEN_DEG[kind], 4.0 if kind == "diffuse" else 1.0)
        image = photograph(camera, ball, lamps, kind=kind, fine=3)
        _traced[key] = camera, ball, lamps, image
    return _traced[key]


def random_lamps(random, count, axis, hidden_deg, strength, up=None):
    lamps = []
    while len(lamps) < count:
        direction = unit(random.normal(size=3))
        behind = angle_deg(direction, axis) < hidden_deg or (up is not None and direction @ up < 0.17)
        if behind or any(angle_deg(direction, lamp.direction) < APART_DEG for lamp in lamps):
            continue
        radius = random.uniform(1.5, 6)
        power = random.uniform(0.4, 1) * strength  # of each lamp's irradiance
        colour = random.uniform(0.7, 1, 3)
        lamps.append(Lamp(direction, radius, tuple(power * colour / np.sin(np.radians(radius)) ** 2 / np.pi)))
    return lamps


def exposed(kind, image, camera, ball):
    """8-bit: the room at its place for a mirror ball, whose lamps are clipped; the shading for a matt one."""
    if kind == "mirror":
        return ldr(image)
    return ldr(image, 0.8 / np.percentile(in_picture(hdr(image), camera, ball).luminance, 98))


@functools.cache
def row(
    kind,
    *,
    diameter=DIAMETER,
    noise=NOISE,
    blur=BLUR,
    lights=LIGHTS,
    make=None,
    is_placed=False,
    domain="image",
):
    """Errors of one kind of photograph."""
    errors, doubted, failures = [], 0, 0
    for number in range(CASES):
        camera, ball, lamps, image = scene(kind, number, diameter, lights)
        image = degraded(image, blur_px=blur, noise=noise, seed=number)
        photo = make(image) if make else exposed(kind, image, camera, ball)
        try:
            placed = ball if is_placed else place_ball(photo, camera).ball
            estimate = estimate_lights(photo, camera, placed, kind, lights, domain)
            found = estimate.lights
            doubted += any("direction is uncertain" in warning for warning in estimate.warnings)
        except ProbeError:
            failures += 1
            found = []
        errors += [
            min((angle_deg(f.direction, lamp.direction) for f in found), default=180.0) for lamp in lamps
        ]
    how = {"diameter_px": diameter, "noise": noise, "blur_px": blur, "lights": lights}
    return {"kind": kind, **how, **summary(errors), "doubted": doubted / CASES, "refused": failures}


def summary(errors):
    """Quantiles over all lights, and the missed ones' share."""
    errors = np.array(errors)
    return {
        "median_deg": round(float(np.median(errors)), 3),
        "p90_deg": round(float(np.percentile(errors, 90)), 3),
        "missed": round(float(np.mean(errors > MISSED_DEG)), 3),
    }


def marker_row(kind):
    """Errors in the marker's frame: pose of the marker, ball by its place, light of the desk's upper side."""
    errors, poses = [], []
    for number in range(CASES):
        random = np.random.default_rng((99, number))
        desk = desk_before(random.uniform(0.35, 0.6), random.uniform(0.45, 0.65))
        place = np.array([random.uniform(0.1, 0.14), random.uniform(-0.04, 0.06), 0.05])
        ball = Ball(desk.to_camera(place), 0.05)
        focal = DIAMETER / 2 / np.tan(ball.angular_radius)
        camera = PhotoCamera.from_focal(focal, int(0.9 * focal), int(0.68 * focal))
        up = desk.camera_from_marker[:, 2]
        lamps = random_lamps(random, 1, ball.axis, HIDDEN_DEG[kind], 4.0 if kind == "diffuse" else 1.0, up)
        image = photograph(camera, ball, lamps, kind=kind, desk=desk, fine=3)
        image = degraded(image, blur_px=BLUR, noise=NOISE, seed=number)
        photo = exposed(kind, image, camera, ball)
        pose = find_marker(photo, camera, desk.side)
        placed = place_ball(photo, camera, pose=pose, radius=0.05, centre=place)
        (light, *_) = estimate_lights(photo, camera, placed.ball, kind, 1, pose=pose).lights
        true = desk.camera_from_marker.T @ lamps[0].direction
        errors.append(angle_deg(pose.marker_from_camera @ light.direction, true))
        poses.append(angle_deg(pose.marker_from_camera[2], up))
    return {"kind": kind, **summary(errors), "tilt_of_pose_median_deg": round(float(np.median(poses)), 3)}


def paper_rows():
    """The paper's centroid of the largest part at the highest luminance, on exactly known balls."""
    rows = []
    for kind in KINDS:
        for name, domain in (("image", in_picture), ("sphere", on_ball)):
            errors = {"reflected": [], "normal": []}
            for number in range(CASES):
                camera, ball, lamps, image = scene(kind, number, DIAMETER, LIGHTS)
                photo = exposed(kind, degraded(image, blur_px=BLUR, noise=NOISE, seed=number), camera, ball)
                samples = domain(photo, camera, ball)
                largest = maximum_components(samples)[0]
                there = reflected_centroid(ball, camera, samples, largest)
                errors["reflected"].append(angle_deg(there, lamps[0].direction))
                errors["normal"].append(angle_deg(normal_of(there, ball, camera), lamps[0].direction))
            told = "reflected" if kind == "mirror" else "normal"
            rows.append({"kind": kind, "domain": name, "direction": told, **summary(errors[told])})
    return rows


def normal_of(mirrored, ball, camera):
    """The normal that mirrors the ray of sight so: half-way between it and the way back, a few steps."""
    point = ball.centre - ball.radius * ball.axis
    for _ in range(30):
        normal = unit(mirrored - unit(point))
        point = ball.centre + ball.radius * normal
    assert angle_deg(reflected(unit(point), normal), mirrored) < 0.01
    return normal


def milliseconds():
    """Processor time of the steps on one photograph of each kind."""
    result = {}
    for kind in KINDS:
        camera, ball, _, image = scene(kind, 0, DIAMETER, 1)
        photo = exposed(kind, degraded(image, blur_px=BLUR, noise=NOISE), camera, ball)
        steps = {"outline": lambda c=camera, p=photo: place_ball(p, c)}
        for domain in ("image", "sphere"):
            steps[f"lights, {domain}"] = lambda d=domain, c=camera, p=photo, b=ball, k=kind: estimate_lights(
                p, c, b, k, 1, d
            )
        result[kind] = {name: cost(step) for name, step in steps.items()}
    return result


def cost(step):
    start, count = time.process_time(), 5
    for _ in range(count):
        step()
    return round(1000 * (time.process_time() - start) / count, 1)


def draw(document):
    """Error against size, noise, lights and blur."""
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.4), layout="constrained", sharey=True)
    sweeps = (
        ("by_diameter_px", "diameter_px", "diameter of the ball [px]"),
        ("by_noise", "noise", "noise, of the median"),
        ("by_lights", "lights", "lights"),
        ("by_blur_px", "blur_px", "blur [px]"),
    )
    for axis, (name, key, label) in zip(axes, sweeps, strict=True):
        for (kind, what), colour in zip(KINDS.items(), ("tab:blue", "tab:orange"), strict=True):
            rows = [r for r in document[name] if r["kind"] == kind]
            x = [r[key] for r in rows]
            axis.plot(x, [r["median_deg"] for r in rows], marker="o", color=colour, label=f"{what}, median")
            axis.plot(x, [r["p90_deg"] for r in rows], ls=":", color=colour, label="90 of 100")
        axis.set(xlabel=label, yscale="log", ylim=(0.02, 60))
        axis.grid(alpha=0.3, which="both")
    for level, colour in ((1, "tab:blue"), (3, "tab:orange")):
        for axis in axes:
            axis.axhline(level, color=colour, lw=0.7, ls="--")
    axes[0].set(xscale="log", ylabel="error of direction [°]", xticks=DIAMETERS, xticklabels=DIAMETERS)
    axes[0].minorticks_off()
    axes[0].legend(frameon=False, fontsize=8)
    figure.savefig(CHARTS / "probe_ball.png", dpi=90)
    plt.close(figure)


if __name__ == "__main__":
    main()
