"""The whole job by operators, on a small picture of the closed room."""

import numpy as np
import OpenEXR
import pytest
from room_job import built, calibrated, select, write_room

from expanded_panoramas.ibl_toolkit.images import read_rgbd
from expanded_panoramas.sample_scenes import closed_room as room

TILT_DEG = 0.01
LENGTH_M = 1e-3


@pytest.fixture
def quick(monkeypatch):
    from expanded_panoramas.cycles_integration import preparation

    monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 32)
    monkeypatch.setattr(preparation, "IRRADIANCE_SAMPLES", 1)


def test_from_set_to_pictures(fresh_blend, tmp_path, quick):
    bpy = fresh_blend
    scene = bpy.context.scene
    state = calibrated(bpy, tmp_path)
    assert state.result.is_solved
    assert state.result.tilt_deg < TILT_DEG
    assert state.result.camera_height == pytest.approx(room.CAMERA_HEIGHT)

    bpy.ops.panorama.build()
    assert {o.name for o in scene.panorama_place.surfaces.all_objects} == {s.name for s in state.shapes}
    floor = next(shape for shape in state.shapes if shape.name == "floor")
    assert floor.is_built
    assert list(floor.size[:2]) == pytest.approx(room.SIZE[:2], abs=LENGTH_M)

    bpy.ops.panorama.add_ball(kind="MIRROR")
    bpy.ops.panorama.add_ball(kind="MATTE", radius=0.1)
    assert bpy.data.objects["Matte Ball"].location.z == pytest.approx(0.1)
    bpy.ops.panorama.add_camera()
    bpy.ops.panorama.prepare()
    assert state.job.coverage == pytest.approx(1)
    assert not state.maps_are_old

    state.job.samples = 1
    scene.render.resolution_x, scene.render.resolution_y = 64, 36
    scene.render.resolution_percentage = 50
    scene.render.filepath = "//my_output"
    bpy.ops.panorama.render_frame(filepath=str(tmp_path / "frame.exr"))
    frame = OpenEXR.File(str(tmp_path / "frame.exr"), separate_channels=True).channels()
    assert frame["G"].pixels.shape == (18, 32)
    assert np.isfinite(frame["G"].pixels).all()
    assert frame["G"].pixels.max() > 0.1
    assert scene.render.filepath == "//my_output"

    camera = scene.camera
    bpy.ops.panorama.render_panorama(filepath=str(tmp_path / "whole.exr"), width=64)
    whole = OpenEXR.File(str(tmp_path / "whole.exr"), separate_channels=True).channels()
    assert whole["G"].pixels.shape == (32, 64)
    assert scene.camera == camera
    assert (scene.render.resolution_x, scene.render.resolution_percentage) == (64, 50)
    with pytest.raises(RuntimeError, match="room.exr"):
        bpy.ops.panorama.render_panorama(filepath=str(tmp_path / "room.exr" / "whole.exr"), width=64)
    assert scene.camera == camera
    assert (scene.render.resolution_x, scene.render.filepath) == (64, "//my_output")
    bpy.ops.panorama.render_frame()  # to the Render Result
    bpy.ops.panorama.set_up_picture()


def test_depth_is_that_of_the_room(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.panorama.export_depth(filepath=str(tmp_path / "depth.exr"), width=64)
    found = read_rgbd(tmp_path / "depth.exr")
    assert found.depth.shape == (32, 64)
    assert found.camera_height == pytest.approx(room.CAMERA_HEIGHT)
    assert found.depth[-1].mean() == pytest.approx(room.CAMERA_HEIGHT, rel=0.01)  # straight down: the floor


def test_objects_of_another_file(fresh_blend, tmp_path):
    bpy = fresh_blend
    mesh, camera = bpy.data.meshes.new("vase"), bpy.data.cameras.new("eye")
    for thing in (bpy.data.objects.new("vase", mesh), bpy.data.objects.new("eye", camera)):
        bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = bpy.data.objects["eye"]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "objects.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    state = built(bpy, tmp_path)
    bpy.ops.panorama.append_objects(filepath=str(tmp_path / "objects.blend"))
    assert bpy.data.objects["vase"].panorama_role == "SYNTHETIC"
    assert bpy.context.scene.camera.name == "eye"
    assert state.objects_path == str(tmp_path / "objects.blend")
    with pytest.raises(RuntimeError, match="room.json"):
        bpy.ops.panorama.append_objects(filepath=str(tmp_path / "room.json"))
    assert state.objects_path == str(tmp_path / "objects.blend")


def test_own_support_is_in_the_depth(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    mesh = bpy.data.meshes.new("ground")
    mesh.from_pydata([(-9, -9, 0.5), (9, -9, 0.5), (9, 9, 0.5), (-9, 9, 0.5)], [], [(0, 1, 2, 3)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("ground", mesh))
    select(bpy, "ground")
    bpy.ops.panorama.set_role(role="SUPPORT")
    bpy.ops.panorama.export_depth(filepath=str(tmp_path / "depth.exr"), width=64)
    assert read_rgbd(tmp_path / "depth.exr").depth[-1].mean() == pytest.approx(1.0, rel=0.01)


def test_camera_height_moves_picture_origin_and_shapes_together(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    place, floor = bpy.context.scene.panorama_place, bpy.data.objects["floor"]
    before = floor.scale.copy()
    state.camera_height = 2 * room.CAMERA_HEIGHT
    assert place.origin.matrix_world.translation.z == pytest.approx(2 * room.CAMERA_HEIGHT)
    assert list(floor.scale.xy) == pytest.approx(list(2 * before.xy), rel=1e-4)
    assert state.maps_are_old


def test_what_keeps_its_picture_and_what_was_duplicated_is_not_rebuilt(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    table, cabinet = bpy.data.objects["table"], bpy.data.objects["cabinet"]
    select(bpy, "table")
    bpy.ops.panorama.store_coordinates()
    table.data.vertices[0].co.z = 7  # bent
    copy = cabinet.copy()
    copy.name, copy.location = "a cabinet", (9, 9, 9)  # sorts before its original
    bpy.context.scene.panorama_place.surfaces.objects.link(copy)
    before = [thing.matrix_world.copy() for thing in (table, cabinet)]
    state.camera_height = 1.1 * room.CAMERA_HEIGHT
    bpy.ops.panorama.build()
    assert table.matrix_world == before[0]
    assert table.data.vertices[0].co.z == 7
    assert cabinet.scale.x == pytest.approx(1.1 * before[1].to_scale().x, rel=1e-4)
    assert copy.location.x == 9
    bpy.ops.panorama.clear_coordinates()
    bpy.ops.panorama.build()  # the shape's own again
    assert table.scale.x == pytest.approx(1.1 * before[0].to_scale().x, rel=1e-4)


def test_a_camera_height_that_cannot_be_leaves_all_as_it_was(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    state.camera_height = 0
    assert "camera_height" in state.problem
    assert bpy.context.scene.panorama_place.origin.location.z == pytest.approx(room.CAMERA_HEIGHT)
    state.camera_height = 1.4
    assert state.problem == ""


def test_a_removed_shape_takes_its_object_along(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    state.active_shape = [shape.name for shape in state.shapes].index("table")
    bpy.ops.panorama.remove_item(target="SHAPE")
    assert state.shapes_are_old
    bpy.ops.panorama.build()
    assert "table" not in bpy.data.objects
    assert not state.shapes_are_old


def test_a_half_picked_shape_does_not_stop_calibration(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.panorama.add_shape(kind="box")
    bpy.ops.panorama.calibrate()
    assert {"floor", "walls", "table"} <= set(bpy.data.objects.keys())


def test_role_of_a_shape_survives_its_rebuilding(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    select(bpy, "table")
    bpy.ops.panorama.set_role(role="ENVIRONMENT")
    bpy.ops.panorama.build()
    assert bpy.data.objects["table"].panorama_role == "ENVIRONMENT"
    with pytest.raises(RuntimeError, match="'table' is a shape of the real place"):
        bpy.ops.panorama.set_role(role="SYNTHETIC")


def test_undo_and_redo(fresh_blend, tmp_path):
    bpy = fresh_blend
    bpy.ops.panorama.import_set(filepath=str(write_room(tmp_path)))
    bpy.ops.ed.undo_push(message="Import")
    bpy.ops.panorama.calibrate("EXEC_DEFAULT", True)
    bpy.ops.panorama.build("EXEC_DEFAULT", True)
    bpy.ops.ed.undo()
    assert "floor" not in bpy.data.objects
    assert bpy.context.scene.panorama_set.result.is_solved
    bpy.ops.ed.undo()
    assert not bpy.context.scene.panorama_set.result.is_solved
    assert bpy.context.scene.panorama_place.origin is None
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert bpy.data.objects["floor"].panorama_role == "SUPPORT"
    bpy.context.scene.panorama_set.camera_height = 2.0
    assert bpy.context.scene.panorama_place.origin.location.z == pytest.approx(2.0)


def test_a_map_with_depth_is_read_back_as_a_place(fresh_blend, tmp_path):
    """Written by one scene, opened by another: calibrated, its depth as its surface, ready to prepare."""
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.panorama.export_depth(filepath=str(tmp_path / "map.exr"))
    bpy.context.window.scene = bpy.data.scenes.new("other")
    assert bpy.ops.panorama.load_rgbd(filepath=str(tmp_path / "map.exr")) == {"FINISHED"}
    scene = bpy.context.scene
    assert [o.panorama_role for o in scene.panorama_place.surfaces.all_objects] == ["ENVIRONMENT"]
    assert bpy.ops.panorama.prepare.poll()
    assert scene.panorama_place.origin.location.z == pytest.approx(1.5, abs=1e-3)
