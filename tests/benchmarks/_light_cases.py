"""The cases of `light_rendering`: a map at infinity or a rebuilt room, a kind of scene, a way to light it."""

import pathlib
import time
from dataclasses import dataclass
from types import SimpleNamespace

import bpy
import numpy as np
from _light_aiming import aim_at_bright_faces
from mathutils import Vector

from expanded_panoramas import cycles_integration
from expanded_panoramas.cycles_integration import (
    blender_images,
    capture,
    lookup,
    methods,
    place,
    preparation,
    rendering,
    roles,
)
from expanded_panoramas.cycles_integration.node_trees import add, mix_vectors
from expanded_panoramas.cycles_integration.pieces import update_pieces
from expanded_panoramas.ibl_toolkit.calibration import calibrate
from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.median_cut import variance_cut
from expanded_panoramas.ibl_toolkit.light.presampling import PresamplingMap
from expanded_panoramas.ibl_toolkit.reconstruction import reconstruct
from expanded_panoramas.sample_scenes import closed_room_truth, demo_job, hotel_objects, light_scenes
from expanded_panoramas.sample_scenes.closed_room import LARGE_LAMPS, SMALL_LAMPS
from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

CACHE = pathlib.Path(__file__).resolve().parents[2] / "out" / "bench" / "light"
WIDTH, HEIGHT = 128, 72
PLAIN, DL, MPA, HIB, FORCED = "plain", "DL", "MPA", "HIB", "HIB, forced"
REFERENCE = "reference"
MOST_LIGHTS = {PLAIN: 0, REFERENCE: 0, HIB: None, FORCED: 16}
DIRECTIONAL_LIGHTS, PRE_SAMPLES, PRE_WIDTH = 64, 1024, 128
AIM_WIDTH = 4 * PRE_WIDTH  # Cycles aims by steps, at pixels it interpolates: as coarse, the noise is 3 × this
HOTEL = "hotel room"
ROOMS = {f"room, {LARGE_LAMPS} lamps": LARGE_LAMPS, f"room, {SMALL_LAMPS} lamps": SMALL_LAMPS, HOTEL: None}
PANORAMA_WIDTH, PANORAMA_SAMPLES = 1024, 128
NO_LIGHTS = preparation.Lights()
UPRIGHT = SimpleNamespace(world_from_panorama=np.eye(3), camera_height=1.5)


@dataclass(frozen=True)
class Case:
    """One place and kind of scene; `place` is a map's name or one of ROOMS."""

    place: str
    kind: str

    @property
    def is_room(self):
        return self.place in ROOMS

    @property
    def slug(self):
        """For file names."""
        return f"{self.place} {self.kind}".replace(",", "").replace(" ", "_")

    @property
    def ways(self):
        """The ways to light it that are compared."""
        return (PLAIN, HIB) if self.is_room else (PLAIN, DL, MPA, HIB)


@dataclass(frozen=True)
class Lit:
    """A scene ready to render, and what was taken out of the map."""

    scene: bpy.types.Scene
    lights: preparation.Lights = NO_LIGHTS

    def render(self, samples, seed):
        """A picture (H, W, 3) and the processor seconds, of all threads, that its render took."""
        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed
        start = time.process_time()
        picture = capture.render_passes(self.scene)["Combined"][..., :3]
        return picture, time.process_time() - start


def world_maps():
    """Paths of the maps that ship with Blender, by name."""
    folder = pathlib.Path(bpy.utils.resource_path("LOCAL"), "datafiles", "studiolights", "world")
    return {path.stem: path for path in sorted(folder.glob("*.exr"))}


def all_cases():
    """Rooms first: their plain renders are the noisiest."""
    return [Case(name, kind) for name in (*ROOMS, *world_maps()) for kind in light_scenes.KINDS]


def light(case, way):
    """The scene of a case, lit in one of the ways, in a file of its own."""
    cycles_integration.unregister()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    cycles_integration.register()
    lit = _room(case, way) if case.is_room else _map(case, way)
    scene = lit.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.sample_clamp_indirect = scene.cycles.sample_clamp_direct = 0
    return lit


def _map(case, way):
    scene, path = bpy.context.scene, world_maps()[case.place]
    light_scenes.add_objects(scene, case.kind)
    light_scenes.add_camera(scene)
    here = place.create_place(scene, str(path), UPRIGHT)
    if way in MOST_LIGHTS:
        return Lit(scene, preparation.prepare_suns(scene, here, MOST_LIGHTS[way]))
    image = read_panorama(path)
    if way == DL:
        samples = variance_cut(image, DIRECTIONAL_LIGHTS)
        _add_suns(scene, samples)
        _show(scene, here.image, None)
        return Lit(scene, preparation.Lights(len(samples), 1.0))
    presampling = PresamplingMap.from_samples(variance_cut(image, PRE_SAMPLES), PRE_WIDTH)
    _show(scene, here.image, blender_images.image_from_array("Pre-sampling", presampling.environment))
    return Lit(scene)


def _room(case, way):
    make = _hotel_room if case.place == HOTEL else _closed_room
    scene, objects = make(case)
    light_scenes.give_materials(objects, case.kind)
    preparation.IRRADIANCE_WIDTH, preparation.IRRADIANCE_SAMPLES = 16, 1  # the grey support uses no bake
    prepared = preparation.prepare(scene, MOST_LIGHTS[way])
    picture = rendering.Picture(WIDTH, HEIGHT, 1, method=methods.SINGLE)
    rendering.set_up_picture(scene, scene.camera, picture)
    grey = light_scenes.diffuse("grey support", (0.5, 0.5, 0.5))
    for thing in roles.with_role(scene, roles.SUPPORT):
        thing.data.materials.clear()
        thing.data.materials.append(grey)
    if way == REFERENCE:
        aim_at_bright_faces(scene)
    return Lit(scene, prepared.at_depth)


def _closed_room(case):
    lamps = ROOMS[case.place]
    path = CACHE / f"panorama_{lamps}.exr"
    if not path.exists():
        closed_room_truth.capture_panorama(lamps, path, PANORAMA_WIDTH, PANORAMA_SAMPLES)
    scene = bpy.context.scene
    panorama_set = closed_room_set(path)
    calibration = calibrate(panorama_set.calibration, (PANORAMA_WIDTH, PANORAMA_WIDTH // 2))
    here = place.create_place(scene, str(path), calibration)
    update_pieces(here, reconstruct(panorama_set, calibration))
    objects = closed_room_truth.add_objects(scene)
    scene.camera = closed_room_truth.add_camera(scene)
    return scene, objects


def _hotel_room(case):
    scene, folder = bpy.context.scene, CACHE / "hotel"
    folder.mkdir(exist_ok=True)
    panorama_set, _, size = demo_job.copy_input(folder, PANORAMA_WIDTH)
    calibration = calibrate(panorama_set.calibration, size)
    pieces = reconstruct(panorama_set, calibration, size[0])
    here = place.create_place(scene, str(panorama_set.image), calibration)
    update_pieces(here, pieces)
    objects = hotel_objects.add_objects(scene, pieces)
    scene.camera = hotel_objects.add_camera(scene)
    return scene, objects


def _add_suns(scene, samples):
    """A constant sun for every sample, as wide as its region."""
    for number, direction in enumerate(samples.directions):
        data = bpy.data.lights.new("sun", "SUN")
        data.angle = float(2 * np.arccos(max(1 - samples.solid_angles[number] / (2 * np.pi), -1)))
        irradiance = samples.irradiance[number]
        data.energy = float(irradiance.max())
        data.color = (irradiance / irradiance.max()).tolist()
        thing = bpy.data.objects.new("sun", data)
        thing.rotation_euler = Vector(direction).to_track_quat("Z", "Y").to_euler()
        thing.visible_camera = False
        scene.collection.objects.link(thing)


def _show(scene, photograph, lighting):
    """The photograph to camera, glossy and transmission rays, another map to all others.

    With none to light, camera rays alone see a World.
    """
    made = scene.world = bpy.data.worlds.new("World")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    seen = add(tree, "ShaderNodeTexEnvironment", image=photograph).outputs["Color"]
    if lighting is None:
        looked_at = add(tree, "ShaderNodeLightPath").outputs["Is Camera Ray"]
        other = (0, 0, 0)
        made.cycles.sampling_method = "NONE"
    else:
        looked_at = lookup.is_looked_at(tree)
        other = add(tree, "ShaderNodeTexEnvironment", image=lighting).outputs["Color"]
        made.cycles.sampling_method, made.cycles.sample_map_resolution = "MANUAL", AIM_WIDTH
    colour = mix_vectors(tree, looked_at, other, seen)
    background = add(tree, "ShaderNodeBackground", {"Color": colour})
    add(tree, "ShaderNodeOutputWorld", {"Surface": background.outputs[0]})
