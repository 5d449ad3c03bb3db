"""A light's shadow map, and how much of the light reaches a point."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from . import evsm, hard, pcf, vsm
from .depth_buffer import depth_buffer
from .ground import filled
from .light_camera import LightCamera
from .lookup import in_blocks
from .settings import ShadowSettings
from .storage import STEPS

_OF = {"hard": hard, "pcf": pcf, "vsm": vsm, "evsm": evsm}
_EDGE_ON = 1e-3  # sine of the angle between light and plane below which nothing of the plane is seen


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """texels: (N, N, C) as the device holds them, row 0 at t = 0. warnings: what this map cannot show."""

    camera: LightCamera
    settings: ShadowSettings
    texels: np.ndarray
    warnings: tuple[str, ...] = ()


def shadow_map(
    points: np.ndarray,
    triangles: np.ndarray,
    camera: LightCamera,
    settings: ShadowSettings,
    ground: tuple[np.ndarray, np.ndarray] | None = None,
) -> ShadowMap:
    """The map of triangles (T, 3), indices of points (V, 3) [m], which all throw and receive shadows.

    ground: points and triangles of what receives shadows and throws none, see `filled`.

    Without triangles everything is lit; warnings say so, and tell what lies outside the light's view or range
    of depths, which throws no shadow, and triangles that all lie in the light's plane, which throw none.
    Raises ValueError for points that are not finite, and indices of none.
    """
    points, triangles = np.asarray(points, dtype=np.float64), np.asarray(triangles)
    _refuse(points, triangles)
    triangles, step = triangles.reshape(-1, 3), STEPS[settings.storage]
    offset = settings.offset_factor, settings.offset_units
    depth = depth_buffer(points, triangles, camera, settings.resolution, *offset, step)
    if ground is not None and settings.has_moments:
        _refuse(*ground)
        depth = filled(depth, *ground, camera, settings, step)
    texels = _OF[settings.method].texels(depth, camera, settings)
    return ShadowMap(camera, settings, texels, tuple(warnings_of(points, triangles, camera)))


def visibility(shadow_map: ShadowMap, points: np.ndarray, normals: np.ndarray | None = None) -> np.ndarray:
    """How much of the light reaches points (n, 3) [m]: (n,), 0 in shadow, 1 lit.

    normals: (n, 3); what is turned away from the light is dark, whatever the map says. Beside the map all is
    lit. Beyond far the depth counts as far.
    """
    points = np.asarray(points, dtype=np.float64)
    method = _OF[shadow_map.settings.method]
    texture = shadow_map.camera.texture(points)
    inside = ((texture[:, :2] >= 0) & (texture[:, :2] <= 1)).all(axis=1)
    texture[:, 2] = np.clip(texture[:, 2], 0, 1)
    lit = np.ones(len(points))
    lit[inside] = in_blocks(lambda part: method.visibility(shadow_map, part), texture[inside])
    if normals is not None:
        to_light, _ = shadow_map.camera.to_light(points)
        lit[(to_light * normals).sum(axis=1) <= 0] = 0.0
    return lit


def remaining_light(
    shadow_maps: Sequence[ShadowMap], strengths: np.ndarray, points: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    """What shadows leave of several lights together, (n, 3) from 0 to 1 per channel, at points (n, 3) [m].

    strengths: (L, 3), the irradiance of a sun [W/m²], the radiant intensity of a lamp [W/sr]. 1 where none of
    the lights would reach a surface of the normal (n, 3).
    Raises ValueError for strengths that are not one for each light, or are negative.
    """
    strengths = np.asarray(strengths, dtype=np.float64)
    if strengths.shape != (len(shadow_maps), 3) or not (strengths >= 0).all():
        raise ValueError(f"strengths {strengths.tolist()} must be ({len(shadow_maps)}, 3), none below 0")
    kept, whole = np.zeros((len(points), 3)), np.zeros((len(points), 3))
    for one, strength in zip(shadow_maps, strengths, strict=True):
        to_light, distance = one.camera.to_light(points)
        cosine = np.maximum((to_light * normals).sum(axis=1), 0.0)
        light = (cosine / np.maximum(distance, 1e-9) ** 2)[:, None] * strength
        kept += visibility(one, points, normals)[:, None] * light
        whole += light
    return np.where(whole > 0, kept / np.where(whole > 0, whole, 1.0), 1.0)


def _refuse(points, triangles):
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError(f"points of the scene {points.shape} must be (V, 3), all finite")
    if triangles.size and (triangles.shape[1:] != (3,) or triangles.dtype.kind not in "iu"):
        raise ValueError(f"triangles {triangles.shape} {triangles.dtype} must be (T, 3) whole numbers")
    if triangles.size and not (triangles.min() >= 0 and triangles.max() < len(points)):
        raise ValueError(
            f"triangles name points {triangles.min()} to {triangles.max()}, there are only {len(points)}"
        )


def warnings_of(points: np.ndarray, triangles: np.ndarray, camera: LightCamera) -> Iterator[str]:
    """What a map of triangles (T, 3), indices of points (V, 3) [m], cannot show, a sentence each."""
    if not len(triangles):
        yield "the scene is empty: everything is lit"
        return
    used = points[np.unique(triangles)]
    forward = (used - camera.eye) @ camera.axes[2]
    slack = 1e-9 * (camera.far - camera.near)
    for count, words in (
        ((forward < camera.near - slack).sum(), f"nearer to the light than {camera.near:.3g} m"),
        ((forward > camera.far + slack).sum(), f"farther from the light than {camera.far:.3g} m"),
    ):
        if count:
            yield f"{count} of {len(used)} points are {words}: there the scene throws no shadow"
    beside = (np.abs(camera.texture(used[forward > max(camera.near, 0)])[:, :2] - 0.5) > 0.5 + 1e-9).any(
        axis=1
    )
    if beside.any():
        yield f"{beside.sum()} of {len(used)} points are beside what the light sees: there everything is lit"
    if _all_edge_on(points[triangles], camera):
        yield "the light lies in the plane of every triangle: none throws a shadow"


def _all_edge_on(corners, camera):
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1)
    to_light, _ = camera.to_light(corners.mean(axis=1))
    return bool((np.abs((across * to_light).sum(axis=1)) <= _EDGE_ON * length).all())
