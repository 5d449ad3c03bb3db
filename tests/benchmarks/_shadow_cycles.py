"""The part of a lamp's light that reaches the floor of a scene of solids, rendered by Cycles."""

import math

import bpy
import numpy as np
from mathutils import Quaternion, Vector
from small_scenes import DIFFUSE, add_camera, add_plane, material

from expanded_panoramas.cycles_integration import capture

ABOVE = 10.0
"""Height of the camera [m]; it sees the floor alone."""


class FloorLight:
    """Of shadow_scenes.Scene, over ``half`` m to each side of its middle, side × side places."""

    def __init__(self, solids, side, half, samples):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = scene = bpy.context.scene
        add_plane(scene, material(DIFFUSE), 4 * half)
        self.solids = [self._add(*solid.mesh()) for solid in solids]
        camera = add_camera(scene, (0, 0, ABOVE), (0, 0, 0), width=2 * half)
        camera.rotation_euler = 0, 0, 0  # +y up
        scene.render.engine = "CYCLES"
        scene.render.resolution_x = scene.render.resolution_y = side
        scene.cycles.samples, scene.cycles.max_bounces = samples, 0
        scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
        capture.sample_pixel_centres(scene)

    def of_sun(self, direction, diameter_deg):
        """Of a sun in a direction: visibility (2, side²) by other samples, row by row from the least y."""
        sun = bpy.data.lights.new("sun", "SUN")
        sun.angle = math.radians(diameter_deg)
        return self._lit(sun, Vector(direction).to_track_quat("Z", "Y"), (0, 0, 0))

    def of_lamp(self, position, radius):
        """Of a ball that shines, at a position, of a radius [m]: the same."""
        lamp = bpy.data.lights.new("lamp", "POINT")
        lamp.shadow_soft_size, lamp.use_soft_falloff = radius, False
        return self._lit(lamp, Quaternion(), position)

    def _lit(self, light, turn, position):
        thing = bpy.data.objects.new(light.name, light)
        thing.rotation_mode, thing.rotation_quaternion, thing.location = "QUATERNION", turn, position
        self.scene.collection.objects.link(thing)
        shadowed = [self._render(seed, hidden=False) for seed in (1, 2)]
        open_ = self._render(3, hidden=True)
        bpy.data.lights.remove(light)
        return np.array(shadowed) / open_

    def _render(self, seed, hidden):
        self.scene.cycles.seed = seed
        for solid in self.solids:
            solid.hide_render = hidden
        picture = capture.render_passes(self.scene)["Combined"][..., 0]
        return picture[::-1].astype(np.float64).ravel()

    def _add(self, points, triangles):
        mesh = bpy.data.meshes.new("solid")
        mesh.from_pydata(points.tolist(), [], triangles.tolist())
        thing = bpy.data.objects.new("solid", mesh)
        thing.visible_camera = False
        self.scene.collection.objects.link(thing)
        return thing
