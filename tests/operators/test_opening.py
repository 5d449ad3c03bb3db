"""Files that are opened, chosen or dropped, and the sample room."""

from pathlib import Path

import numpy as np
import pytest
from room_job import built, calibrated, write_room

from expanded_panoramas.ibl_toolkit.images import RGBD, write_exr, write_rgbd


def write_depth(folder):
    """An RGB-D panorama of the inside of a ball of 2 m, tilted by 30°."""
    image = np.full((16, 32, 3), 0.5, np.float32)
    depth = np.full((16, 32), 2.0, np.float32)
    s, c = 0.5, np.sqrt(0.75)
    tilted = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    write_rgbd(folder / "depth.exr", RGBD(image, depth, tilted, 1.2))
    return folder / "depth.exr"


def test_a_dropped_file_is_opened_at_once(fresh_blend, tmp_path):
    """INVOKE_DEFAULT with a path, as Blender calls the operator of a file handler: no File Browser."""
    bpy = fresh_blend
    write_room(tmp_path)
    done = bpy.ops.panorama.drop_image("INVOKE_DEFAULT", filepath=str(tmp_path / "room.exr"))
    assert done == {"FINISHED"}
    state = bpy.context.scene.panorama_set
    assert state.image.name == "room.exr"
    assert not state.result.is_solved
    assert bpy.ops.panorama.import_set("INVOKE_DEFAULT", filepath=str(tmp_path / "room.json")) == {"FINISHED"}
    assert len(state.shapes) == 5


def test_a_dropped_map_with_depth_is_opened_with_it(fresh_blend, tmp_path):
    bpy = fresh_blend
    scene = bpy.context.scene
    calibrated(bpy, tmp_path)
    assert scene.panorama_set.result.uncertainty_tilt_deg > 0
    bpy.ops.panorama.drop_image(filepath=str(write_depth(tmp_path)))
    assert scene.panorama_set.result.uncertainty_tilt_deg == 0  # of the one before
    assert scene.panorama_set.result.tilt_deg == pytest.approx(30, abs=1e-3)
    assert scene.panorama_set.result.is_solved
    assert scene.panorama_place.origin.location.z == pytest.approx(1.2)
    assert [o.panorama_role for o in scene.panorama_place.surfaces.all_objects] == ["ENVIRONMENT"]


def test_what_is_dropped_must_be_a_panorama(fresh_blend, tmp_path):
    bpy = fresh_blend
    photo = tmp_path / "photo.exr"
    write_exr(photo, {name: np.ones((8, 12), np.float32) for name in "RGB"})
    (tmp_path / "notes.json").write_text('{"a": 1}')
    (tmp_path / "empty.hdr").write_bytes(b"")
    with pytest.raises(RuntimeError, match=r"photo.exr: 12 x 8 px, an equirectangular panorama must be 2:1"):
        bpy.ops.panorama.drop_image("INVOKE_DEFAULT", filepath=str(photo))
    with pytest.raises(RuntimeError, match=r"empty.hdr: neither OpenEXR nor Radiance"):
        bpy.ops.panorama.drop_image("INVOKE_DEFAULT", filepath=str(tmp_path / "empty.hdr"))
    with pytest.raises(RuntimeError, match=r"notes.json"):
        bpy.ops.panorama.import_set("INVOKE_DEFAULT", filepath=str(tmp_path / "notes.json"))
    assert bpy.context.scene.panorama_set.image_path == ""
    assert not bpy.data.images


def test_the_sample_room(fresh_blend):
    bpy = fresh_blend
    assert bpy.ops.panorama.load_sample() == {"FINISHED"}
    state = bpy.context.scene.panorama_set
    assert Path(state.image_path).name == "interior.exr"
    assert tuple(state.image.size) == (1024, 512)
    bpy.ops.panorama.calibrate()
    bpy.ops.panorama.build()
    assert {"floor", "walls", "bed", "desk"} <= set(bpy.data.objects.keys())


def test_the_sample_room_is_one_undo_step(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.panorama.load_sample("EXEC_DEFAULT", True)
    assert len(bpy.context.scene.panorama_set.shapes) == 6
    bpy.ops.ed.undo()
    state = bpy.context.scene.panorama_set
    assert len(state.shapes) == 5
    assert state.image_path.endswith("room.exr")
    assert state.result.is_solved


def test_a_blender_without_its_panoramas_says_so(fresh_blend, monkeypatch):
    from expanded_panoramas.cycles_integration import shipped

    monkeypatch.setattr(shipped, "FOLDER", Path("studiolights", "elsewhere"))
    with pytest.raises(RuntimeError, match="packed without datafiles/studiolights/elsewhere/interior.exr"):
        fresh_blend.ops.panorama.load_sample()
    assert fresh_blend.context.scene.panorama_set.image_path == ""


def test_image_editors_show_what_is_opened(fresh_blend, tmp_path):
    bpy = fresh_blend
    write_room(tmp_path)
    areas = bpy.context.window.screen.areas
    areas[0].type = "IMAGE_EDITOR"
    bpy.ops.panorama.load_image(filepath=str(tmp_path / "room.exr"))
    assert areas[0].spaces.active.image.name == "room.exr"
