"""Suns and a panorama from one photograph of a ball: where they point, what is told, refused and undone."""

import math

import cv2
import numpy as np
import pytest
from probe_photos import Lamp, angle_deg, ball_of_pixels, codes, desk_before, photograph, unit

from expanded_panoramas.ibl_toolkit.images import read_panorama, write_exr
from expanded_panoramas.ibl_toolkit.mobile.probe import Ball, PhotoCamera

FOV_DEG = 42
UP = {"strong": unit([0.5, 0.3, 0.8]), "weak": unit([-0.7, 0.1, 0.6])}
PLACE, RADIUS = (0.12, 0.02, 0.05), 0.05


@pytest.fixture(scope="module")
def on_desk(tmp_path_factory):
    """A mirror ball beside a marker under two lamps: an HDR photograph, and the same clipped."""
    folder = tmp_path_factory.mktemp("desk")
    camera, desk = PhotoCamera.from_fov(FOV_DEG, 320, 240), desk_before()
    lamps = [
        Lamp(desk.camera_from_marker @ UP["strong"], 4, (60, 54, 30)),
        Lamp(desk.camera_from_marker @ UP["weak"], 4, (15, 15, 30)),
    ]
    image = photograph(camera, Ball(desk.to_camera(PLACE), RADIUS), lamps, desk=desk, fine=2)
    return written(folder, image)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A mirror ball without a marker, a lamp to the left above of the camera, behind it."""
    camera = PhotoCamera.from_fov(FOV_DEG, 240, 180)
    image = photograph(camera, ball_of_pixels(camera, 110), [Lamp(unit([-0.4, -0.5, -0.7]))], fine=2)
    return written(tmp_path_factory.mktemp("alone"), image)


def written(folder, image):
    write_exr(folder / "ball.exr", {c: np.ascontiguousarray(image[..., k]) for k, c in enumerate("RGB")})
    cv2.imwrite(str(folder / "ball.png"), (codes(image)[..., ::-1] * 255).round().astype(np.uint8))
    return folder


def lights_of(bpy, path, **how):
    how = {"lens": "FOV", "fov": math.radians(FOV_DEG), **how}
    return bpy.ops.panorama.lights_of_probe(filepath=str(path), **how)


def by_marker(**how):
    return {"has_marker": True, "ball_from": "MARKER", "ball_place": PLACE[:2], **how}


def suns(bpy):
    """Of each: direction to it in the world, and the object; the strongest first."""
    bpy.context.view_layer.update()
    found = sorted((o for o in bpy.data.objects if o.type == "LIGHT"), key=lambda o: o.name)
    return [(np.array(o.matrix_world)[:3, 2], o) for o in found]


def add_camera(bpy, turn=(0, 0, 0)):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler, camera.scale = (3, 1, 2), turn, (2, 2, 2)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def test_a_marker_gives_the_world(fresh_blend, on_desk):
    bpy = fresh_blend
    assert lights_of(bpy, on_desk / "ball.exr", **by_marker(strength=3)) == {"FINISHED"}
    (strong, first), (weak, second) = suns(bpy)
    assert angle_deg(strong, UP["strong"]) < 1.5
    assert angle_deg(weak, UP["weak"]) < 1.5
    assert first.data.energy == pytest.approx(3)
    assert second.data.energy == pytest.approx(1.5, rel=0.1)  # its blue is half of the other's red
    np.testing.assert_allclose(first.data.color, (1, 0.9 * 0.72 / 0.75, 0.5 * 0.7 / 0.75), atol=0.03)
    assert np.degrees(first.data.angle) == pytest.approx(8, abs=2)
    (collection,) = first.users_collection
    assert collection.name == "Probe Lights"
    assert bpy.context.active_object == first


def test_turning_the_frame_turns_all_and_another_photo_replaces_them(fresh_blend, on_desk):
    bpy = fresh_blend
    lights_of(bpy, on_desk / "ball.exr", **by_marker())
    bpy.data.objects["Probe Frame"].rotation_euler.z = math.radians(90)
    assert angle_deg(suns(bpy)[0][0], (-UP["strong"][1], UP["strong"][0], UP["strong"][2])) < 1.5
    lights_of(bpy, on_desk / "ball.exr", **by_marker(count=1))
    ((strong, sun),) = suns(bpy)
    assert angle_deg(strong, UP["strong"]) < 1.5
    assert sun.name == "Probe Light 1"
    assert len(bpy.data.lights) == 1
    assert len([c for c in bpy.data.collections if c.name.startswith("Probe")]) == 1


def test_without_a_marker_the_scenes_camera_took_it(fresh_blend, alone):
    bpy = fresh_blend
    wanted = np.array([-0.4, 0.5, 0.7])  # of a camera in Blender: y up, z backwards
    camera = add_camera(bpy, (1.2, 0.1, -0.5))
    camera.data.angle = math.radians(FOV_DEG)
    assert lights_of(bpy, alone / "ball.exr", lens="CAMERA") == {"FINISHED"}
    ((direction, sun),) = suns(bpy)
    assert angle_deg(direction, np.array(camera.matrix_world)[:3, :3] @ wanted) < 1.5
    np.testing.assert_allclose(sun.parent.matrix_world.translation, (3, 1, 2), atol=1e-5)
    np.testing.assert_allclose(sun.matrix_world.to_scale(), (1, 1, 1), atol=1e-5)
    camera.data.type = "ORTHO"
    with pytest.raises(RuntimeError, match="none of perspective"):
        lights_of(bpy, alone / "ball.exr", lens="CAMERA")


def test_the_scenes_camera_sees_as_blender_says(fresh_blend):
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    from expanded_panoramas.operators.light_probe_photo import BLENDER_FROM_PHOTO, camera_of_scene

    scene = fresh_blend.context.scene
    camera = add_camera(fresh_blend)
    data = camera.data
    data.lens, data.sensor_width, data.sensor_height, data.shift_x, data.shift_y = 35, 30, 18, 0.1, -0.2
    fresh_blend.context.view_layer.update()
    there = Vector((0.3, -0.2, -2))
    for width, height in ((320, 240), (240, 320)):
        scene.render.resolution_x, scene.render.resolution_y = width, height
        for data.sensor_fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
            u, v, _ = world_to_camera_view(scene, camera, camera.location + there)
            found = camera_of_scene(scene, width, height).pixels(
                np.array(BLENDER_FROM_PHOTO.transposed() @ there)
            )
            np.testing.assert_allclose(found, (u * width, (1 - v) * height), atol=1e-3)


def test_a_matte_ball_gives_suns_as_wide_as_the_sun(fresh_blend, tmp_path):
    bpy = fresh_blend
    camera, turned = PhotoCamera.from_fov(FOV_DEG, 120, 90), unit([0.4, -0.5, -0.7])
    photo = written(tmp_path, photograph(camera, ball_of_pixels(camera, 60), [Lamp(turned)], kind="diffuse"))
    add_camera(bpy)
    assert lights_of(bpy, photo / "ball.exr", kind="diffuse", count=1) == {"FINISHED"}
    ((direction, sun),) = suns(bpy)
    assert angle_deg(direction, turned * (1, -1, -1)) < 1.5
    assert math.degrees(sun.data.angle) == pytest.approx(0.53, abs=0.01)


def test_what_is_doubtful_is_kept_for_the_panel(fresh_blend, alone, capfd):
    from expanded_panoramas.operators.light_probe import told_by_photo

    bpy = fresh_blend
    assert told_by_photo(bpy.context.scene) is None
    add_camera(bpy, (math.pi / 2, 0, 0))  # level
    assert lights_of(bpy, alone / "ball.png") == {"FINISHED"}
    bpy.context.view_layer.update()
    told = told_by_photo(bpy.context.scene)
    ((name, altitude_deg, strength),) = told.lights
    assert (told.photo, name, strength) == ("ball.png", "Probe Light 1", 1)
    assert altitude_deg == pytest.approx(math.degrees(math.asin(unit([-0.4, 0.5, 0.7])[1])), abs=1.5)
    doubt = "Light 1: clipped; colour and strength are lower limits, and the order is by size"
    assert told.warnings == [doubt]
    assert f"Warning: {doubt}" in capfd.readouterr().out


def test_refusals_leave_the_scene_as_it_was(fresh_blend, alone, tmp_path):
    bpy = fresh_blend
    (tmp_path / "a.png").write_bytes(b"no picture")
    with pytest.raises(RuntimeError, match="add a camera and aim it"):
        lights_of(bpy, alone / "ball.exr")
    add_camera(bpy)
    before = set(bpy.data.objects), len(bpy.data.collections)
    for path, how, what in (
        (alone / "ball.exr", {"has_marker": True}, "no marker of dictionary 4X4_50"),
        (tmp_path / "a.png", {}, "not a picture"),
        (tmp_path / "none.png", {}, "none.png"),
    ):
        with pytest.raises(RuntimeError, match=what):
            lights_of(bpy, path, **how)
    assert (set(bpy.data.objects), len(bpy.data.collections)) == before


def test_a_mirror_ball_becomes_the_panorama(fresh_blend, on_desk, alone):
    bpy = fresh_blend
    how = {"lens": "FOV", "fov": math.radians(FOV_DEG)}
    state = bpy.context.scene.panorama_set
    bpy.ops.panorama.panorama_of_ball(filepath=str(alone / "ball.exr"), width=128, **how)
    assert tuple(state.image.size) == (128, 64)
    assert not state.result.is_solved
    bpy.ops.panorama.panorama_of_ball(filepath=str(on_desk / "ball.exr"), width=128, **by_marker(), **how)
    assert state.image_path == str(on_desk / "ball_panorama.exr")
    assert state.result.camera_height == pytest.approx(RADIUS, abs=1e-6)
    place = bpy.context.scene.panorama_place
    assert place.origin.matrix_world.translation.z == pytest.approx(RADIUS)
    image = read_panorama(on_desk / "ball_panorama.exr")
    v, u = np.unravel_index(image.sum(axis=2).argmax(), image.shape[:2])
    azimuth, altitude = (0.5 - (u + 0.5) / 128) * 2 * np.pi, (0.5 - (v + 0.5) / 64) * np.pi
    level = np.cos(altitude)
    found = level * np.cos(azimuth), level * np.sin(azimuth), np.sin(altitude)
    assert angle_deg(found, UP["strong"]) < 6


def test_a_calibrated_ball_takes_the_place_of_what_was_built_before(fresh_blend, on_desk):
    bpy = fresh_blend
    how = {"filepath": str(on_desk / "ball.exr"), "lens": "FOV", "fov": math.radians(FOV_DEG)}
    bpy.ops.panorama.panorama_of_ball(width=64, **how, **by_marker())
    scene = bpy.context.scene
    assert tuple(scene.panorama_place.image.size) == (64, 32)
    wall = bpy.data.objects.new("wall", bpy.data.meshes.new("wall"))
    wall["panorama_piece"] = "wall"
    scene.panorama_place.surfaces.objects.link(wall)
    scene.panorama_set.picks.add()
    scene.panorama_set.shapes.add()
    with pytest.raises(RuntimeError, match="m below the marker: check diameter"):
        bpy.ops.panorama.panorama_of_ball(**how, **by_marker(ball_above=-0.2))
    assert "wall" in bpy.data.objects
    bpy.ops.panorama.panorama_of_ball(**how, **by_marker())
    assert scene.panorama_place.image.size[0] > 64  # as fine as the photograph
    assert "wall" not in bpy.data.objects
    assert not scene.panorama_set.picks
    assert not scene.panorama_set.shapes
