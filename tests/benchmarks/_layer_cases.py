"""What `layer_views` looks at: the sample room in layers of several kinds, and its true views; all cached."""

from __future__ import annotations

import math
import pathlib
from dataclasses import dataclass, replace

import cv2
import numpy as np

from expanded_panoramas.cycles_integration.layer_capture import LayerCapture, capture_surfaces, split_surfaces
from expanded_panoramas.cycles_integration.layer_scene import frame_of
from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.files.mip import halved
from expanded_panoramas.ibl_toolkit.layers.files.storage import read_layers, write_layers
from expanded_panoramas.ibl_toolkit.layers.making.from_rgbd import layers_from_rgbd
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.sample_scenes.layered_room import capture, scene, sizes, views

ROOT = pathlib.Path(__file__).resolve().parents[2]
TWO, ONE, MADE, SURFACES = "room and objects", "one layer", "made of one RGB-D", "successive surfaces"
KINDS = {
    TWO: "the room, and the objects in it, rendered by themselves",
    ONE: "what the origin sees, as one layer: meshes bridge its jumps",
    MADE: "layers_from_rgbd of that one layer: what was hidden is made up",
    SURFACES: "split_surfaces of capture_surfaces: what is seen from within the radius, rendered",
}
TABLE = (*views.TABLE_8_1, views.C1)
ASIDE = np.array([-1.0, 1.0, 0.0]) / math.sqrt(2)  # from the centre to C1
DISTANCES = (0.5, 1.5, 2.0)  # [m]; C1 is at 0.85
COMPARED = tuple(view for view in TABLE if view.name in ("S6", "S10", "S12", "C1"))
"""Views of all kinds of layers: before a sofa, down at the floor's lamps, to the poufs, and C1."""


@dataclass(frozen=True)
class Settings:
    """How much is measured.

    widths: of layers [px]. usual: the one that is captured, at which all views are looked at; narrower ones
    are its mip levels, of wider ones as much is captured as C1 needs. kinds_width: that at which kinds of
    layers are compared.
    """

    folder: pathlib.Path
    charts: pathlib.Path
    widths: tuple[int, ...] = (1024, 2048, 4096, 8192)
    usual: int = 4096
    kinds_width: int = 1024
    capture_samples: int = 4  # and denoised
    size: tuple[int, int] = (960, 540)
    truth_samples: int = 8  # and denoised, too
    table: tuple[views.View, ...] = TABLE
    compared: tuple[views.View, ...] = COMPARED
    distances: tuple[float, ...] = DISTANCES


FULL = Settings(ROOT / "out" / "bench" / "layers", ROOT / "docs" / "charts")
TOY = Settings(
    *[ROOT / "out" / "bench" / "layers_toy"] * 2,
    widths=(256, 512, 1024),
    usual=512,
    kinds_width=256,
    capture_samples=4,
    size=(192, 108),
    truth_samples=16,
    table=(views.TABLE_8_1[10], views.C1),
    compared=(views.C1,),
    distances=(0.5, 1.5),
)


def aside(distance: float) -> views.View:
    """A view like C1, an eye's distance [m] from the centre."""
    eye = np.add(sizes.ORIGIN, distance * ASIDE)
    return views.View(f"{distance} m", tuple(eye.tolist()), views.C1.direction)


def panorama(settings: Settings, kind: str, width: int) -> LayeredPanorama:
    """The room in layers of a kind, so many pixels wide."""
    if kind == SURFACES:
        return _captured(settings, kind, width, _successive)
    if width > settings.usual:
        return _captured(settings, kind, width, _finer)
    found = _captured(settings, TWO, settings.usual, _room_and_objects)
    found = replace(found, layers=tuple(_narrower(layer, width) for layer in found.layers))
    if kind == TWO:
        return found
    seen = _nearest(found)
    if kind == ONE:
        return replace(found, layers=(seen,))
    return layers_from_rgbd(seen.radiance, seen.depth, found.radius, origin=found.origin)


def truth(settings: Settings, view: views.View) -> tuple[np.ndarray, np.ndarray]:
    """A view's radiance (H, W, 3), and the distance of its surfaces (H, W) [m] along forward."""
    path = settings.folder / f"truth_{view.name.replace(' ', '')}.npz"
    if not path.exists():
        room = scene.new_room()
        radiance = capture.render_view(room, view, settings.size, settings.truth_samples)
        np.savez(path, radiance=radiance, distance=capture.render_view_distance(room, view, settings.size))
    with np.load(path) as kept:
        return kept["radiance"], kept["distance"]


def _captured(settings, kind, width, render):
    folder = settings.folder / f"{kind.replace(' ', '_')}_{width}"
    if not (folder / "panorama.xml").exists():
        write_layers(render(settings, width), folder)
    return read_layers(folder)


def _room_and_objects(settings, width):
    return capture.capture_layers(scene.new_room(), width, settings.capture_samples)


def _finer(settings, width):
    """All the depth, and the light of what C1 shows; elsewhere that of half the width, interpolated."""
    room = scene.new_room()
    whole = capture.capture_layers(room, width, None)
    left, top, right, bottom = window_of_c1(settings)
    render = room.render
    render.use_border = True
    render.border_min_x, render.border_max_x = left, right
    render.border_min_y, render.border_max_y = 1 - bottom, 1 - top  # Blender counts from the bottom
    part = capture.capture_layers(room, width, settings.capture_samples)
    within = np.s_[int(top * width / 2) : int(bottom * width / 2), int(left * width) : int(right * width)]
    narrow = panorama(settings, TWO, width // 2)
    layers = []
    for bare, lit, coarse in zip(whole.layers, part.layers, narrow.layers, strict=True):
        radiance, depth = _doubled(coarse), bare.depth.copy()
        radiance[within], depth[within] = lit.radiance[within], lit.depth[within]
        layers.append(replace(bare, attributes={"radiance": radiance, "depth": depth}))
    return replace(whole, layers=tuple(layers))


def window_of_c1(settings: Settings) -> tuple[float, float, float, float]:
    """Where maps show what C1 sees: left, top, right, bottom in parts of their sides; a 64th to spare."""
    camera, (_, distance) = views.pinhole(views.C1, *settings.size), truth(settings, views.C1)
    rays = camera.directions()
    points = camera.eye + rays * (distance / (rays @ camera.axes[2]))[..., None]
    uv = equirectangular.uv_from_direction(points - sizes.ORIGIN).reshape(-1, 2)
    least, most = np.floor(64 * uv.min(axis=0)) - 1, np.ceil(64 * uv.max(axis=0)) + 1
    return tuple(float(part) / 64 for part in (*least, *most))


def _successive(settings, width):
    samples = settings.capture_samples * (settings.usual // width) ** 2  # as many as mip levels average
    options = LayerCapture(width=width, samples=samples)
    room = scene.new_room()
    return split_surfaces(capture_surfaces(room, frame_of(room, sizes.ORIGIN), sizes.RADIUS, options))


def _narrower(layer, width):
    while layer.size[0] > width:
        layer = halved(layer)
    return layer


def _doubled(layer):
    """Radiance (2 H, 2 W, 3) of twice a layer's width: interpolated; none far outside of the domain."""
    inside = layer.mask.astype(np.float32)[..., None]
    values = np.concatenate([layer.radiance * inside, inside], axis=2).astype(np.float32)
    fine = cv2.resize(values, (2 * layer.size[0], 2 * layer.size[1]), interpolation=cv2.INTER_LINEAR)
    return fine[..., :3] / np.maximum(fine[..., 3:], 1e-6)


def _nearest(found):
    """What the origin sees of all layers, as one."""
    depths = np.stack([np.where(layer.mask, layer.depth, np.inf) for layer in found.layers])
    first = depths.argmin(axis=0)
    radiance = np.stack([layer.radiance for layer in found.layers])
    radiance = np.take_along_axis(radiance, first[None, ..., None], axis=0)[0]
    return Layer("seen", found.layers[0].mapping, {"radiance": radiance, "depth": depths.min(axis=0)})
