"""One Blender scene as the preview's nodes show it in Cycles, and as the phone's page does in Chromium."""

from pathlib import Path

import bpy
import numpy as np
import small_scenes
import web_pages
from mathutils import Vector

from expanded_panoramas.cycles_integration import capture, roles, shadow_preview
from expanded_panoramas.cycles_integration.shadow_page import page_scene
from expanded_panoramas.ibl_toolkit.images.png import srgb_from_linear
from expanded_panoramas.ibl_toolkit.mobile.web_page import write_page

SUN, LAMP = (0.5, -0.6, 0.9), (-1.4, -1.1, 2.6)
"""Direction to the sun, and where the lamp is [m]."""
STRENGTHS = {"sun": 2.0, "lamp": 80.0}
"""Irradiance [W/m²], power [W]."""


class StillLife:
    """A white floor that is real and shows itself, a box and a smooth ball that are new and lit."""

    def __init__(self, size=web_pages.SIZE):
        scene = bpy.context.scene
        glow = _material("ShaderNodeEmission", (1, 1, 1, 1))
        floor = small_scenes.add_plane(scene, glow, 12.0)
        floor.panorama_role = roles.SUPPORT
        glow.cycles.emission_sampling, floor.visible_diffuse = "NONE", False  # it lights nothing
        red, blue = (_material(small_scenes.DIFFUSE, c) for c in ((0.7, 0.3, 0.2, 1), (0.2, 0.4, 0.7, 1)))
        bpy.ops.mesh.primitive_cube_add(size=0.6, location=(-0.4, 0.1, 0.3), rotation=(0, 0, 0.5))
        bpy.context.object.data.materials.append(red)
        bpy.context.object.panorama_role = roles.SYNTHETIC
        small_scenes.add_ball(scene, blue, 0.3, (0.7, 0.2, 0.6)).panorama_role = roles.SYNTHETIC
        small_scenes.add_camera(scene, (0.3, -2.2, 2.4), (0.1, 0.1, 0.2), field_of_view=0.9)
        scene.render.engine = "CYCLES"
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.cycles.samples, scene.cycles.max_bounces = 1, 0
        scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
        capture.sample_pixel_centres(scene)
        self.size, self.materials, self.group = size, (glow, red, blue), None
        self.lights = {"sun": _light("sun", "SUN"), "lamp": _light("lamp", "POINT")}

    def differences(self, cases, folder):
        """A web_pages.Shown of each case (names of lights, settings): Chromium's picture, and by how much it
        differs from that of Cycles."""
        pages, known = [], []
        for number, (names, settings) in enumerate(cases):
            self._switch_on(names, own_shadows=True)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            found = page_scene(bpy.context.scene, depsgraph, [settings])
            pages.append(Path(folder) / f"{number}.html")
            write_page(pages[-1], found.scene, [settings], web_pages.white(), found.camera)
            _, outlines = web_pages.expected(found.scene, settings, web_pages.white(), found.camera)
            self._preview([self.lights[name] for name in names], settings, depsgraph)
            known.append((255 * srgb_from_linear(self._rendered(names)), outlines))
        shown = web_pages.photographed(pages, folder, self.size)
        for picture, (right, outlines) in zip(shown, known, strict=True):
            yield web_pages.Shown(picture, np.abs(picture - right).max(axis=2), outlines)

    def _preview(self, lights, settings, depsgraph):
        maps = shadow_preview.shadow_maps_of(lights, depsgraph, settings)
        shown = [
            shadow_preview.ShownLight(
                made,
                shadow_preview.store_map(made, None, "map"),
                shadow_preview.strength_of(light, depsgraph),
            )
            for made, light in zip(maps, lights, strict=True)
        ]
        self.group = shadow_preview.build_group(shown, self.group, "preview")
        for material in self.materials:
            shadow_preview.put_on(material, self.group, 1.0)

    def _rendered(self, names):
        """(H, W, 3). Light adds up: one sample has one light, so each is rendered alone, without noise."""
        one_by_one = [self._rendered_with([name]) for name in names]
        return sum(one_by_one) - (len(names) - 1) * self._rendered_with([])

    def _rendered_with(self, names):
        self._switch_on(names, own_shadows=False)  # the maps stand for them
        return capture.render_passes(bpy.context.scene)["Combined"][..., :3]

    def _switch_on(self, names, own_shadows):
        for name, light in self.lights.items():
            light.hide_render, light.data.use_shadow = name not in names, own_shadows


def _material(kind, colour):
    return small_scenes.material(kind, Color=colour)


def _light(name, kind):
    data = bpy.data.lights.new(name, kind)
    data.energy = STRENGTHS[name]
    if kind == "SUN":
        data.angle = 0.0
    else:
        data.shadow_soft_size = 0.0
    made = bpy.data.objects.new(name, data)
    made.location = LAMP
    made.rotation_euler = Vector(SUN).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)
    return made
