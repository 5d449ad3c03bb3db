"""The closed room captured, and rendered with objects truly in it: what a composite must match."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bmesh
import bpy
import numpy as np
import OpenEXR
from mathutils import Matrix, Vector

from ..cycles_integration import capture, place, preparation, rendering, roles
from ..cycles_integration.pieces import update_pieces
from ..ibl_toolkit.calibration import calibrate
from ..ibl_toolkit.images import read_panorama, write_exr
from ..ibl_toolkit.reconstruction import reconstruct
from . import closed_room
from .closed_room_set import closed_room_set

CAMERA_POSITION, LOOKED_AT, LENS_MM = (-0.7, 0.9, 1.35), (1.15, -0.5, 0.25), 28
"""The frame is taken 1.15 m beside the panorama's centre."""


@dataclass(frozen=True)
class Truth:
    """The real room, seen by the displaced camera, with the objects truly in it and without: (H, W, 3)."""

    with_objects: np.ndarray
    without: np.ndarray


def capture_panorama(lamps: str, path: Path, width: int, samples: int):
    """Render the room's panorama (width × width/2) to an EXR, as a photographer would capture it.

    Denoised, since a photograph has less noise than so few samples.
    """
    scene = _real_scene(lamps)
    camera = capture.new_panorama_camera(Matrix.Translation((0, 0, closed_room.CAMERA_HEIGHT)))
    scene.collection.objects.link(camera)
    scene.camera = camera
    _settings(scene, width, width // 2, samples)
    scene.cycles.use_denoising = True
    image = np.maximum(capture.render_passes(scene)["Combined"][..., :3], 0)
    write_exr(path, dict(zip("RGB", np.moveaxis(image, 2, 0), strict=True)))
    bpy.data.scenes.remove(scene)


def render_truth(lamps: str, width: int, height: int, samples: int, renders: int = 8) -> Truth:
    """Render the real room from the displaced camera with the objects in it and without.

    Each is the median, per pixel, of several renders that share the samples: a path from the floor over the
    mirror ball into a small lamp is so rare that a plain mean keeps its white dots for hours.
    """
    scene = _real_scene(lamps)
    objects = add_objects(scene)
    scene.camera = add_camera(scene)
    _settings(scene, width, height, max(samples // renders, 1))
    with_objects = _median_render(scene, renders)
    for thing in objects:
        thing.hide_render = True
    without = _median_render(scene, renders)
    bpy.data.scenes.remove(scene)
    return Truth(with_objects, without)


def _median_render(scene, renders):
    pictures = []
    for seed in range(renders):
        scene.cycles.seed = seed
        pictures.append(capture.render_passes(scene)["Combined"][..., :3])
    return np.median(pictures, axis=0)


def mixed_scene(
    image: Path, most_lights: int | None = None
) -> tuple[bpy.types.Scene, preparation.Preparation]:
    """Calibrate, rebuild and prepare the room from its panorama alone; put objects and camera in."""
    height, width, _ = read_panorama(image).shape
    scene = bpy.data.scenes.new("Mixed")
    panorama_set = closed_room_set(image)
    calibration = calibrate(panorama_set.calibration, (width, height))
    here = place.create_place(scene, str(image), calibration)
    update_pieces(here, reconstruct(panorama_set, calibration))
    add_objects(scene)
    scene.camera = add_camera(scene)
    return scene, preparation.prepare(scene, most_lights)


def render_mixed(scene: bpy.types.Scene, path: Path, picture: rendering.Picture) -> np.ndarray:
    """Render a composite (H, W, 3) through the displaced camera."""
    rendering.render_picture(scene, scene.camera, picture, path)
    return read_picture(path)


def read_picture(path: Path) -> np.ndarray:
    """Return an EXR's R, G, B as (H, W, 3)."""
    pixels = next(iter(OpenEXR.File(str(path)).channels().values())).pixels
    return pixels[..., :3].astype(np.float32)


def add_objects(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """A mirror ball, a matte ball and a matte box, standing on the rug."""
    return [
        _ball(
            scene,
            "mirror ball",
            (0.9, -0.5),
            0.22,
            _material("mirror", "ShaderNodeBsdfAnisotropic", (0.95,) * 3),
        ),
        _ball(
            scene, "matte ball", (1.45, -0.8), 0.2, _material("matte", "ShaderNodeBsdfDiffuse", (0.7,) * 3)
        ),
        _cube(
            scene, "box", (1.3, -0.2), 0.3, 0.5, _material("green", "ShaderNodeBsdfDiffuse", (0.2, 0.5, 0.25))
        ),
    ]


def hide_objects(scene: bpy.types.Scene):
    """Leave the new objects out of the renders to come."""
    for thing in list(scene.objects):
        if thing.type == "MESH" and thing.panorama_role == roles.SYNTHETIC:
            thing.hide_render = True


def add_camera(scene: bpy.types.Scene) -> bpy.types.Object:
    """A perspective camera beside the panorama's centre."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = LENS_MM
    camera.location = CAMERA_POSITION
    looking = Vector(LOOKED_AT) - Vector(CAMERA_POSITION)
    camera.rotation_euler = looking.to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    return camera


def _real_scene(lamps):
    scene = bpy.data.scenes.new("Truth")
    closed_room.build_room(scene, lamps)
    return scene


def _settings(scene, width, height, samples):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = (
        width,
        height,
        100,
    )
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.sample_clamp_indirect = 0


def _ball(scene, name, centre, radius, material):
    mesh = bpy.data.meshes.new(name)
    ball = bmesh.new()
    bmesh.ops.create_uvsphere(ball, u_segments=64, v_segments=32, radius=radius)
    ball.to_mesh(mesh)
    ball.free()
    mesh.shade_smooth()
    return _stand(scene, name, mesh, material, (*centre, radius))


def _cube(scene, name, centre, size, turn, material):
    mesh = bpy.data.meshes.new(name)
    cube = bmesh.new()
    bmesh.ops.create_cube(cube, size=size)
    cube.to_mesh(mesh)
    cube.free()
    thing = _stand(scene, name, mesh, material, (*centre, size / 2))
    thing.rotation_euler = (0, 0, turn)
    return thing


def _stand(scene, name, mesh, material, location):
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    thing.location = location
    scene.collection.objects.link(thing)
    return thing


def _material(name, kind, colour):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    shader, output = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Color"].default_value = (*colour, 1)
    if kind == "ShaderNodeBsdfAnisotropic":
        shader.inputs["Roughness"].default_value = 0
    links.new(shader.outputs[0], output.inputs["Surface"])
    return material
