"""A box room of real surfaces with lamps on its ceiling in the photograph, level or tilted."""

from types import SimpleNamespace

import numpy as np
import panoramas
from mathutils import Vector

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector

WIDTH, HEIGHT = 512, 256
LOW, HIGH = np.array([-2.0, -2.0, -1.5]), np.array([2.0, 2.0, 1.2])
"""Corners of the box room, from the panorama's origin [m]."""
EYE = 1.5
TURNS = {"level": np.eye(3), "tilted": rotation_from_vector([0.3, -0.2, 1.1])}
WALL_RADIANCE = 0.2
LAMP, LAMP_SIZE, LAMP_RADIANCE = (1.0, -0.3), 0.4, (60, 50, 40)
"""On the ceiling: its middle [m], its side [m], what it shows."""


def box_points():
    """Points (H, W, 3) [m] where each pixel's ray meets the box room, in the panorama frame, and normals."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    distances = np.where(directions > 0, HIGH, LOW) / directions
    axis = distances.argmin(axis=2)
    normals = -np.sign(directions) * (np.arange(3) == axis[..., None])
    return directions * distances.min(axis=2)[..., None], normals


def on_ceiling(points, centre=LAMP, size=LAMP_SIZE):
    """Pixels of a square on the ceiling."""
    near = (np.abs(points[..., :2] - centre) < size / 2).all(axis=2)
    return near & (points[..., 2] > HIGH[2] - 1e-6)


def lamp_map(*lamps, slope=0.0):
    """Dark walls; a lamp for each (centre, size, radiance), or the usual one; ``slope`` makes it uneven."""
    points, _ = box_points()
    image = np.full((HEIGHT, WIDTH, 3), WALL_RADIANCE)
    for centre, size, radiance in lamps or ((LAMP, LAMP_SIZE, LAMP_RADIANCE),):
        pixels = on_ceiling(points, centre, size)
        across = 1 + slope * (points[pixels][:, :1] - centre[0]) / size
        image[pixels] = radiance * across
    return image.astype(np.float32)


def box_room(bpy, folder, image, turn=TURNS["level"], without=None):
    """A place whose surfaces are the sides of the box room, without that at one height [m]."""
    from expanded_panoramas.cycles_integration import place

    path = panoramas.write_panorama(folder / "room.exr", image)
    scene = bpy.context.scene
    calibration = SimpleNamespace(world_from_panorama=turn, camera_height=EYE)
    here = place.create_place(scene, str(path), calibration)
    bpy.context.view_layer.update()
    for axis, bound in [(axis, bound) for axis in range(3) for bound in (LOW, HIGH)]:
        if bound[axis] != without:
            others = [k for k in range(3) if k != axis]
            corners = np.tile(bound, (4, 1))
            corners[:, others[0]] = np.array([LOW, HIGH, HIGH, LOW])[:, others[0]]
            corners[:, others[1]] = np.array([LOW, LOW, HIGH, HIGH])[:, others[1]]
            add_surface(bpy, scene, here, corners)
    return scene, here


def add_surface(bpy, scene, here, corners, role="ENVIRONMENT"):
    """A real surface of one polygon, by its corners in the panorama frame."""
    world = [tuple(here.origin.matrix_world @ Vector(corner)) for corner in corners]
    mesh = bpy.data.meshes.new("side")
    mesh.from_pydata(world, [], [tuple(range(len(world)))])
    side = bpy.data.objects.new("side", mesh)
    side.panorama_role = role
    scene.collection.objects.link(side)
    return side


def prepare(scene, most=None):
    """Prepare it, with hardly any irradiance of supports: that is another test's."""
    from expanded_panoramas.cycles_integration import preparation

    kept = preparation.IRRADIANCE_WIDTH, preparation.IRRADIANCE_SAMPLES
    preparation.IRRADIANCE_WIDTH, preparation.IRRADIANCE_SAMPLES = 32, 4
    try:
        return preparation.prepare(scene, most)
    finally:
        preparation.IRRADIANCE_WIDTH, preparation.IRRADIANCE_SAMPLES = kept
