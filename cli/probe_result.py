"""What `panorama probe` prints of a light, a ball and a marker."""

import math

import numpy as np

from ..ibl_toolkit.equirectangular import uv_from_direction
from ..ibl_toolkit.mobile.probe import PANORAMA_FROM_CAMERA


def light_json(light, strongest, pose):
    """A ProbeLight; strongest: luminance of the strongest one. pose: of the marker, or None."""
    turn = np.eye(3) if pose is None else pose.marker_from_camera
    direction = turn @ light.direction
    in_panorama = direction if pose is not None else PANORAMA_FROM_CAMERA @ direction
    result = {
        "direction": direction.tolist(),
        "strength": light.luminance / strongest,
        "colour": light.colour.tolist(),
        "irradiance": light.irradiance.tolist(),
        "diameter_deg": number_or_none(light.diameter_deg),
        "uncertainty_deg": number_or_none(light.uncertainty_deg),
        "uv": uv_from_direction(in_panorama).tolist(),
        "cells": light.cells,
        "is_clipped": light.is_clipped,
    }
    if pose is not None:
        result["direction_camera"] = light.direction.tolist()
        result["altitude_deg"] = math.degrees(math.asin(max(-1.0, min(1.0, direction[2]))))
    return result


def ball_json(placed, camera):
    """A PlacedBall."""
    xy = camera.pixels(placed.ball.outline())
    return {
        "placed_by": placed.by,
        "centre": np.asarray(placed.ball.centre).tolist(),
        "radius": placed.ball.radius,
        "unit": "m" if placed.is_metric else "radii",
        "centre_px": camera.pixels(placed.ball.axis).tolist(),
        "diameter_px": float(np.mean(np.nanmax(xy, axis=0) - np.nanmin(xy, axis=0))),
        "outline_residual_px": number_or_none(placed.residual_px),
        "outline_coverage": number_or_none(placed.coverage),
    }


def marker_json(pose):
    """A MarkerPose; camera: where it stands in the frame of the marker [m]."""
    return {
        "id": pose.id,
        "residual_px": pose.residual_px,
        "camera": pose.eye.tolist(),
        "marker_from_camera": pose.marker_from_camera.tolist(),
    }


def number_or_none(value):
    """A number, or None for NaN, which JSON does not know."""
    return None if math.isnan(value) else value


def describe(result):
    """One line for each light, and one for the panorama."""
    lines = [_described(number, light, result["frame"]) for number, light in enumerate(result["lights"], 1)]
    if "unwrapped" in result:
        made = result["unwrapped"]
        lines.append("{}: {} × {} px, {:.2%} of it known".format(made["file"], *made["size"], made["known"]))
    return lines


def _described(number, light, frame):
    x, y, z = light["direction"]
    line = f"light {number}  {x:+.4f} {y:+.4f} {z:+.4f} ({frame})  ± {light['uncertainty_deg']:.1f}°"
    if "colour" in light:
        line += f"  strength {light['strength']:.2f}  colour " + " ".join(f"{c:.2f}" for c in light["colour"])
    if "altitude_deg" in light:
        line += f"  {light['altitude_deg']:.1f}° above the plane"
    return line
