"""The hotel room with two things on its floor and one light: the sun of its strongest ceiling lamp.

The surfaces show the photograph, as on a device, and light nothing, but for the floor; the things are lit by
the sun and by what it leaves of the panorama.
"""

import math
import tempfile
from pathlib import Path

import bpy
import cv2
import numpy as np
from mathutils import Vector

from expanded_panoramas.cycles_integration import (
    blender_images,
    materials,
    place,
    preparation,
    rendering,
    world,
)
from expanded_panoramas.cycles_integration.pieces import update_pieces
from expanded_panoramas.cycles_integration.shadow_preview import settings_of
from expanded_panoramas.ibl_toolkit.calibration import calibrate
from expanded_panoramas.ibl_toolkit.images import exposure_for
from expanded_panoramas.ibl_toolkit.reconstruction import reconstruct
from expanded_panoramas.sample_scenes import hotel_objects
from expanded_panoramas.sample_scenes.demo_job import copy_input, read_picture
from expanded_panoramas.sample_scenes.light_scenes import diffuse

LAMPS = 6
"""As many are taken out of the panorama; the strongest shines, without the others the rest is quiet."""
LAMP_DEG = 3.5
"""Across the lamp, 10 cm wide, from where the panorama was captured, 1.65 m away."""
MONKEY, MONKEY_SIZE, MONKEY_DEG = (-0.32, -0.62), 0.26, (-38.0, 0.0, 92.0)
KNOT, KNOT_DEG = (-0.06, -0.28), (80.0, 0.0, 60.0)
"""Where they stand on the floor [m], how large it is, and how they are turned about x, y and z."""
EYE, TARGET, FOV_DEG = (0.78, -0.12, 1.10), (-0.20, -0.37, 0.06), 29.0
SOFT = 8, 4
"""Width and height of the panorama that lights matte things [px]."""
PLASTER, CLAY = (0.60, 0.56, 0.49), (0.10, 0.30, 0.36)
DARKNESS = 0.65
TRUTH_SAMPLES, FINER = 8, 2


class Room:
    """The scene, and pictures of it."""

    def __init__(self, side: int, samples: int):
        """Build it in the open file; pictures are so wide and high [px]."""
        self.scene, self.side, self.samples = bpy.context.scene, side, samples
        with tempfile.TemporaryDirectory() as folder:
            photograph = self._build(Path(folder))
        self.exposure = exposure_for(photograph)
        self.suns = list(self.place.suns.objects)
        self.sun = self.suns[0]
        self.sun.data.angle = math.radians(LAMP_DEG)
        self.shine([0])
        self.floor = bpy.data.objects["floor"]
        self.objects = self._add_monkey(), self._add_knot(self.pieces)
        self._add_camera()

    def _build(self, folder):
        panorama_set, photograph, size = copy_input(folder, 1024)
        calibration = calibrate(panorama_set.calibration, size)
        self.place = place.create_place(self.scene, str(panorama_set.image), calibration)
        self.place.image.pack()
        self.real = materials.backplate_material(self.place)
        self.pieces = reconstruct(panorama_set, calibration, size[0])
        for piece in update_pieces(self.place, self.pieces):
            piece.data.materials.append(self.real)
            piece.visible_shadow = piece.visible_glossy = False
            piece.visible_diffuse = piece.name == "floor"
        preparation.prepare_suns(self.scene, self.place, LAMPS)
        self._soften(self.place.sun_quiet)
        return photograph

    def _soften(self, image):
        """Matte things do not see it, and it spares samples."""
        rough = cv2.resize(blender_images.array_from_image(image), SOFT, interpolation=cv2.INTER_AREA)
        soft = cv2.resize(rough, tuple(image.size), interpolation=cv2.INTER_CUBIC)
        self.place.sun_quiet = blender_images.replace_image(image, image.name, np.maximum(soft, 0))
        world.build_world(self.scene, self.place, whole_map_lights=True)

    def _add_monkey(self):
        bpy.ops.mesh.primitive_monkey_add(size=MONKEY_SIZE)
        monkey = bpy.context.object
        self._refine(monkey, 4)
        monkey.data.shade_smooth()
        monkey.data.materials.append(diffuse("Plaster", PLASTER))
        return self._stood(monkey, MONKEY, MONKEY_DEG)

    def _add_knot(self, pieces):
        *others, knot = hotel_objects.add_objects(self.scene, pieces)
        for thing in others:
            bpy.data.objects.remove(thing)
        self._refine(knot, 2)
        knot.data.materials[0] = diffuse("Clay", CLAY)
        return self._stood(knot, KNOT, KNOT_DEG)

    def _refine(self, thing, levels):
        """So fine that traced shadows show no facets where they begin on it."""
        smooth = thing.modifiers.new("Subdivision", "SUBSURF")
        smooth.levels = smooth.render_levels = levels

    def _stood(self, thing, where, turned_deg):
        """On the floor by its lowest point."""
        thing.rotation_euler = [math.radians(angle) for angle in turned_deg]
        thing.location = (*where, 0)
        bpy.context.view_layer.update()
        evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
        thing.location.z = -min((thing.matrix_world @ vertex.co).z for vertex in evaluated.data.vertices)
        return thing

    def _add_camera(self):
        data = bpy.data.cameras.new("Camera")
        data.sensor_fit, data.lens_unit, data.angle = "HORIZONTAL", "FOV", math.radians(FOV_DEG)
        data.clip_start = 0.02
        camera = bpy.data.objects.new("Camera", data)
        camera.location = EYE
        camera.rotation_euler = (Vector(TARGET) - Vector(EYE)).to_track_quat("-Z", "Y").to_euler()
        self.scene.collection.objects.link(camera)
        self.scene.camera = camera

    def shine(self, chosen):
        """Let these suns shine, by their places from the strongest on, and no others."""
        for number, sun in enumerate(self.suns):
            sun.hide_render = number not in chosen

    def preview(self, method, resolution, window, offset=None):
        """Show the shadows of the suns that shine; offset: its factor and units, or None for the best."""
        preview = self.scene.panorama_shadow_preview
        preview.keep_current = False
        preview.method, preview.resolution = method, resolution
        preview.lights.clear()
        for sun in self.suns:
            if not sun.hide_render:
                preview.lights.add().light = sun
        preview.window, preview.darkness = window, DARKNESS
        preview.offset_by_itself = offset is None
        if offset is not None:
            preview.offset_factor, preview.offset_units = offset
        for thing in self.scene.objects:
            thing.select_set(thing in (self.floor, *self.objects))
        bpy.ops.panorama.preview_shadows()
        settings = settings_of(preview)
        self.window, self.offset = settings.window, (settings.offset_factor, settings.offset_units)
        self.mib = len(preview.lights) * settings.bytes_per_texel * settings.resolution**2 / 2**20

    def take_off(self):
        """Show no map."""
        if bpy.ops.panorama.remove_shadow_preview.poll():
            bpy.ops.panorama.remove_shadow_preview()

    def picture(self, part=None):
        """(side, side, 3) radiance of the view, or of a part (left, bottom, right, top) of it, 0 to 1."""
        return self._rendered(part, self.samples)

    def traced(self, part=None):
        """The picture with the shadow that Cycles traces, as dark as the nodes'; not beside a preview."""
        self.sun.data.use_shadow = False
        picture = self.picture(part)
        self.sun.data.use_shadow = True
        return picture * (1 - DARKNESS * (1 - self._traced_visibility(part)))

    def _rendered(self, part, samples, finer=1):
        scene, render = self.scene, self.scene.render
        left, bottom, right, top = part or (0, 0, 1, 1)
        zoom = 1 / (right - left)
        render.engine = "CYCLES"
        render.resolution_x = render.resolution_y = round(self.side * finer * zoom)
        render.use_border = render.use_crop_to_border = part is not None
        render.border_min_x, render.border_max_x = left, right
        render.border_min_y, render.border_max_y = bottom, top
        scene.cycles.samples, scene.cycles.seed = samples, 1
        scene.cycles.use_adaptive_sampling, scene.cycles.adaptive_threshold = True, 0.02
        scene.cycles.use_denoising = False
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.exr"
            rendering.write_render(scene, path)
            return read_picture(path)

    def _traced_visibility(self, part):
        """(H, W, 1) the part of the sun's light that arrives, by Cycles, of a sun as large as the lamp."""
        white = diffuse("White", (1, 1, 1))
        scene, layer = self.scene, bpy.context.view_layer
        world, scene.world = scene.world, None
        bounces, scene.cycles.max_bounces = scene.cycles.max_bounces, 0
        layer.material_override = white
        pictures = []
        for with_shadow in (True, False):
            self.sun.data.use_shadow = with_shadow
            pictures.append(self._rendered(part, TRUTH_SAMPLES, FINER).sum(axis=-1, keepdims=True))
        layer.material_override = None
        scene.cycles.max_bounces, scene.world = bounces, world
        lit, light = pictures
        share = np.where(light > 0, lit / np.maximum(light, 1e-12), 0.0)[..., 0]
        # A share has no soft edge where the light ends on a round thing: the mean of finer pixels has.
        return cv2.resize(share, (self.side,) * 2, interpolation=cv2.INTER_AREA)[..., None]
