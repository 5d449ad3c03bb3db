"""A Blender scene as the phone's page has it: meshes, colours, lights as strong as in Cycles, camera."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
import small_scenes as small
from box_room import EYE, HIGH, LAMP, TURNS, box_room, lamp_map
from mathutils import Matrix, Vector

from expanded_panoramas.cycles_integration.shadow_page import page_scene
from expanded_panoramas.cycles_integration.shadow_page.lighting import lighting_of
from expanded_panoramas.ibl_toolkit.mobile.device_lights import floor_irradiance
from expanded_panoramas.ibl_toolkit.mobile.page_picture import page_picture
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import ShadowSettings
from expanded_panoramas.ibl_toolkit.mobile.web_page import Background

KIND = ShadowSettings("hard", 256, "float32")
SIZE = 48, 32
LIGHT = (-1.2, -1.0, 3.0)
COLOUR = (0.5, 0.4, 0.3)


@pytest.fixture
def scene(fresh_blend):
    """A ball over a floor of the role Support, a sun, a camera, a World of one colour."""
    scene = fresh_blend.context.scene
    floor = small.add_plane(scene, small.material(small.DIFFUSE, Color=(*COLOUR, 1)), 4)
    floor.panorama_role = "SUPPORT"
    small.add_ball(scene, small.material(small.DIFFUSE, Color=(0.2, 0.6, 0.3, 1)), 0.3, (0.5, 0, 0.6))
    small.add_camera(scene, (0.3, -3, 1.9), (0.1, 0, 0.3), field_of_view=0.9)
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.world = fresh_blend.data.worlds.new("plain")
    world_of(scene, (0.1, 0.2, 0.3))
    add_light("SUN")
    return scene


def world_of(scene, colour, strength=1.0):
    if bpy.app.version < (5,):
        scene.world.use_nodes = True
    inputs = scene.world.node_tree.nodes["Background"].inputs
    inputs["Color"].default_value, inputs["Strength"].default_value = (*colour, 1), strength


def add_light(kind, energy=2.0, location=LIGHT, name=None):
    """A light that shines to a place above the floor's middle."""
    data = bpy.data.lights.new(name or kind, kind)
    data.energy = energy
    thing = bpy.data.objects.new(name or kind, data)
    thing.location = location
    away = Vector((0.2, 0, 0.3)) - thing.location
    thing.rotation_euler = away.to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(thing)
    return thing


def found_in(scene, **options):
    bpy.context.view_layer.update()
    return page_scene(scene, bpy.context.evaluated_depsgraph_get(), [KIND], **options)


def test_walls_that_only_show_the_photograph_are_no_ground(scene):
    floor = bpy.data.objects["plane"]
    assert found_in(scene).scene.meshes[0].is_ground
    floor.panorama_role = "ENVIRONMENT"
    mesh = found_in(scene).scene.meshes[0]
    assert (mesh.role, mesh.is_new, mesh.throws, mesh.is_ground) == ("environment", False, False, False)


def test_roles_colours_and_normals(scene):
    found = found_in(scene)
    floor, ball = found.scene.meshes
    assert (floor.role, floor.throws, ball.role, ball.throws) == ("support", False, "synthetic", True)
    assert ball.albedo == pytest.approx((0.2, 0.6, 0.3))
    assert len(ball.points) == len(bpy.data.objects["ball"].data.vertices)  # smooth: nothing is doubled
    np.testing.assert_allclose(ball.normals, (ball.points - (0.5, 0, 0.6)) / 0.3, atol=0.01)
    np.testing.assert_allclose(floor.normals, [(0, 0, 1)] * 4, atol=1e-6)
    assert found.scene.ambient == pytest.approx(np.pi * np.array((0.1, 0.2, 0.3)))
    assert found.warnings == ()
    np.testing.assert_allclose(found.background.image[0, 0], (0.1, 0.2, 0.3))


def test_cameras_of_maps_of_moments_reach_to_the_floor(scene):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    hard, soft = (page_scene(scene, depsgraph, [replace(KIND, method=name)]) for name in ("hard", "vsm"))
    near, far = (found.scene.lights[0].camera.far for found in (hard, soft))
    assert far > 1.2 * near


def test_instances_modifiers_mirrors_and_what_is_hidden(scene):
    bpy.ops.mesh.primitive_cube_add(size=0.2)
    box = bpy.context.object
    box.matrix_world = Matrix.Translation((0, 0, 1)) @ Matrix.Diagonal((-1, 1, 2, 1))
    array = box.modifiers.new("row", "ARRAY")
    array.count, array.fit_type = 3, "FIXED_COUNT"
    boxes = bpy.data.collections.new("boxes")
    boxes.objects.link(box)
    several = bpy.data.objects.new("several", None)
    several.instance_type, several.instance_collection, several.location = "COLLECTION", boxes, (0, 1, 0)
    scene.collection.objects.link(several)
    (mesh,) = (one for one in found_in(scene).scene.meshes if one.name == "Cube")
    assert len(mesh.triangles) == 2 * 3 * 12
    assert mesh.albedo == (0.8, 0.8, 0.8)
    corners = mesh.points[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((across * mesh.normals[mesh.triangles[:, 0]]).sum(axis=1) > 0).all()
    outward = corners.mean(axis=1)[:, 1:] - (1.0, 1.0)  # of the instance, along y and z
    there = outward[:, 0] > -0.5
    assert ((outward * across[:, 1:]).sum(axis=1)[there] > -1e-9).all()
    several.hide_render = box.hide_render = True
    assert "Cube" not in [one.name for one in found_in(scene).scene.meshes]
    bpy.data.objects["ball"].visible_shadow = False
    with pytest.raises(ValueError, match="nothing throws a shadow"):
        found_in(scene)


def test_several_materials_images_and_what_has_no_colour(scene):
    ball = bpy.data.objects["ball"]
    image = bpy.data.images.new("checker", 2, 2)
    image.pixels = [0, 0, 0, 1, 1, 1, 1, 1] * 2
    material = small.material(small.DIFFUSE)
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
    glow = small.material("ShaderNodeEmission")
    glow.diffuse_color = (0.1, 0.2, 0.3, 1)
    for one in (material, glow):
        ball.data.materials.append(one)
    for number, face in enumerate(ball.data.polygons):
        face.material_index = number % 3
    found = found_in(scene)
    colours = {mesh.name: mesh.albedo for mesh in found.scene.meshes[1:]}
    assert len(colours) == 3
    assert colours[f"ball, {material.name}"] == pytest.approx((0.5, 0.5, 0.5))
    assert colours[f"ball, {glow.name}"] == pytest.approx((0.1, 0.2, 0.3))
    assert len(found.warnings) == 1
    assert "base colour is neither a constant nor an image" in found.warnings[0]
    metal = bpy.data.materials.new("metal")
    if bpy.app.version < (5,):
        metal.use_nodes = True
    metal.node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = 1
    ball.data.materials[2] = metal
    assert found_in(scene).warnings == ("material 'metal' is metal or glass, and is drawn as a matt surface",)
    metal.node_tree.nodes.clear()
    assert "neither a constant nor an image" in found_in(scene).warnings[0]


@pytest.mark.parametrize(("kind", "energy"), [("SUN", 2), ("POINT", 100), ("SPOT", 100), ("AREA", 60)])
def test_lights_are_as_strong_as_in_cycles(scene, tmp_path, kind, energy):
    """A picture of both, the floor being new so that it has a colour of its own; without light all round."""
    bpy.data.objects.remove(bpy.data.objects["SUN"])
    bpy.data.objects["plane"].panorama_role = "SYNTHETIC"
    world_of(scene, (0, 0, 0))
    light = add_light(kind, energy)
    light.data.color = (1, 0.7, 0.4)
    if kind in ("POINT", "SPOT"):
        light.data.shadow_soft_size = 0.01
    if kind == "SPOT":
        light.data.spot_size, light.data.spot_blend = 2.8, 0
    if kind == "AREA":
        light.data.size = 0.1
    found = found_in(scene)
    shown = page_picture(found.scene, KIND, found.background, found.camera)
    scene.cycles.max_bounces = 0
    truth = small.render(scene, tmp_path / "truth.exr", SIZE, 4)
    floor = shown.mesh == 0
    ratio = np.median(shown.radiance[floor] / np.maximum(truth[floor], 1e-9), axis=0)
    np.testing.assert_allclose(ratio, 1, rtol=0.06 if kind == "AREA" else 0.01)
    dark = (truth < 1e-6).all(axis=2) & floor
    assert dark.sum() > 5
    assert (shown.radiance[dark] < 1e-6).all(axis=1).mean() > 0.8  # both have the shadow there


def test_the_strongest_lights_throw_shadows_and_others_only_brighten(scene):
    add_light("POINT", 500, name="lamp")
    fill = add_light("SUN", 0.3, name="fill")
    fill.data.use_shadow = False
    add_light("SPOT", 900, (0, 0, -5), name="from below").rotation_euler = (0, 0, 0)  # shines down
    hidden = add_light("SUN", 50, name="hidden")
    hidden.hide_render = True
    both = found_in(scene)
    assert both.light_names == ("lamp", "SUN")
    one = found_in(scene, most=1)
    assert one.light_names == ("lamp",)
    assert "'SUN': only brighten and throw no shadow, for there are more than 1" in one.warnings
    cosine = -both.scene.lights[1].camera.axes[2][2]
    added = np.array(one.scene.ambient) - both.scene.ambient
    np.testing.assert_allclose(added, np.array(both.scene.lights[1].strength) * cosine, rtol=1e-6)
    filling = np.array(both.scene.ambient) - np.pi * np.array((0.1, 0.2, 0.3))
    np.testing.assert_allclose(filling, 0.3 * cosine, rtol=1e-5)
    for name in ("lamp", "SUN"):
        bpy.data.objects.remove(bpy.data.objects[name])
    with pytest.raises(ValueError, match="no light shines on what throws shadows"):
        found_in(scene)


def test_lamps_of_an_instanced_rig_shine_where_it_stands(scene):
    sun, rig = bpy.data.objects["SUN"], bpy.data.collections.new("rig")
    rig.objects.link(sun)
    rig.objects.link(add_light("POINT", 100))
    for light in rig.objects:
        scene.collection.objects.unlink(light)
    stand = bpy.data.objects.new("stand", None)
    stand.instance_type, stand.instance_collection, stand.location = "COLLECTION", rig, (1, 0, 0.5)
    scene.collection.objects.link(stand)
    found = found_in(scene)
    assert set(found.light_names) == {"SUN", "POINT"}
    lamp = found.scene.lights[found.light_names.index("POINT")]
    np.testing.assert_allclose(lamp.camera.eye, np.add(LIGHT, (1, 0, 0.5)), atol=1e-6)
    np.testing.assert_allclose(lamp.strength, 100 / (4 * np.pi), rtol=1e-6)


def test_a_spot_that_meets_the_middle_of_a_face_counts(scene):
    bpy.data.objects.remove(bpy.data.objects["ball"])
    small.add_plane(scene, small.material(small.DIFFUSE), 4, (0, 0, 0.5))
    spot = add_light("SPOT", 100, (0, 0, 3))
    spot.data.spot_size = 0.5
    assert set(found_in(scene).light_names) == {"SUN", "SPOT"}
    spot.location.x = 9
    assert found_in(scene).light_names == ("SUN",)


def test_the_camera_sees_what_blenders_does(scene):
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 192, 50
    scene.camera.data.sensor_fit = "AUTO"
    camera = found_in(scene).camera
    assert (camera.width, camera.height) == (48, 96)
    from bpy_extras.object_utils import world_to_camera_view

    for point in ((0.5, 0, 0.6), (0.1, 0.3, 0)):
        right = world_to_camera_view(scene, scene.camera, Vector(point))
        at, _ = camera.project(np.array(point))
        np.testing.assert_allclose(at, (48 * right.x, 96 * (1 - right.y)), atol=1e-3)
    scene.camera.data.shift_x = 0.1
    with pytest.raises(ValueError, match="lens shift"):
        found_in(scene)
    scene.camera.data.type = "ORTHO"
    with pytest.raises(ValueError, match="'Camera' must be a perspective camera"):
        found_in(scene)
    with pytest.raises(ValueError, match="no camera 'other'; cameras: Camera"):
        found_in(scene, camera_name="other")
    scene.camera = bpy.data.objects["plane"]
    with pytest.raises(ValueError, match="'plane' must be a perspective camera"):
        found_in(scene)
    scene.camera = None
    with pytest.raises(ValueError, match="has no camera"):
        found_in(scene)


def test_a_camera_image_is_the_photo_as_it_is(scene):
    image = bpy.data.images.new("photo", 12, 8)
    image.pixels = np.tile([0.5, 0.25, 1, 1], 96)
    shown = scene.camera.data.background_images.new()
    shown.image = image
    scene.camera.data.show_background_images = True
    scene.view_settings.exposure = 1
    found = found_in(scene)
    assert (found.background.kind, found.background.exposure) == ("photo", 2)
    assert (found.camera.width, found.camera.height, found.warnings) == (12, 8, ())
    data = np.asarray(found.background.image)[0, 0] * 2
    np.testing.assert_allclose(data, [0.2140, 0.0509, 1], atol=2e-3)  # of IEC 61966-2-1
    scene.render.resolution_y = 48
    found = found_in(scene)
    assert found.background.image.shape == (12, 12, 3)
    assert "stretched to the picture's proportions" in found.warnings[0]


@pytest.mark.parametrize("turn", TURNS)
def test_a_places_lamp_is_where_the_room_has_it(fresh_blend, tmp_path, turn):
    image = lamp_map()
    box_room(fresh_blend, tmp_path, image, TURNS[turn])
    scene = fresh_blend.context.scene
    origin = np.array([0, 0, EYE])
    down = TURNS[turn] @ (0.5, 0.2, -1.2) + origin
    small.add_ball(scene, small.material(small.DIFFUSE), 0.2, down)
    found = found_in(scene)
    assert found.light_names == ("panorama 1",)
    assert {mesh.role for mesh in found.scene.meshes[:-1]} == {"environment"}
    lamp = found.scene.lights[0]
    where = TURNS[turn] @ (*LAMP, HIGH[2]) + origin
    np.testing.assert_allclose(lamp.camera.eye, where, atol=0.05)
    away = lamp.camera.eye - origin
    cosine = max(away[2], 0) / np.linalg.norm(away)
    there = np.array(lamp.strength) / (away @ away) * cosine + found.scene.ambient
    np.testing.assert_allclose(there, floor_irradiance(image, TURNS[turn][2]), rtol=1e-3)
    assert isinstance(found.background, Background)
    np.testing.assert_allclose(found.background.origin, origin, atol=1e-6)
    np.testing.assert_allclose(found.background.world_from_panorama, TURNS[turn], atol=1e-5)
    np.testing.assert_allclose(found.camera.eye, origin, atol=1e-6)


def test_own_lights_come_before_the_panoramas(fresh_blend, tmp_path):
    box_room(fresh_blend, tmp_path, lamp_map())
    scene = fresh_blend.context.scene
    small.add_ball(scene, small.material(small.DIFFUSE), 0.2, (0.5, 0.2, 0.3))
    add_light("SUN", 100)
    scene.view_settings.exposure, scene.panorama_view.exposure = 1, 2
    own = found_in(scene)
    assert (own.light_names, own.background.exposure) == (("SUN",), 8)
    both = found_in(scene, light_from="both")
    assert set(both.light_names) == {"panorama 1", "SUN"}
    assert found_in(scene, light_from="panorama").light_names == ("panorama 1",)
    bpy.data.images.remove(scene.panorama_place.image)
    assert found_in(scene).light_names == ("SUN",)


def test_a_panoramas_lights_are_numbered_as_they_come(scene):
    """A low one is stronger on what faces it, a high one brings more to the floor."""
    image = np.full((64, 128, 3), 0.01, np.float32)
    image[8, 20], image[24, 80] = 2000, 2000
    panorama, meshes = Background(image, origin=(0, 0, 1.5)), found_in(scene).scene.meshes
    depsgraph = bpy.context.evaluated_depsgraph_get()
    lights, _, _ = lighting_of(scene, depsgraph, panorama, meshes, "panorama", 8)
    assert [one.name for one in lights] == ["panorama 1", "panorama 2"]
    assert lights[0].light.camera.axes[2][2] > lights[1].light.camera.axes[2][2]  # looks down less


def test_without_a_panorama_its_lights_cannot_be_taken(scene):
    with pytest.raises(ValueError, match="has no panorama whose lights could be taken"):
        found_in(scene, light_from="panorama")
