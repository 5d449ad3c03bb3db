"""A panorama's light as a phone has it: few suns and lamps that throw shadows, and light from all around.

The bright part of the map is cut into regions as `light.extraction` does it, and those that a phone's
shadows would hardly tell apart become one. Each is a sun in the direction of its region's light or, where the
distance of what is seen there is known, a lamp at that place. Its strength is the region's vector irradiance
along that direction. The ambient light is what a floor and a ceiling get of the map besides, so that theirs
is the map's; faces that look elsewhere get a mixture of both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from ..light.clustering import cluster
from ..light.extraction import extract_lights
from ..light.light_map import LUMINANCE, check_light_map
from .shadow_maps import LightCamera
from .shadow_scene import MOST_LIGHTS, SceneLight

LIGHT_FROM = ("auto", "scene", "panorama", "both")
"""Where a page's lights come from; auto: the scene's own, or without any its panorama's."""
APART = np.radians(10.0)
"""Lights nearer to each other than this are one [rad]: their shadows of a thing lie less than a fifth of its
height apart."""
MANY = 32
"""Lights that are looked for, before those that are near each other become one."""
LEAST_SHARE = 0.01
"""Of the floor's light: what brings less is left to the ambient light."""
FAINT = 0.2
"""Of the floor's light: shadows that take away less than this altogether are hardly seen."""


@dataclass(frozen=True, eq=False)
class DeviceLights:
    """lights: that which brings most to the floor first. shares: of the floor's light, one for each, as
    luminance. ambient, ambient_down: (3,) irradiance of faces that look up and down, besides [W/m², the
    map's radiance × sr]. warnings: a sentence each."""

    lights: tuple[SceneLight, ...]
    shares: tuple[float, ...]
    ambient: tuple[float, float, float]
    ambient_down: tuple[float, float, float]
    warnings: tuple[str, ...] = ()


def floor_irradiance(image: np.ndarray, up=(0.0, 0.0, 1.0)) -> np.ndarray:
    """(3,) [W/m²] of a floor whose normal in the panorama frame is ``up`` (3,), by a map (H, W, 3) of
    radiance [W/(m² sr)].

    >>> (floor_irradiance(np.ones((64, 128, 3), np.float32)) / np.pi).round(3)
    array([1., 1., 1.])
    """
    height, width = image.shape[:2]
    weights = np.maximum(equirectangular.pixel_directions(width, height) @ np.asarray(up), 0)
    weights *= equirectangular.row_solid_angles(width, height)[:, None]
    return np.einsum("hw,hwc->c", weights, image, dtype=np.float64)


def device_lights(
    image: np.ndarray,
    points: np.ndarray,
    most: int = MOST_LIGHTS,
    origin=(0.0, 0.0, 0.0),
    world_from_panorama=None,
    reach: Callable[[np.ndarray], np.ndarray] | None = None,
) -> DeviceLights:
    """Up to ``most`` lights for what throws shadows, points (n, 3) of the world [m], and the ambient light.

    image: (H, W, 3) radiance; 1024 px of width are enough. origin: (3,) of the panorama in the world [m], and
    world_from_panorama: (3, 3) rotation. reach: of directions (n, 3) in the panorama frame the distances (n,)
    [m] of what is seen there, +inf at infinity; without it all lights are suns. A lamp's strength is right at
    the panorama's origin.

    Raises: ValueError for a map without a light from above, and what `extract_lights` and LightCamera refuse.
    """
    if not 1 <= most <= MOST_LIGHTS:
        raise ValueError(f"{most} lights: must be 1 to {MOST_LIGHTS}")
    image = check_light_map(image)
    turn = np.eye(3) if world_from_panorama is None else np.asarray(world_from_panorama, dtype=np.float64)
    samples = cluster(cluster(extract_lights(image, count=MANY).samples, least_angle=APART), count=most)
    vectors = _vectors(image, samples.partition)
    directions = np.einsum("c,ncx->nx", LUMINANCE, vectors)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    strengths = np.einsum("ncx,nx->nc", vectors, directions).clip(0)
    whole = np.array([floor_irradiance(image, up) for up in (turn[2], -turn[2])])
    heights = directions @ turn[2]
    kept = _worth_it(strengths @ LUMINANCE * heights / max(whole[0] @ LUMINANCE, 1e-30))
    distances = np.full(len(kept), np.inf) if reach is None else reach(directions[list(kept)])
    lights = [
        _light(strengths[k], turn @ directions[k], distance, np.asarray(origin, dtype=np.float64), points)
        for k, distance in zip(kept, distances, strict=True)
    ]
    by_lights = (strengths * np.maximum(heights, 0)[:, None])[list(kept)].sum(axis=0)  # from above, all
    above, below = np.maximum(whole - [by_lights, np.zeros(3)], 0)
    share = sum(kept.values())
    faint = f"the lights bring {100 * share:.2g} % of the floor's light: their shadows are faint"
    return DeviceLights(
        tuple(lights), tuple(kept.values()), tuple(above), tuple(below), (faint,) * (share < FAINT)
    )


def _worth_it(shares):
    """{number: share} of the lights that throw a shadow worth seeing, the strongest first; one at least."""
    order = [int(k) for k in np.argsort(-shares, kind="stable") if shares[k] > 0]
    if not order:
        raise ValueError(
            "no light stands out above the panorama's horizon: none would throw a shadow on a floor"
        )
    return {k: float(shares[k]) for k in order if shares[k] >= LEAST_SHARE or k == order[0]}


def _vectors(image, partition):
    """Vector irradiance (n, colour, xyz) of the regions: ∫ radiance · ω dω."""
    height, width = partition.shape
    rows, columns = np.nonzero(partition >= 0)
    light = image[rows, columns] * equirectangular.row_solid_angles(width, height)[rows, None]
    ways = equirectangular.pixel_directions(width, height)[rows, columns]
    regions, count = partition[rows, columns], partition.max() + 1
    return np.array(
        [[np.bincount(regions, light[:, c] * ways[:, x], count) for x in range(3)] for c in range(3)]
    ).transpose(2, 0, 1)


def _light(strength, direction, distance, origin, points):
    if not np.isfinite(distance):
        return SceneLight(LightCamera.of_sun(direction, points), tuple(strength))
    camera = LightCamera.of_lamp(origin + distance * direction, points)
    return SceneLight(camera, tuple(strength * distance**2))
