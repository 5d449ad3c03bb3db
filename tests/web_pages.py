"""Pages with shadows for tests: a scene, Chromium's picture of it, and what numpy says it must be."""

import os
import shutil
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import shadow_scenes

from expanded_panoramas.ibl_toolkit.images.png import linear_from_srgb, srgb_from_linear
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole
from expanded_panoramas.ibl_toolkit.mobile.page_picture import page_picture
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import LightCamera
from expanded_panoramas.ibl_toolkit.mobile.shadow_scene import SceneLight, SceneMesh, ShadowScene
from expanded_panoramas.ibl_toolkit.mobile.web_page import Background, write_page

CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    *("--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--hide-scrollbars", "--force-device-scale-factor=1", "--force-color-profile=srgb"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"),
    *("--no-first-run", "--virtual-time-budget=600000"),
]
SIZE = 480, 320
_TURN = 0.6
"""Between neighbouring normals: more is an edge."""
SUN, LAMP = (0.5, -0.6, 0.9), (-1.4, -1.1, 2.6)


def photographed(pages, folder, size=SIZE):
    """What Chromium shows of each page, all on one sheet: (N, H, W, 3) from 0 to 255."""
    folder = Path(folder)
    width, height = size
    frames = "".join(
        f'<iframe src="{Path(page).resolve().as_uri()}" width="{width}" height="{height}" '
        'style="display: block; border: 0"></iframe>'
        for page in pages
    )
    sheet, picture = folder / "sheet.html", folder / "sheet.png"
    sheet.write_text(f'<!doctype html><body style="margin: 0">{frames}', encoding="utf-8")
    chromium(
        folder, f"--window-size={width},{height * len(pages)}", f"--screenshot={picture}", sheet.as_uri()
    )
    shown = cv2.cvtColor(cv2.imread(str(picture)), cv2.COLOR_BGR2RGB)
    return shown.reshape(len(pages), height, width, 3)


def chromium(folder, *arguments):
    """Run Chromium, with a profile in a folder -> what it prints."""
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={Path(folder) / 'profile'}", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=300).stdout


def still_life(lights=("sun",), roles=("support", "synthetic", "synthetic"), ambient=0.3):
    """A box and a ball on a floor."""
    solids = (
        shadow_scenes.Box((-0.6, -0.3, 0), (-0.1, 0.2, 0.9)),
        shadow_scenes.Ball((0.7, 0.2, 0.6), 0.3, 48),
    )
    floor = shadow_scenes.Scene((), 2.0).mesh()
    box, ball = (solid.mesh() for solid in solids)
    points = np.concatenate([mesh[0] for mesh in (floor, box, ball)])
    cameras = {
        "sun": SceneLight(LightCamera.of_sun(SUN, points), (2.0, 1.8, 1.5)),
        "lamp": SceneLight(LightCamera.of_lamp(LAMP, points), (6.0, 7.0, 9.0)),
    }
    normals = (ball[0] - solids[1].centre) / 0.3
    meshes = (
        SceneMesh("floor", *floor, roles[0]),
        SceneMesh("box", *outward(*box), roles[1], (0.7, 0.3, 0.2)),
        SceneMesh("ball", *ball, roles[2], (0.2, 0.4, 0.7), normals),
    )
    below = (0.2 * ambient, 0.5 * ambient, ambient)
    return ShadowScene(meshes, [cameras[name] for name in lights], (ambient,) * 3, below)


def outward(points, triangles):
    """Triangles of a convex solid turned so that they are counter-clockwise from outside."""
    corners = points[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = ((corners.mean(axis=1) - points.mean(axis=0)) * across).sum(axis=1) < 0
    return points, np.where(inward[:, None], triangles[:, ::-1], triangles)


@dataclass(frozen=True)
class Shown:
    """Chromium's picture (H, W, 3), and by how much it differs from numpy's, the worst channel (H, W).

    outlines: (H, W) bool, see `expected`.
    """

    picture: np.ndarray
    off: np.ndarray
    outlines: np.ndarray


def measured(cases, folder):
    """A Shown of each case (scene, settings, background), whose pages are written to a folder."""
    view, pages = camera(), [Path(folder) / f"{number}.html" for number in range(len(cases))]
    for page, (scene, settings, background) in zip(pages, cases, strict=True):
        write_page(page, scene, [settings], background, view)
    for picture, case in zip(photographed(pages, folder), cases, strict=True):
        right, outlines = expected(*case, view, case[2].jpeg("a page"))
        yield Shown(picture, np.abs(picture - right).max(axis=2), outlines)


def camera():
    return Pinhole.looking_at((0.3, -3.0, 1.9), (0.1, 0.0, 0.3), 55, *SIZE)


def white():
    """A panorama that shows what is multiplied with it."""
    return Background(np.ones((8, 16, 3), np.float32))


def sky():
    """A smooth panorama with a seam that shows, turned, and captured above the floor."""
    u, v = np.meshgrid((np.arange(64) + 0.5) / 64, (np.arange(32) + 0.5) / 32)
    colours = [0.2 + 0.6 * u, 0.3 + 0.4 * np.sin(3 * v) ** 2, 0.8 - 0.5 * v]
    turn = cv2.Rodrigues(np.array([0.05, 0.1, 2.0]))[0]
    image = np.stack(colours, axis=-1).astype(np.float32)
    return Background(image, "panorama", 0.8, np.array([0.3, -3.0, 1.6]), turn)


def photo(view):
    """A photo as a camera has it."""
    x, y = np.meshgrid(np.linspace(0, 1, view.width), np.linspace(0, 1, view.height))
    return Background(
        np.stack([0.3 + 0.5 * x, 0.8 - 0.4 * y, 0.5 + 0.3 * x * y], -1).astype(np.float32), "photo"
    )


def expected(scene, settings, background, view, jpeg=b""):
    """The picture (H, W, 3) from 0 to 255, and (H, W) bool, whether an outline of a mesh is within a pixel.

    jpeg: the background as the page has it, else it is taken as it is.
    """
    if jpeg:
        codes = cv2.cvtColor(cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
        background = replace(background, image=linear_from_srgb(codes / 255) / background.exposure)
    made = page_picture(scene, settings, background, view)
    labels = np.concatenate([10.0 * (made.mesh[..., None] + 1), made.normals], axis=-1)
    return 255 * srgb_from_linear(made.radiance * background.exposure), _outlines(labels)


def _outlines(labels):
    """(H, W) bool: where meshes or normals (H, W, 4) differ within a pixel."""
    square = np.ones((3, 3), np.uint8)
    spread = cv2.dilate(labels, square) - cv2.erode(labels, square)
    return (spread > _TURN).any(axis=2)
