"""Photographs of balls by another hand: Cycles, with suns of known direction and irradiance."""

import numpy as np
import pytest
from probe_photos import angle_deg, ball_of_pixels, unit

from expanded_panoramas.ibl_toolkit.mobile.probe import PhotoCamera, estimate_lights, place_ball, read_photo

CAMERA = PhotoCamera.from_fov(50, 160, 120)
BALL = ball_of_pixels(CAMERA, 70, (0.06, -0.04))
BLENDER_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])
"""Blender's cameras look along −z, with y up."""
SUNS = ((unit([0.5, -0.7, -0.3]), 8.0, 6.0), (unit([-0.8, -0.4, 0.3]), 10.0, 3.0))
"""Direction, frame `camera`; diameter [°]; irradiance."""
ALBEDO = 0.8
SHADERS = {"mirror": "ShaderNodeBsdfGlossy", "diffuse": "ShaderNodeBsdfDiffuse"}


@pytest.fixture
def rendered(fresh_blend, tmp_path):
    """A function of the kind of ball -> its photograph."""
    bpy = fresh_blend
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.angle, camera.data.sensor_fit = np.radians(50), "HORIZONTAL"
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.use_denoising = False
    scene.cycles.samples, scene.render.resolution_x, scene.render.resolution_y = 32, 160, 120
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.color = (0.2, 0.22, 0.25)
    add_suns(bpy)
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=256, ring_count=128, radius=BALL.radius, location=BLENDER_FROM_CAMERA @ BALL.centre
    )
    bpy.ops.object.shade_smooth()

    def render(kind):
        bpy.context.object.data.materials.append(material(bpy, SHADERS[kind]))
        scene.render.filepath = str(tmp_path / f"{kind}.exr")
        bpy.ops.render.render(write_still=True)
        return read_photo(scene.render.filepath)

    return render


def add_suns(bpy):
    from mathutils import Vector

    for direction, diameter, irradiance in SUNS:
        light = bpy.data.lights.new("Sun", "SUN")
        light.angle, light.energy = np.radians(diameter), irradiance
        sun = bpy.data.objects.new("Sun", light)
        sun.rotation_mode = "QUATERNION"
        sun.rotation_quaternion = Vector(BLENDER_FROM_CAMERA @ direction).to_track_quat("Z", "Y")
        bpy.context.scene.collection.objects.link(sun)


def material(bpy, shader):
    made = bpy.data.materials.new(shader)
    if made.node_tree is None:  # always there from Blender 5.0 on
        made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    surface, output = nodes.new(shader), nodes.new("ShaderNodeOutputMaterial")
    surface.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
    surface.inputs["Roughness"].default_value = 0
    made.node_tree.links.new(surface.outputs[0], output.inputs[0])
    return made


@pytest.mark.parametrize(("kind", "factor"), [("mirror", ALBEDO), ("diffuse", ALBEDO / np.pi)])
def test_the_suns_of_cycles(rendered, kind, factor):
    photo = rendered(kind)
    placed = place_ball(photo, CAMERA)  # found by its edges
    assert np.abs(CAMERA.pixels(placed.ball.axis) - CAMERA.pixels(BALL.axis)).max() < 0.4
    lights = estimate_lights(photo, CAMERA, placed.ball, kind, 4).lights
    assert len(lights) == len(SUNS)
    for light, (direction, diameter, irradiance) in zip(lights, SUNS, strict=True):
        assert angle_deg(light.direction, direction) < 0.8
        np.testing.assert_allclose(light.irradiance, irradiance * factor, rtol=0.04)
        if kind == "mirror":
            assert light.diameter_deg == pytest.approx(diameter, rel=0.25)
