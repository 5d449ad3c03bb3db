"""The strongest lights of a place, from a photograph of a ball."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .diffuse import diffuse_lights
from .errors import ProbeError
from .lights import ProbeLight
from .mirror import mirror_lights
from .samples import in_picture, on_ball
from .shadow import LEAST_ALTITUDE_DEG, low_light

KINDS = ("mirror", "diffuse")
DOMAINS = {"image": in_picture, "sphere": on_ball}
MOST = 16
"""Lights that can be asked for: each costs a device one more shadow map."""
WIDE_DEG = 60.0
"""A light as wide on a mirror ball is none, or the ball is no mirror."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """lights: strongest first. residual: of a diffuse ball's shading, over its mean; NaN for a mirror."""

    lights: tuple[ProbeLight, ...]
    residual: float
    warnings: tuple[str, ...]


def estimate_lights(photo, camera, ball, kind="mirror", count=3, domain="image", pose=None) -> Estimate:
    """The `count` strongest lights, or fewer, of a Photo of a Ball.

    kind: of KINDS. domain: of DOMAINS, where a mirror ball's lights are looked for: the pixels of the image,
    or a grid of fixed size on the ball; a diffuse ball's shading is fitted in either. pose: a MarkerPose,
    against whose plane lights that are low are told.

    Raises: ProbeError for another kind or domain, a count that is not 1 to MOST, and where the ball tells no
    light: beside the frame, too small, saturated, evenly lit.
    """
    if kind not in KINDS or domain not in DOMAINS:
        raise ProbeError(
            f"kind {kind!r} of ball in the domain {domain!r}: must be of {KINDS} and {tuple(DOMAINS)}"
        )
    if not 1 <= count <= MOST:
        raise ProbeError(f"{count} lights: must be 1 to {MOST}")
    samples = DOMAINS[domain](photo, camera, ball)
    if kind == "mirror":
        lights, residual = mirror_lights(samples, count), float("nan")
        notes = list(_of_mirror(lights))
    else:
        lights, residual, told = diffuse_lights(samples, count)
        notes = list(told)
    notes += _clipped(photo, lights, kind)
    if pose is not None:
        notes += _low(lights, pose)
    return Estimate(tuple(lights), residual, tuple(notes))


def _of_mirror(lights):
    for number, light in enumerate(lights, 1):
        if light.diameter_deg > WIDE_DEG:
            yield (
                f"light {number} is {light.diameter_deg:.0f}° wide: a window or bright wall, or the ball is "
                "no mirror, or the exposure too long"
            )
        if light.is_cut:
            yield f"light {number} ends at the rim of the ball or the frame: part of it may be hidden"


def _clipped(photo, lights, kind):
    numbers = [str(number) for number, light in enumerate(lights, 1) if light.is_clipped]
    if not numbers or (kind == "diffuse" and photo.is_hdr):
        return
    which = f"light{'s' if len(numbers) > 1 else ''} {', '.join(numbers)}"
    if photo.is_hdr:
        yield f"{which}: pixels share the photograph's highest value; if that is its limit, they are stronger"
    elif kind == "mirror":
        yield f"{which}: clipped; colour and strength are lower limits, and the order is by size"
    else:
        yield "part of the ball is clipped: it counts as a lower limit"


def _low(lights, pose):
    for number, light in enumerate(lights, 1):
        up = float(np.clip(pose.marker_from_camera[2] @ light.direction, -1, 1))
        altitude = np.degrees(np.arcsin(up))
        if altitude < LEAST_ALTITUDE_DEG:
            yield f"light {number} {low_light(altitude)}"
