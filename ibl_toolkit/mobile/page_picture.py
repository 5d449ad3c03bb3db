"""The picture that the phone's page draws, in numpy: the page's reference, and a picture without a browser.

The same rays through the pixels' middles, traced to the same triangles, and `remaining_light` at the places
they meet. There is no antialiasing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..equirectangular import sample
from ..layers.raster.rasterizer import rasterize
from ..layers.views.pinhole import Pinhole
from .shadow_maps import ShadowSettings, remaining_light, shadow_map
from .shadow_scene import ShadowScene
from .web_page import Background, refuse_other_size

_FLOATS = np.float32  # that points have in the file and on the device


@dataclass(frozen=True, eq=False)
class PagePicture:
    """radiance: (H, W, 3), to be multiplied with the background's exposure. mesh: (H, W) number of what is
    seen, −1 for the background. normals: (H, W, 3) there, 0 for the background."""

    radiance: np.ndarray
    mesh: np.ndarray
    normals: np.ndarray


def page_picture(
    scene: ShadowScene, settings: ShadowSettings, background: Background, camera: Pinhole
) -> PagePicture:
    """What the page shows with a kind of shadow map, before it is cut off at white.

    Raises ValueError for a photo of another size than the camera's picture.
    """
    refuse_other_size(background, camera, "picture")
    parts = [mesh.with_normals() for mesh in scene.meshes]
    corners = np.concatenate([points.astype(_FLOATS).astype(float)[which] for points, _, which in parts])
    normals = np.concatenate([normals[which] for _, normals, which in parts])
    mesh = np.repeat(np.arange(len(parts)), [len(which) for _, _, which in parts])
    rays = camera.directions().reshape(-1, 3)
    seen = rasterize(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), camera)
    seen = seen.triangle.ravel()
    hit = np.flatnonzero(seen >= 0)
    at, upright = _where(corners[seen[hit]], normals[seen[hit]], camera.eye, rays[hit])
    throws = np.array([one.throws for one in scene.meshes])[mesh]
    is_ground = np.array([one.is_ground for one in scene.meshes])[mesh]
    whole, kept = _light(scene, settings, corners[throws], corners[is_ground], at, upright)
    share = np.where(whole > 0, kept / np.maximum(whole, 1e-30), 1)
    shown = _looked_up(background, at - background.origin, hit) * share
    albedo = np.array([one.albedo for one in scene.meshes])[mesh[seen[hit]]]
    is_new = np.array([one.is_new for one in scene.meshes])[mesh[seen[hit]]]
    radiance = np.array(_looked_up(background, rays, np.arange(len(rays))), dtype=np.float32)
    radiance[hit] = np.where(is_new[:, None], albedo / np.pi * kept, shown)
    shape = camera.height, camera.width
    return PagePicture(
        radiance.reshape(*shape, 3),
        np.where(seen >= 0, mesh[seen], -1).reshape(shape),
        _spread(upright, hit, len(rays)).reshape(*shape, 3),
    )


def _where(corners, normals, eye, rays):
    """Places (n, 3) where rays meet triangles, and the normals between those of the corners."""
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    matrix = np.stack([one, two, -rays], axis=-1)
    share = np.linalg.solve(matrix, (eye - corners[:, 0])[..., None])[..., 0]
    weights = np.stack([1 - share[:, 0] - share[:, 1], share[:, 0], share[:, 1]], axis=1)
    upright = (normals * weights[..., None]).sum(axis=1)
    return eye + share[:, 2:] * rays, upright / np.linalg.norm(upright, axis=1, keepdims=True)


def _light(scene, settings, casters, ground, at, normals):
    """Irradiance (n, 3) without shadows, and with those of triangles (T, 3, 3) on themselves and others."""
    casters, ground = (
        (corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)) for corners in (casters, ground)
    )
    maps = [shadow_map(*casters, light.camera, settings, ground) for light in scene.lights]
    strengths = np.array([light.strength for light in scene.lights])
    whole = np.zeros((len(at), 3))
    for light, strength in zip(scene.lights, strengths, strict=True):
        to_light, distance = light.camera.to_light(at)
        cosine = np.maximum((to_light * normals).sum(axis=1), 0)
        whole += (cosine / distance**2)[:, None] * strength
    kept = whole * remaining_light(maps, strengths, at, normals)
    ambient = scene.ambient_on(normals)
    return whole + ambient, kept + ambient


def _looked_up(background, directions, pixels):
    """Radiance (n, 3) behind directions (n, 3) of the world, through pixels (n,)."""
    if background.kind == "photo":
        return np.asarray(background.image).reshape(-1, 3)[pixels]
    return sample(background.image, directions @ background.world_from_panorama)


def _spread(values, places, count):
    whole = np.zeros((count, 3))
    whole[places] = values
    return whole
