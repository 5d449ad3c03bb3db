"""Small scenes that show what light does to noise: a few objects, all diffuse, all rough glossy, or mixed."""

from __future__ import annotations

import bmesh
import bpy
from mathutils import Vector

from ..cycles_integration.node_trees import add

DIFFUSE, GLOSSY, MIXED = "diffuse", "glossy", "mixed"
KINDS = (DIFFUSE, GLOSSY, MIXED)
ROUGHNESS = 0.25
"""Of what is rough and glossy: too blurred to show a lamp's shape, too sharp to be lit like a diffuse one."""
FLOOR_SIZE, BALL_RADIUS, BOX_SIZE = 6.0, 0.35, 0.5
BALLS = (((-0.8, 0.0), (0.7, 0.3, 0.2)), ((0.0, 0.0), (0.7, 0.7, 0.7)), ((0.8, 0.0), (0.2, 0.4, 0.7)))
BOX = ((0.3, 0.9), (0.6, 0.6, 0.3))
"""Where they stand on the floor [m], and their colours."""
EYE, TARGET = (0.0, -3.0, 1.6), (0.0, 0.0, 0.2)
_MIXED = ("rough", "mirror", "matte")


def add_objects(scene: bpy.types.Scene, kind: str) -> list[bpy.types.Object]:
    """Three balls and a box on a floor that is diffuse and grey in every kind of scene."""
    objects = [
        _add(scene, f"ball {k}", _ball(), (*centre, BALL_RADIUS)) for k, (centre, _) in enumerate(BALLS)
    ]
    objects.append(_add(scene, "box", _box(), (*BOX[0], BOX_SIZE / 2)))
    give_materials(objects, kind, [colour for _, colour in (*BALLS, BOX)])
    floor = _add(scene, "floor", _floor(), (0, 0, 0))
    floor.data.materials.append(diffuse("floor", (0.5, 0.5, 0.5)))
    return [*objects, floor]


def give_materials(objects: list[bpy.types.Object], kind: str, colours=((0.7, 0.7, 0.7),)):
    """Replace the objects' materials by those of a kind of scene; colours are used in turn.

    In a mixed scene the first is rough, the second a mirror, the third matte, and so on. Raises ValueError
    for a kind that does not exist.
    """
    if kind not in KINDS:
        raise ValueError(f"kind is {kind!r}; expected one of {', '.join(KINDS)}")
    for number, thing in enumerate(objects):
        colour = colours[number % len(colours)]
        finish = {DIFFUSE: "matte", GLOSSY: "rough"}.get(kind) or _MIXED[number % len(_MIXED)]
        thing.data.materials.clear()
        thing.data.materials.append(_finished(thing.name, finish, colour))


def diffuse(name: str, colour) -> bpy.types.Material:
    """A material that reflects evenly."""
    return _material(name, "ShaderNodeBsdfDiffuse", {"Color": (*colour, 1)})


def add_camera(scene: bpy.types.Scene) -> bpy.types.Object:
    """Add the camera that looks at the objects, and make it the scene's."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = EYE
    camera.rotation_euler = (Vector(TARGET) - Vector(EYE)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def _finished(name, finish, colour):
    if finish == "matte":
        return diffuse(name, colour)
    if finish == "mirror":
        return _material(name, "ShaderNodeBsdfAnisotropic", {"Color": (0.95, 0.95, 0.95, 1), "Roughness": 0})
    return _material(name, "ShaderNodeBsdfAnisotropic", {"Color": (*colour, 1), "Roughness": ROUGHNESS})


def _material(name, shader, inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    add(tree, "ShaderNodeOutputMaterial", {"Surface": add(tree, shader, inputs).outputs[0]})
    return material


def _ball():
    mesh = bmesh.new()
    bmesh.ops.create_uvsphere(mesh, u_segments=64, v_segments=32, radius=BALL_RADIUS)
    for face in mesh.faces:
        face.smooth = True
    return mesh


def _box():
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=BOX_SIZE)
    return mesh


def _floor():
    mesh = bmesh.new()
    bmesh.ops.create_grid(mesh, x_segments=1, y_segments=1, size=FLOOR_SIZE / 2)
    return mesh


def _add(scene, name, mesh, location):
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    scene.collection.objects.link(thing)
    return thing
