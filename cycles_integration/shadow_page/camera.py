"""Where the page looks from, and what is behind the meshes."""

from __future__ import annotations

import bpy
import cv2
import numpy as np

from ...ibl_toolkit.images.png import linear_from_srgb
from ...ibl_toolkit.layers.views.pinhole import Pinhole
from ...ibl_toolkit.mobile.web_page import Background
from .. import blender_images
from ..place import place_in

GREY = 0.18
FROM_ORIGIN_DEG = 80.0
"""Angle of the picture's width where there is no camera."""
_SQUARE = 0.005  # difference in proportions of a photo that nobody sees


def camera_of(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, points: np.ndarray, name: str | None = None
) -> Pinhole:
    """The scene's camera, or that of a name; in a place without one, its origin, looking at points (n, 3).

    Raises ValueError where there is none, or what is no plain perspective camera.
    """
    render = scene.render
    width, height = (
        max(round(side * render.resolution_percentage / 100), 1)
        for side in (render.resolution_x, render.resolution_y)
    )
    thing = _camera(scene, name)
    if thing is None:
        eye = np.array(place_in(scene).origin.matrix_world.translation)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        if np.linalg.norm((middle - eye)[:2]) < 0.1 * abs(middle[2] - eye[2]):
            middle = eye + np.array([1.0, 0.0, 0.0])  # what is straight below has no upright picture
        return Pinhole.looking_at(eye, middle, FROM_ORIGIN_DEG, width, height)
    if thing.type != "CAMERA" or thing.data.type != "PERSP":
        raise ValueError(f"'{thing.name}' must be a perspective camera: the page looks through no other")
    evaluated = thing.evaluated_get(depsgraph)
    clip = np.array(
        evaluated.calc_matrix_camera(
            depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y
        )
    )
    if np.abs(clip[:2, 2]).max() > 1e-6:
        raise ValueError(
            f"camera '{thing.name}' has a lens shift, which the page does not draw: set Shift X and Y to 0"
        )
    matrix = np.array(evaluated.matrix_world.normalized())
    axes = matrix[:3, :3].T * [[1], [-1], [-1]]
    fov_deg = float(np.degrees(2 * np.arctan(1 / clip[0, 0])))
    return Pinhole(matrix[:3, 3], axes, fov_deg, width, max(round(width * clip[0, 0] / clip[1, 1]), 1))


def _camera(scene, name):
    cameras = {thing.name: thing for thing in scene.objects if thing.type == "CAMERA"}
    if name is not None and name not in cameras:
        raise ValueError(f"no camera {name!r}; cameras: {', '.join(cameras) or 'none'}")
    found = cameras[name] if name is not None else scene.camera
    if found is None and place_in(scene) is None:
        raise ValueError(f"scene '{scene.name}' has no camera: add one, the page looks from there")
    return found


def background_of(
    scene: bpy.types.Scene, camera: Pinhole, name: str | None, exposure: float | None
) -> tuple[Background, Pinhole, list[str]]:
    """The scene's panorama, else its camera's background image, else the world's colour; the camera, of the
    photo's size where there is one; warnings.

    exposure: from radiance to the screen; by default as bright as the 3D View shows it.
    """
    place = place_in(scene)
    gain = 2.0**scene.view_settings.exposure
    if place is not None and place.image is not None:
        image = np.maximum(blender_images.array_from_image(place.image), 0)
        matrix = np.array(place.origin.matrix_world.normalized())
        shown = exposure or gain * 2.0**scene.panorama_view.exposure
        return Background(image, "panorama", shown, matrix[:3, 3], matrix[:3, :3]), camera, []
    thing = _camera(scene, name)
    photo = None if thing is None else _photo(thing.data)
    if photo is not None:
        image, camera, warnings = _fitted(photo, camera)
        shown = exposure or gain
        return Background(image / shown, "photo", shown), camera, warnings  # it is shown as it is
    colour, warnings = world_colour(scene)
    colour = np.full(3, GREY / (exposure or gain)) if colour is None else colour
    return (
        Background(np.tile(colour.astype(np.float32), (2, 4, 1)), "panorama", exposure or gain),
        camera,
        warnings,
    )


def world_colour(scene: bpy.types.Scene) -> tuple[np.ndarray | None, list[str]]:
    """Radiance (3,) of a World of one colour; None with a warning where it is another, or there is none."""
    world = scene.world
    if world is None:
        return None, ["there is no World, so no light from all around: shadows are black"]
    if world.node_tree is None or (bpy.app.version < (5,) and not world.use_nodes):
        return np.array(world.color), []
    output = world.node_tree.get_output_node("ALL") or world.node_tree.get_output_node("CYCLES")
    links = output.inputs["Surface"].links if output else ()
    node = links[0].from_node if links else None
    if node is None or node.type != "BACKGROUND" or any(socket.is_linked for socket in node.inputs):
        return None, ["the World is not of one colour: no light from all around is taken from it"]
    return np.array(node.inputs["Color"].default_value[:3]) * node.inputs["Strength"].default_value, []


def _photo(data):
    """(H, W, 3) linear, of the first background image that is shown; None without one."""
    if not data.show_background_images:
        return None
    for shown in data.background_images:
        image = shown.image
        if shown.show_background_image and shown.source == "IMAGE" and image is not None and image.size[0]:
            values = np.maximum(blender_images.array_from_image(image), 0)
            is_linear = image.is_float or image.colorspace_settings.name != "sRGB"
            return np.broadcast_to(values if is_linear else linear_from_srgb(values), (*values.shape[:2], 3))
    return None


def _fitted(photo, camera):
    """The photo in the proportions of the camera's picture, as Blender's *Stretch* shows it."""
    height, width = photo.shape[:2]
    fitting = max(round(width * camera.height / camera.width), 1)
    warnings = []
    if abs(fitting / height - 1) > _SQUARE:
        warnings.append(
            f"the photo of {width} x {height} px is stretched to the picture's proportions, "
            f"{camera.width} : {camera.height}: set the resolution to the photo's"
        )
        photo = cv2.resize(photo.astype(np.float32), (width, fitting), interpolation=cv2.INTER_AREA)
    return photo, Pinhole(camera.eye, camera.axes, camera.fov_deg, *photo.shape[1::-1]), warnings
