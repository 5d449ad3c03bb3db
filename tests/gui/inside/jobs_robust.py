"""Jobs in which something comes between: other windows, scenes, files; the add-on goes. Runs in Blender."""

import addon_utils
import bpy
import hotel
import look
from watch import Watch


def calibrated(stage):
    """The hotel room, imported and calibrated."""
    bpy.ops.panorama.import_set(filepath=str(hotel.picked_set(stage.folder)))
    bpy.ops.panorama.calibrate()
    yield


def two_windows(stage):
    """Calibrate by the button of a second window's sidebar."""
    bpy.ops.panorama.import_set(filepath=str(hotel.picked_set(stage.folder)))
    with look.override(look.area("VIEW_3D")):
        bpy.ops.wm.window_new()
    for _ in range(5):
        yield
    stage.note(windows=len(bpy.context.window_manager.windows))
    second = type(stage.hand)(window=1)
    view = look.area("VIEW_3D", window=1)
    sidebar = yield from look.open_sidebar(second, view)
    yield from look.click_button(second, sidebar, "panorama.calibrate")
    yield
    stage.note(solved=bpy.context.scene.panorama_set.result.is_solved)


def several_scenes(stage):
    """Two scenes of one file, each with its panorama and its own height."""
    first = bpy.context.scene.name
    yield from calibrated(stage)
    with look.override(look.area("VIEW_3D")):
        bpy.ops.scene.new(type="NEW")
    yield
    second = bpy.context.scene.name
    yield from calibrated(stage)
    bpy.context.scene.panorama_set.camera_height = 2.0
    yield
    heights = {n: bpy.data.scenes[n].panorama_place.origin.location.z for n in (first, second)}
    stage.note(heights=list(heights.values()))
    bpy.context.window_manager.windows[0].scene = bpy.data.scenes[first]
    yield
    bpy.ops.ed.undo_push(message="in the first scene")


def switched_off_and_on(stage):
    """Disable the add-on while its panorama is shown, count what is left, enable it and go on."""
    name = hotel.addon().__name__
    addon_utils.disable(name)
    yield
    watch = Watch()
    addon_utils.enable(name)
    yield from calibrated(stage)
    view = look.area("VIEW_3D")
    yield from look.open_sidebar(stage.hand, view)
    for _ in range(10):
        yield
    image = bpy.context.scene.panorama_set.image.name
    stage.note(during=watch.left() | {"panorama": watch.has_texture_of(bpy.data.images[image])})
    addon_utils.disable(name)
    for _ in range(5):
        yield
    stage.note(left=watch.left() | {"panorama": watch.has_texture_of(bpy.data.images[image])})
    watch.end()
    addon_utils.enable(name)
    yield
    yield from calibrated(stage)
    stage.note(solved_again=bpy.context.scene.panorama_set.result.is_solved)


JOBS = (two_windows, several_scenes, switched_off_and_on)
