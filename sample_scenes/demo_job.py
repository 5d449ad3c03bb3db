"""The steps of the demo, in the order of the work, and the report that grows with them."""

from __future__ import annotations

import json
import math
import shutil
from dataclasses import dataclass
from pathlib import Path

import bpy
import cv2
import numpy as np
import OpenEXR

from ..cycles_integration import capture, maps, materials, place, preparation, rendering
from ..cycles_integration.pieces import update_pieces
from ..cycles_integration.shipped import shipped_panorama
from ..ibl_toolkit import metrics
from ..ibl_toolkit.calibration import calibrate
from ..ibl_toolkit.images import RGBD, exposure_for, read_panorama, write_exr, write_png, write_rgbd
from ..ibl_toolkit.panorama_set import read_set
from ..ibl_toolkit.reconstruction import reconstruct
from . import demo_page, demo_pictures, hotel_objects

SET = Path(__file__).with_name("hotel_room.json")
PIXELS_AROUND = 3
"""So far [px] the antialiased edge of a new object may reach."""


@dataclass(frozen=True)
class Effort:
    """How much a run spends. A wider photograph is shrunk to `image_width`, the panorama's too."""

    image_width: int
    frame: tuple[int, int]
    frame_samples: int
    panorama_samples: int
    denoise: bool


FULL = Effort(image_width=1024, frame=(960, 540), frame_samples=48, panorama_samples=32, denoise=True)
QUICK = Effort(image_width=128, frame=(96, 54), frame_samples=2, panorama_samples=2, denoise=False)


def run_job(scene: bpy.types.Scene, folder: Path, effort: Effort, progress) -> dict:
    """Do the whole job in an empty scene, with every result in ``folder``; returns the report.

    ``progress``: a `cli.progress.Progress`, which times the steps.
    """
    step = progress.step
    with step("input"):
        panorama_set, photograph, picked_size = copy_input(folder, effort.image_width)
    with step("calibrate"):
        calibration = calibrate(panorama_set.calibration, picked_size)
    with step("reconstruct"):
        pieces = reconstruct(panorama_set, calibration, picked_size[0])
    with step("build"):
        made = place.create_place(scene, str(panorama_set.image), calibration)
        update_pieces(made, pieces)
    with step("objects"):
        objects = hotel_objects.add_objects(scene, pieces)
        camera = hotel_objects.add_camera(scene)
    with step("depth"):
        depth = maps.render_depth(scene, made, photograph.shape[1])
        rgbd = RGBD(photograph, depth.depth, calibration.world_from_panorama, calibration.camera_height)
        write_rgbd(folder / "depth.exr", rgbd)
    with step("prepare"):
        prepared = preparation.prepare(scene)
    with step("frame"):
        frame = rendering.Picture(*effort.frame, effort.frame_samples, denoise=effort.denoise)
        rendering.render_picture(scene, camera, frame, folder / "frame.exr")
    with step("panorama"), rendering.panorama_camera(scene) as panoramic:
        size = photograph.shape[1::-1]
        panorama = rendering.Picture(*size, effort.panorama_samples, denoise=effort.denoise)
        rendering.render_picture(scene, panoramic, panorama, folder / "panorama.exr")
    pictures = {name: read_picture(folder / f"{name}.exr") for name in ("frame", "panorama")}
    with step("page"):
        render_without(scene, objects, camera, frame, folder / "frame_before.exr")
        befores = {"frame": read_picture(folder / "frame_before.exr"), "panorama": photograph}
        exposure = exposure_for(photograph)
        for name, image in pictures.items():
            write_png(folder / f"{name}.png", image, exposure=exposure)
            write_png(folder / f"{name}_before.png", befores[name], exposure=exposure)
        demo_pictures.write_reconstruction(
            folder / "reconstruction.png", photograph, pieces, calibration, depth.depth
        )
        demo_pictures.write_depth(folder / "depth.png", depth.depth)
        demo_pictures.write_lamps(folder / "lamps.png", photograph, depth)
        covered = covered_by_objects(made, objects, depth.depth)
    report = {
        "blender": bpy.app.version_string,
        "seconds": {**progress.seconds, "total": sum(progress.seconds.values())},
        "prepare_seconds": prepared.seconds,
        "pictures": {
            "frame": {"size": list(effort.frame), "samples": effort.frame_samples},
            "panorama": {"size": list(size), "samples": effort.panorama_samples},
            "method": frame.method,
            "denoised": effort.denoise,
        },
        "calibration": calibration.to_json(),
        "shapes": [piece.to_json() for piece in pieces],
        "depth": depth_figures(depth),
        "lights": {"count": prepared.at_depth.count, "share": prepared.at_depth.share},
        "errors": {
            "untouched": difference(pictures["panorama"], photograph, ~depth.is_support & ~covered),
            "white_dots": {name: new_dots(image, befores[name]) for name, image in pictures.items()},
        },
    }
    (folder / "report.json").write_text(
        json.dumps(report, indent=2, allow_nan=False) + "\n", encoding="utf-8"
    )
    (folder / "index.html").write_text(demo_page.page(report), encoding="utf-8")
    return report


def captured_room() -> Path:
    """The photograph that every Blender brings along."""
    return shipped_panorama("interior.exr")


def copy_input(folder, image_width):
    """Copy the set and its image into a folder -> the set, the image, and the size [px] that picks refer to.

    A shrunk image does not make the picks less exact: they were made on the full one.
    """
    shutil.copy(SET, folder)
    panorama_set = read_set(folder / SET.name)
    image = read_panorama(captured_room())
    picked_size = image.shape[1::-1]
    if picked_size[0] <= image_width:
        shutil.copyfile(captured_room(), panorama_set.image)
    else:
        image = maps.shrink(image, image_width)
        write_exr(panorama_set.image, {name: image[..., k] for k, name in enumerate("RGB")})
    return panorama_set, image, picked_size


def render_without(scene, objects, camera, picture, path):
    """The same picture without the new objects: then the composite is exactly the photograph, projected."""
    for thing in objects:
        thing.hide_render = True
    plain = rendering.Picture(picture.width, picture.height, samples=1, method=picture.method)
    rendering.render_picture(scene, camera, plain, path)
    for thing in objects:
        thing.hide_render = False


def covered_by_objects(made, objects, depth) -> np.ndarray:
    """Where (H, W) new objects, or pixels at their edges, are in the panorama picture."""
    with capture.temporary_scene(made, depth.shape[1], samples=1, with_lamps=False) as taken:
        capture.sample_pixel_centres(taken)
        taken.world = None
        for thing in objects:
            taken.collection.objects.link(thing)
        taken.view_layers[0].use_pass_z = True
        taken.view_layers[0].material_override = materials.black_material(made)
        nearer = capture.render_passes(taken)["Depth"] < depth * 0.9999
    around = np.ones((2 * PIXELS_AROUND + 1,) * 2, np.uint8)
    return cv2.dilate(nearer.astype(np.uint8), around).astype(bool)


def depth_figures(depth) -> dict:
    """Coverage, nearest and farthest [m] of a depth map."""
    known = depth.depth[np.isfinite(depth.depth)]
    return {"coverage": depth.coverage, "nearest": float(known.min()), "farthest": float(known.max())}


def difference(image, photograph, mask) -> dict:
    """How far pixels in a mask (H, W) are from the photograph's; `psnr_db` is null where equal."""
    ratio = metrics.psnr(image, photograph, mask)
    return {
        "share_of_pixels": float(mask.mean()),
        "psnr_db": None if math.isinf(ratio) else ratio,
        "largest_difference": float(np.abs(image - photograph)[mask].max()),
    }


def new_dots(image, before) -> int:
    """White dots of a picture that are not in the one without objects."""
    return int(np.count_nonzero(metrics.new_white_dots(image, before)))


def read_picture(path) -> np.ndarray:
    """A rendered EXR of any proportions as (H, W, 3) float32."""
    return OpenEXR.File(str(path)).channels()["RGB"].pixels
