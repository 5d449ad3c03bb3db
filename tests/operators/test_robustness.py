"""Folders closed to writing, files saved early or without the extension, the extension off and on."""

import os
import pathlib

import numpy as np
import pytest
from room_job import built

import expanded_panoramas


@pytest.fixture(params=["no folder", "read only"])
def closed_folder(request, tmp_path):
    """A path where nothing can be written."""
    if request.param == "no folder":
        (tmp_path / "file").touch()
        return tmp_path / "file"
    if os.geteuid() == 0:
        pytest.skip("root may write everywhere")
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o555)
    return folder


def test_writing_to_a_closed_folder(fresh_blend, tmp_path, closed_folder):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    before = state.image_path, state.image, [o.name for o in bpy.context.scene.objects]
    target = str(closed_folder / "out.exr")
    calls = (
        lambda: bpy.ops.panorama.restore_light(filepath=target, known="IRRADIANCE", value=1e4),
        lambda: bpy.ops.panorama.export_set(filepath=str(closed_folder / "out.json")),
        lambda: bpy.ops.panorama.export_depth(filepath=target, width=16),
    )
    clip(bpy)
    for call in calls:
        with pytest.raises(RuntimeError, match=closed_folder.name):
            call()
    assert (state.image_path, state.image, [o.name for o in bpy.context.scene.objects]) == before


def clip(bpy):
    """Paint a clipped lamp into the loaded picture."""
    image = bpy.context.scene.panorama_place.image
    pixels = np.array(image.pixels).reshape(image.size[1], image.size[0], 4)
    pixels[90:96, 60:72, :3] = 16
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())


def test_a_file_saved_before_any_panorama(fresh_blend, tmp_path):
    bpy = fresh_blend
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "early.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "early.blend"))
    state = built(bpy, tmp_path)
    assert state.result.is_solved
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "early.blend"))
    state = bpy.context.scene.panorama_set
    assert (len(state.shapes), state.result.is_solved, state.shapes[0].is_built) == (5, True, True)
    bpy.ops.panorama.build()


def test_a_file_saved_without_the_extension_keeps_the_work(fresh_blend, tmp_path):
    """Opened and saved by someone who has not installed it, and opened again by someone who has."""
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    expanded_panoramas.unregister()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
        bpy.ops.wm.save_mainfile()
    finally:
        expanded_panoramas.register()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    state = bpy.context.scene.panorama_set
    assert (len(state.shapes), state.result.is_solved) == (5, True)
    assert bpy.data.objects["floor"].panorama_role == "SUPPORT"
    bpy.ops.panorama.build()


def test_switched_off_and_on_in_the_midst_of_the_work(fresh_blend, tmp_path):
    bpy = fresh_blend
    before = counted(bpy)
    built(bpy, tmp_path)
    for _ in range(3):
        expanded_panoramas.unregister()
        assert not hasattr(bpy.context.scene, "panorama_set")
        assert not dir(bpy.ops.panorama)
        expanded_panoramas.register()
    assert counted(bpy) == before
    state = bpy.context.scene.panorama_set
    assert (len(state.shapes), state.result.is_solved) == (5, True)
    assert bpy.data.objects["table"].panorama_role == "SUPPORT"
    bpy.ops.panorama.build()


def counted(bpy):
    """Handlers of the application, menu entries and preset folders."""
    handlers = {
        name: len(found)
        for name in dir(bpy.app.handlers)
        if isinstance(found := getattr(bpy.app.handlers, name), list)
    }
    entries = {name: len(getattr(getattr(bpy.types, name).draw, "_draw_funcs", ())) for name in MENUS}
    folders = bpy.utils.preset_paths("expanded_panoramas/render")
    return handlers, entries, [pathlib.Path(folder).name for folder in folders]


MENUS = ("VIEW3D_MT_add", "VIEW3D_MT_object_context_menu", "VIEW3D_HT_header")
