"""A few objects and a camera for tiny renders, without any place: what is lit is the test's own."""

import bpy  # isort: skip; the two below come with it
import bmesh
from mathutils import Vector

from expanded_panoramas.cycles_integration.node_trees import add
from expanded_panoramas.cycles_integration.rendering import write_render
from expanded_panoramas.sample_scenes.closed_room_truth import read_picture

DIFFUSE, GLOSSY, GLASS = "ShaderNodeBsdfDiffuse", "ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfRefraction"


def material(kind, **inputs):
    """A white material of one shader; its inputs by name."""
    made = bpy.data.materials.new(kind)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader = add(tree, kind, {"Color": (1, 1, 1, 1), **inputs})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def mirror():
    """Reflects all light, sharply."""
    return material(GLOSSY, Roughness=0.0)


def add_plane(scene, material, size, location=(0, 0, 0), normal=(0, 0, 1)):
    """A square that faces along ``normal``."""
    mesh = bmesh.new()
    bmesh.ops.create_grid(mesh, x_segments=1, y_segments=1, size=size / 2)
    return _add(scene, "plane", mesh, material, location, Vector(normal).to_track_quat("Z", "Y"))


def add_ball(scene, material, radius, location=(0, 0, 0)):
    """A smooth ball."""
    mesh = bmesh.new()
    bmesh.ops.create_uvsphere(mesh, u_segments=64, v_segments=32, radius=radius)
    for face in mesh.faces:
        face.smooth = True
    return _add(scene, "ball", mesh, material, location)


def _add(scene, name, mesh, material, location, turn=None):
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    if turn is not None:
        thing.rotation_mode, thing.rotation_quaternion = "QUATERNION", turn
    scene.collection.objects.link(thing)
    return thing


def add_camera(scene, eye, target, *, field_of_view=None, width=None):
    """The scene's camera: perspective of an angle [rad], or orthographic and so wide [m]."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = eye
    camera.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    camera.data.clip_start = 1e-3
    if width is None:
        camera.data.angle = field_of_view
    else:
        camera.data.type, camera.data.ortho_scale = "ORTHO", width
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def render(scene, path, size, samples, seed=0):
    """What the scene's camera sees (H, W, 3), without a filter between pixels."""
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_indirect = scene.cycles.blur_glossy = 0
    scene.cycles.pixel_filter_type = "BOX"
    write_render(scene, path)
    return read_picture(path)
